// SPDX-License-Identifier: MIT
// All that `base`, `format` and `run` ask of the operating system beyond what the standard library has: mapped inputs,
// files that appear whole, locks, memory. Two bodies, system_posix.cpp and system_windows.cpp, of which CMake takes
// one; nothing else of these floors includes a header of a system, or asks which one it is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <meshlode/result.h>

#include "base/file_id.h"

namespace meshlode::system {

/// Why the last call of this thread failed, in words; of the functions below that say so.
[[nodiscard]] std::string last_error();

enum class FileKind { kRegular, kFolder, kOther };
struct FileInfo {
  FileId id;
  FileKind kind = FileKind::kOther;
};

/// Links are followed; nothing, with last_error(), where there is no such file.
[[nodiscard]] std::optional<FileInfo> find_info(const std::filesystem::path& path);

/// Whether this process may write the file, or make files in the folder; last_error() where not.
[[nodiscard]] bool may_write(const std::filesystem::path& path, FileKind kind);

struct Mapping {
  std::span<const std::uint8_t> bytes;
  FileId id;
};
/// A regular file, read-only; never waits for a pipe. Bytes of an empty file are an empty span, which is not unmapped.
[[nodiscard]] Result<Mapping> map_file(const std::filesystem::path& path);
void unmap(std::span<const std::uint8_t> bytes);

/// An open file. \pre of all that take one: it was given out by create_locked or open_device and is not closed
using Handle = std::intptr_t;
constexpr Handle kNoHandle = -1;

enum class Created { kYes, kNameTaken, kFailed };
/// A new file, with the mode that any new file gets, locked while it is open; last_error() where it failed. A name is
/// taken also where somebody removed the file before it was locked.
[[nodiscard]] Created create_locked(const std::filesystem::path& path, Handle& file);
/// A device or a pipe, for writing; kNoHandle with last_error().
[[nodiscard]] Handle open_device(const std::filesystem::path& path);
/// These say false, with last_error().
[[nodiscard]] bool write_all(Handle file, std::span<const std::uint8_t> bytes);
[[nodiscard]] bool sync(Handle file);
bool close(Handle file);
[[nodiscard]] std::optional<FileInfo> info_of(Handle file);

/// Puts a file, open or not, in the place of another or of none, in one step; false with last_error().
[[nodiscard]] bool rename_over(const std::filesystem::path& from, const std::filesystem::path& to);
void remove_file(const std::filesystem::path& path);
/// Removes a regular file that nobody has locked; no link, and nothing that cannot be opened.
void remove_unlocked(const std::filesystem::path& path);
/// A rename in the folder survives a power cut from here on; true where that cannot be asked for. False with
/// last_error().
[[nodiscard]] bool sync_folder(const std::filesystem::path& folder);

/// For names that nobody else draws.
[[nodiscard]] std::uint64_t random_number();

/// Bytes that this process may still take by its own limits, or that the machine has; nothing where it cannot be told,
/// or where files tell (base/memory.cpp).
[[nodiscard]] std::optional<std::uint64_t> memory_left();
/// Bytes of this process that are in memory now; 0 where it cannot be told.
[[nodiscard]] std::uint64_t resident_memory();
/// From here on peak_memory() is the most that was resident since; false where the system cannot do that.
[[nodiscard]] bool restart_peak_memory();
/// 0 where it cannot be told.
[[nodiscard]] std::uint64_t peak_memory();
/// Where the allocator keeps what was freed and can be told to give it back.
void give_back_freed_memory();

}  // namespace meshlode::system
