// SPDX-License-Identifier: GPL-3.0-or-later
// rand() and srand() with one sequence per thread, so that METIS may run on several threads at once. The numbers are
// those of glibc's own rand(): the same generator (random_r, 128 bytes of state), the same first seed.
#include <cstdint>
#include <cstdlib>

namespace {

struct ThreadRandom {
  random_data data{};
  char state[128]{};
  std::uint64_t calls = 0;
  ThreadRandom() { initstate_r(1, state, sizeof state, &data); }
};

ThreadRandom& thread_random() {
  thread_local ThreadRandom random;
  return random;
}

}  // namespace

extern "C" {

void srand(unsigned int seed) noexcept {
  ThreadRandom& random = thread_random();
  ++random.calls;
  srandom_r(seed, &random.data);
}

int rand() noexcept {
  ThreadRandom& random = thread_random();
  ++random.calls;
  std::int32_t value = 0;
  random_r(&random.data, &value);
  return value;
}

std::uint64_t meshlode_thread_rand_calls() {
  return thread_random().calls;
}
}
