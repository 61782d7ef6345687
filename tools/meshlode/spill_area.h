// SPDX-License-Identifier: GPL-3.0-or-later
// Large arrays in a temporary file: what of them is in memory can be dropped at any time and comes back when it is
// touched. What they hold is the same as anywhere else, so that nothing which is computed from them depends on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>

#include <meshlode/result.h>

namespace meshlode::cli {

/// A range of addresses, mapped piece by piece to a file that has no name. All members may be called side by side.
class SpillArea {
 public:
  /// `addresses`: bytes that all arrays together may take. Errors: kIo where the folder's file system lies in memory
  /// itself, or cannot reserve room; kBuildFailed where there are not so many addresses.
  [[nodiscard]] static Result<std::unique_ptr<SpillArea>> open(const std::filesystem::path& folder,
                                                               std::uint64_t addresses = kAddresses);
  ~SpillArea();
  SpillArea(const SpillArea&) = delete;
  SpillArea& operator=(const SpillArea&) = delete;

  /// Zeros, from the beginning of a page. Room for them is reserved in the file: nullptr where it has none, and where
  /// addresses are used up.
  [[nodiscard]] void* allocate(std::size_t bytes) noexcept;
  /// \pre `array` came from allocate()
  void free(void* array) noexcept;
  [[nodiscard]] bool owns(const void* address) const noexcept {
    const auto* const byte = static_cast<const std::byte*>(address);
    return byte >= base_ && byte < base_ + size_;
  }
  /// Writes `bytes` of addresses back to the file as need be, and takes them out of memory. Each call goes on where the
  /// one before ended, around and around. Waits for nobody. \returns false where a round is over, and where somebody
  /// is taking or giving back addresses
  bool drop(std::size_t bytes) noexcept;

  [[nodiscard]] std::size_t used() const noexcept;  ///< bytes of all arrays

  static constexpr std::uint64_t kAddresses = std::uint64_t{1} << 42U;

 private:
  using Ranges = std::map<std::size_t, std::size_t>;  ///< bytes by offset

  SpillArea(int file, std::byte* base, std::size_t size) : file_(file), base_(base), size_(size) {}
  // The system is asked without the lock: giving back room in a file may wait for a disk.
  /// Where so many addresses are that are not used, and now are; size_: there are none.
  [[nodiscard]] std::size_t take_range(std::size_t bytes) noexcept;
  void release_range(std::size_t offset, std::size_t bytes) noexcept;
  // With the lock:
  std::size_t find_range(std::size_t bytes);
  void give_range(std::size_t offset, std::size_t bytes);

  int file_;
  std::byte* base_;
  std::size_t size_;
  mutable std::mutex mutex_;
  Ranges taken_, free_;   ///< free_: below end_, with no two side by side
  std::size_t end_ = 0;   ///< addresses from here on were never used
  std::size_t used_ = 0;  ///< bytes of taken_
  std::size_t hand_ = 0;  ///< where drop() goes on
};

}  // namespace meshlode::cli
