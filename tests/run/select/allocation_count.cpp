// SPDX-License-Identifier: GPL-3.0-or-later
// A file of its own: where GCC sees a use and a replaced operator delete at once, it takes free() for a mistake.
#include "run/select/allocation_count.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::uint64_t> taken{0};
}  // namespace

void* operator new(std::size_t size) {
  ++taken;
  if (void* const memory = std::malloc(size != 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
// Of its own where sanitizers replace the library's, as std::stable_sort takes memory by it.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++taken;
  return std::malloc(size != 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace meshlode::test {

std::uint64_t allocation_count() {
  return taken;
}

}  // namespace meshlode::test
