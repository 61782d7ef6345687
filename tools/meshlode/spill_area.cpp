// SPDX-License-Identifier: GPL-3.0-or-later
#include "spill_area.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <string>
#include <utility>

namespace meshlode::cli {

namespace {

std::size_t page_bytes() {
  static const auto bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return bytes;
}

/// A file without a name in the folder: it goes with the process, however that ends.
int open_nameless(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return file;
  std::string name = (folder / "meshlode-XXXXXX").string();
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

/// Whether what is written there stays in memory.
bool is_in_memory(int file) {
  struct statfs info {};
  if (::fstatfs(file, &info) != 0) return false;
  const auto type = static_cast<unsigned long>(info.f_type);
  return type == TMPFS_MAGIC || type == RAMFS_MAGIC || type == HUGETLBFS_MAGIC;
}

/// As often as a signal comes between.
int allocate_in_file(int file, int mode, std::size_t offset, std::size_t bytes) {
  int result = 0;
  do {
    result = ::fallocate(file, mode, static_cast<off_t>(offset), static_cast<off_t>(bytes));
  } while (result != 0 && errno == EINTR);
  return result;
}

/// Addresses that nothing lies at.
void* reserve(void* at, std::size_t bytes, int flags) {
  return ::mmap(at, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | flags, -1, 0);
}

}  // namespace

Result<std::unique_ptr<SpillArea>> SpillArea::open(const std::filesystem::path& folder, std::uint64_t addresses) {
  const auto fail = [&](std::string detail) { return Error{ErrorCode::kIo, folder.string(), std::move(detail)}; };
  const int file = open_nameless(folder.empty() ? "." : folder);
  if (file < 0) return fail(std::string("no temporary file can be made: ") + std::strerror(errno));
  const auto close_and_fail = [&](std::string detail) {
    ::close(file);
    return fail(std::move(detail));
  };
  if (is_in_memory(file)) return close_and_fail("what is written here stays in memory");
  if (allocate_in_file(file, 0, 0, page_bytes()) != 0) {
    return close_and_fail(std::string("no room can be reserved: ") + std::strerror(errno));
  }
  const std::size_t size = addresses / page_bytes() * page_bytes();
  void* const base = reserve(nullptr, size, 0);
  if (base == MAP_FAILED) {
    ::close(file);
    return Error{ErrorCode::kBuildFailed, "", std::string("no addresses for large arrays: ") + std::strerror(errno)};
  }
  return std::unique_ptr<SpillArea>(new SpillArea(file, static_cast<std::byte*>(base), size));
}

SpillArea::~SpillArea() {
  ::munmap(base_, size_);
  ::close(file_);
}

std::size_t SpillArea::find_range(std::size_t bytes) {
  for (auto range = free_.begin(); range != free_.end(); ++range) {  // the first that fits: the file stays short
    if (range->second < bytes) continue;
    const auto [offset, length] = *range;
    free_.erase(range);
    if (length > bytes) free_.emplace(offset + bytes, length - bytes);
    return offset;
  }
  if (bytes > size_ - end_) return size_;
  return std::exchange(end_, end_ + bytes);
}

void SpillArea::give_range(std::size_t offset, std::size_t bytes) {
  auto range = free_.emplace(offset, bytes).first;
  const auto next = std::next(range);
  if (next != free_.end() && range->first + range->second == next->first) {
    range->second += next->second;
    free_.erase(next);
  }
  if (range != free_.begin()) {
    const auto before = std::prev(range);
    if (before->first + before->second == range->first) {
      before->second += range->second;
      free_.erase(range);
      range = before;
    }
  }
  if (range->first + range->second == end_) {
    end_ = range->first;
    free_.erase(range);
  }
}

std::size_t SpillArea::take_range(std::size_t bytes) noexcept {
  const std::lock_guard lock(mutex_);
  try {
    const std::size_t offset = find_range(bytes);
    if (offset == size_) return size_;
    taken_.emplace(offset, bytes);
    used_ += bytes;
    return offset;
  } catch (const std::bad_alloc&) {
    return size_;
  }
}

void SpillArea::release_range(std::size_t offset, std::size_t bytes) noexcept {
  reserve(base_ + offset, bytes, MAP_FIXED);
  (void)allocate_in_file(file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, offset, bytes);
  const std::lock_guard lock(mutex_);
  try {
    taken_.erase(offset);
    used_ -= bytes;
    give_range(offset, bytes);
  } catch (const std::bad_alloc&) {
    return;  // its addresses are not used again
  }
}

void* SpillArea::allocate(std::size_t bytes) noexcept {
  if (bytes == 0 || bytes > size_) return nullptr;
  const std::size_t whole = (bytes + page_bytes() - 1) / page_bytes() * page_bytes();
  const std::size_t offset = take_range(whole);
  if (offset == size_) return nullptr;
  const auto place = static_cast<off_t>(offset);
  // Reserved now: a page that finds no room when it is written to ends the process.
  if (allocate_in_file(file_, 0, offset, whole) == 0) {
    void* const at = ::mmap(base_ + offset, whole, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file_, place);
    if (at != MAP_FAILED) return at;
  }
  release_range(offset, whole);
  return nullptr;
}

void SpillArea::free(void* array) noexcept {
  const auto offset = static_cast<std::size_t>(static_cast<std::byte*>(array) - base_);
  std::size_t bytes = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto range = taken_.find(offset);
    if (range != taken_.end()) bytes = range->second;
  }
  if (bytes > 0) release_range(offset, bytes);
}

bool SpillArea::drop(std::size_t bytes) noexcept {
  std::size_t begin = 0, length = 0;
  bool goes_on = false;
  {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return false;
    if (hand_ >= end_) hand_ = 0;
    begin = hand_;
    length = std::min((bytes + page_bytes() - 1) / page_bytes() * page_bytes(), end_ - hand_);
    hand_ += length;
    goes_on = hand_ < end_;
  }
  // Shared with the file: what was written goes there, and nothing is lost. Where nothing lies, nothing happens.
  if (length > 0) ::madvise(base_ + begin, length, MADV_DONTNEED);
  return goes_on;
}

std::size_t SpillArea::used() const noexcept {
  const std::lock_guard lock(mutex_);
  return used_;
}

}  // namespace meshlode::cli
