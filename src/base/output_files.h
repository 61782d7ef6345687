// SPDX-License-Identifier: MIT
// What a command writes: files appear whole or not at all, and never over a file that the command has read.
//
// A file is written under a temporary name in its own folder, `.meshlode-<16 hexadecimal digits>.tmp`, synced, renamed
// over its final name, and the folder is synced. The writer holds a lock on the temporary file while it lives:
// a file of such a name that nobody has locked is what a killed process left, and the next command that writes into the
// folder removes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/file.h"

namespace meshlode {

/// The outputs of one command or call. Files are told apart by device and inode, so that links, `./` and the letters'
/// case change nothing. Safe to call from any thread.
class OutputFiles {
 public:
  /// What becomes of an output whose folder is missing.
  enum class Folders : std::uint8_t { kMustBeThere, kAreMade };

  OutputFiles() = default;
  explicit OutputFiles(Folders folders) : makes_folders_(folders == Folders::kAreMade) {}
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// A file that was read: nothing is written over it from here on.
  void keep(FileId id);
  void keep(std::span<const FileId> ids);

  /// Whether `path` can be written, as far as that can be known before the work is done; and removes from its folder
  /// what killed writers left there. Errors: kUsage it is a file that was read, or one that this object wrote before;
  /// kIo its folder is missing (but where folders are made, when the file is written) or cannot be written, or it is a
  /// folder itself.
  [[nodiscard]] Status claim(const std::filesystem::path& path);

  /// Claims `path` and writes it. Links are followed: what they point to is replaced. Devices and pipes are written to
  /// directly. On error nothing is left behind.
  [[nodiscard]] Status write(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

  /// The same for a file that the command writes again and again while it works, the last time by write(): it is not
  /// synced, and not held to be an output that nothing is written over.
  [[nodiscard]] Status rewrite(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

  /// Whether the file at `path` is one that write() put in place, or has just renamed into it.
  [[nodiscard]] bool has_written(const std::filesystem::path& path);

  /// Removes the temporary files of writes under way; these and all later ones fail. For a process about to end.
  void abandon();

 private:
  struct Temporary;
  enum class Durability : std::uint8_t { kWrittenAgain, kSynced };
  [[nodiscard]] Status write_as(const std::filesystem::path& path, std::span<const std::uint8_t> bytes,
                                Durability durability);
  [[nodiscard]] Status check_identity(const std::filesystem::path& path) const;
  [[nodiscard]] Status create(Temporary& file, const std::filesystem::path& path);
  [[nodiscard]] Status put_in_place(Temporary& file, const std::filesystem::path& path,
                                    const std::filesystem::path& target, Durability durability);
  void forget(const Temporary& file);

  std::mutex mutex_;  ///< of all below
  std::set<FileId> read_, written_;
  std::set<FileId> swept_;                ///< folders
  std::vector<std::string> temporaries_;  ///< paths of writes under way
  bool is_abandoned_ = false;
  const bool makes_folders_ = false;
};

/// Whether two paths name one file, existing or not: the same identity, or the same name in the same folder.
[[nodiscard]] bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace meshlode
