// SPDX-License-Identifier: GPL-3.0-or-later
#include "spill.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "base/memory.h"
#include "base/parallel.h"
#include "spill_area.h"
#include "stop_threads.h"

namespace meshlode::cli {

namespace {

/// Arrays of so many bytes may go to the file. What a group needs while it is in work is smaller.
constexpr std::size_t kLargeArray = std::size_t{1} << 20U;
/// malloc() may give so much more than was asked for: arrays shorter than both together are not counted, neither when
/// they are made nor when they are freed, where nothing tells what was asked for.
constexpr std::size_t kSlack = std::size_t{1} << 16U;
/// Large arrays take this part of the limit before the first of them goes to the file.
constexpr std::uint64_t kSharesInMemory = 4;
/// Shares of the limit where dropping begins and ends, in eighths. Threads that read here and there what is in the page
/// cache map more in a millisecond than can be dropped in one: they wait until it is done.
constexpr std::uint64_t kBegin = 5, kEnd = 4;
constexpr std::size_t kDropped = std::size_t{32} << 20U;  // of addresses, at a time
/// So much a thread may map in a millisecond: with each page that it comes to the system maps some around it.
constexpr std::uint64_t kMappedInMillisecond = std::uint64_t{96} << 20U;
constexpr std::uint64_t kFewestMicroseconds = 200, kMostMicroseconds = 1000;  // between looks

class Spill {
 public:
  Spill(std::unique_ptr<SpillArea> area, std::filesystem::path folder, std::uint64_t limit)
      : area_(std::move(area)),
        folder_(std::move(folder)),
        limit_(limit),
        statm_(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC)),
        page_(static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE))) {
    std::thread([this] { keep_limit(); }).detach();
  }

  [[nodiscard]] void* allocate(std::size_t bytes) noexcept {
    if (in_memory_.load(std::memory_order_relaxed) + static_cast<std::int64_t>(bytes) <=
        static_cast<std::int64_t>(limit_ / kSharesInMemory)) {
      void* const array = std::malloc(bytes);
      if (array != nullptr) in_memory_ += counted_bytes(array);
      return array;
    }
    void* const array = area_->allocate(bytes);
    if (array == nullptr) is_full_ = true;
    return array;
  }
  [[nodiscard]] bool owns(const void* array) const noexcept { return area_->owns(array); }
  void free(void* array) noexcept { area_->free(array); }
  /// Before an array that is not the file's is freed.
  void forget(void* array) noexcept { in_memory_ -= counted_bytes(array); }
  [[nodiscard]] bool is_full() const { return is_full_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  [[nodiscard]] static std::int64_t counted_bytes(void* array) noexcept {
    const std::size_t bytes = malloc_usable_size(array);
    return bytes >= kLargeArray + kSlack ? static_cast<std::int64_t>(bytes) : 0;
  }
  [[nodiscard]] std::uint64_t resident() const {
    char text[128];
    const ssize_t length = ::pread(statm_, text, sizeof text - 1, 0);
    if (length <= 0) return 0;
    text[length] = '\0';
    char* end = nullptr;
    (void)std::strtoull(text, &end, 10);
    return std::strtoull(end, nullptr, 10) * page_;
  }

  void keep_limit() {
#ifdef PR_SET_TIMERSLACK
    (void)::prctl(PR_SET_TIMERSLACK, 1000UL, 0UL, 0UL, 0UL);  // nanoseconds: else each sleep is 50 microseconds longer
#endif
    const std::uint64_t begin = limit_ / 8 * kBegin;
    const std::uint64_t in_microsecond = std::max<std::uint64_t>(1, thread_limit()) * kMappedInMillisecond / 1000;
    for (std::uint64_t now = resident();; now = resident()) {
      if (now > begin) {
        const StoppedThreads stopped;
        bool is_round_over = false;
        while (!is_round_over && resident() > limit_ / 8 * kEnd) is_round_over = !area_->drop(kDropped);
        now = resident();
      }
      // Where a round did not help, what is in memory is not the file's, and threads get on before the next.
      const std::uint64_t wait = now > begin ? kMostMicroseconds : (begin - now) / in_microsecond;
      std::this_thread::sleep_for(std::chrono::microseconds(std::clamp(wait, kFewestMicroseconds, kMostMicroseconds)));
    }
  }

  std::unique_ptr<SpillArea> area_;
  std::filesystem::path folder_;
  std::uint64_t limit_;
  int statm_;
  std::uint64_t page_;
  std::atomic<std::int64_t> in_memory_ = 0;  ///< bytes of large arrays that are not the file's
  std::atomic<bool> is_full_ = false;
};

/// Arrays of so many bytes are mapped for themselves (main.cpp), and lie in huge pages where the system has some: of a
/// build's processor seconds a tenth went into faults of small ones and into finding them again.
constexpr std::size_t kHugeArray = std::size_t{2} << 20U;

void* allocate_in_memory(std::size_t bytes) noexcept {
  void* const array = std::malloc(std::max<std::size_t>(bytes, 1));
#ifdef MADV_HUGEPAGE
  if (array != nullptr && bytes >= kHugeArray) {
    static const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t lead = reinterpret_cast<std::uintptr_t>(array) % page;
    // A wish: where it is refused all is as it was.
    (void)::madvise(static_cast<std::byte*>(array) - lead, (lead + bytes + page - 1) / page * page, MADV_HUGEPAGE);
  }
#endif
  return array;
}

/// Never freed: other threads may allocate until the process ends.
constinit std::atomic<Spill*> the_spill = nullptr;

}  // namespace

Status start_spilling(std::uint64_t limit, std::span<const std::filesystem::path> folders) {
#ifdef MESHLODE_SANITIZED
  (void)limit;
  (void)folders;
  return Error{ErrorCode::kUnsupported, "", "large arrays stay in memory under sanitizers"};
#else
  if (the_spill.load() != nullptr) return Ok{};
  if (resident_memory() == 0) return Error{ErrorCode::kIo, "/proc/self/statm", "does not say what is in memory"};
  Error last{ErrorCode::kIo, "", "no folder for a temporary file"};
  for (const std::filesystem::path& folder : folders) {
    auto area = SpillArea::open(folder);
    if (area) {
      the_spill = new Spill(std::move(*area), folder, limit);
      return Ok{};
    }
    last = area.error();
  }
  return last;
#endif
}

std::optional<std::filesystem::path> full_spill_folder() {
  const Spill* const spill = the_spill.load();
  return spill != nullptr && spill->is_full() ? std::optional(spill->folder()) : std::nullopt;
}

void* new_array(std::size_t bytes) noexcept {
  Spill* const spill = bytes < kLargeArray ? nullptr : the_spill.load(std::memory_order_acquire);
  return spill != nullptr ? spill->allocate(bytes) : allocate_in_memory(bytes);
}

void delete_array(void* array) noexcept {
  Spill* const spill = array == nullptr ? nullptr : the_spill.load(std::memory_order_acquire);
  if (spill != nullptr && spill->owns(array)) return spill->free(array);
  if (spill != nullptr) spill->forget(array);
  std::free(array);
}

}  // namespace meshlode::cli
