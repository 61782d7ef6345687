// SPDX-License-Identifier: MIT
#include "base/output_files.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "base/system.h"

namespace meshlode {

namespace {

namespace fs = std::filesystem;
using system::FileKind;

constexpr std::string_view kPrefix = ".meshlode-", kSuffix = ".tmp";
constexpr std::size_t kDigits = 16;

Error io_error(const fs::path& path, const char* what) {
  return {ErrorCode::kIo, path.string(), std::string(what) + ": " + system::last_error()};
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Where a write to `path` ends up: links are followed, also to files that do not exist yet.
fs::path follow_links(fs::path path) {
  constexpr int kMaxLinks = 40;  // as in the kernel; a longer chain fails when it is opened
  std::error_code error;
  for (int i = 0; i < kMaxLinks && fs::is_symlink(path, error); ++i) {
    const fs::path next = fs::read_symlink(path, error);
    if (error) break;
    path = next.is_absolute() ? next : folder_of(path) / next;
  }
  return path;
}

std::string random_name() {
  std::string name(kPrefix);
  std::uint64_t number = system::random_number();
  for (std::size_t i = 0; i < kDigits; ++i, number >>= 4U) name += "0123456789abcdef"[number & 15U];
  return name += kSuffix;
}

bool is_temporary_name(std::string_view name) {
  constexpr std::size_t kSize = kPrefix.size() + kDigits + kSuffix.size();
  if (name.size() != kSize || !name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return false;
  const std::string_view digits = name.substr(kPrefix.size(), kDigits);
  return digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Removes the temporary files in a folder that no living writer has locked. What cannot be opened or locked stays.
void remove_left_behind(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (is_temporary_name(entry->path().filename().string())) system::remove_unlocked(entry->path());
  }
}

/// Of a folder that is to be made the nearest one that is there; the folder itself where it is there.
fs::path nearest_folder(fs::path folder) {
  while (!system::find_info(folder)) {
    fs::path above = folder_of(folder);
    if (above == folder) break;
    folder = std::move(above);
  }
  return folder;
}

/// Devices and pipes: there is nothing to rename over.
Status write_through(const fs::path& path, std::span<const std::uint8_t> bytes) {
  const system::Handle device = system::open_device(path);
  if (device == system::kNoHandle) return io_error(path, "cannot open");
  if (!system::write_all(device, bytes)) {
    Error error = io_error(path, "cannot write");
    system::close(device);
    return error;
  }
  if (!system::close(device)) return io_error(path, "cannot close");
  return Ok{};
}

}  // namespace

struct OutputFiles::Temporary {
  std::string name;
  system::Handle handle = system::kNoHandle;
};

void OutputFiles::keep(FileId id) {
  const std::lock_guard lock(mutex_);
  read_.insert(id);
}

void OutputFiles::keep(std::span<const FileId> ids) {
  const std::lock_guard lock(mutex_);
  read_.insert(ids.begin(), ids.end());
}

/// \pre mutex_ is held
Status OutputFiles::check_identity(const fs::path& path) const {
  const auto info = system::find_info(path);
  if (!info) return Ok{};
  if (read_.contains(info->id)) {
    return Error{ErrorCode::kUsage, path.string(), "the output would overwrite a file that was read"};
  }
  if (written_.contains(info->id)) {
    return Error{ErrorCode::kUsage, path.string(), "the output would overwrite another output"};
  }
  return Ok{};
}

Status OutputFiles::claim(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  if (Status status = check_identity(path); !status) return status;
  if (const auto info = system::find_info(path); info && info->kind != FileKind::kRegular) {
    if (info->kind == FileKind::kFolder) return Error{ErrorCode::kIo, path.string(), "is a folder"};
    if (!system::may_write(path, info->kind)) return io_error(path, "cannot be written");
    return Ok{};
  }
  fs::path folder = folder_of(follow_links(path));
  if (makes_folders_) folder = nearest_folder(folder);
  const auto info = system::find_info(folder);
  if (!info) return io_error(path, "cannot be written, its folder");
  if (info->kind != FileKind::kFolder) return Error{ErrorCode::kIo, path.string(), "lies in a file, not in a folder"};
  if (!system::may_write(folder, info->kind)) return io_error(path, "cannot be written, its folder");
  if (swept_.insert(info->id).second) remove_left_behind(folder);
  return Ok{};
}

/// Creates the temporary file, locked, under a name that nobody has.
Status OutputFiles::create(Temporary& file, const fs::path& path) {
  constexpr int kAttempts = 16;
  const fs::path folder = folder_of(follow_links(path));
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const std::lock_guard lock(mutex_);
    if (is_abandoned_) return Error{ErrorCode::kIo, path.string(), "not written: interrupted"};
    file.name = (folder / random_name()).string();
    const system::Created created = system::create_locked(file.name, file.handle);
    if (created == system::Created::kFailed) return io_error(path, "cannot create a temporary file beside it");
    if (created == system::Created::kNameTaken) continue;
    temporaries_.push_back(file.name);
    return Ok{};
  }
  return Error{ErrorCode::kIo, path.string(), "cannot create a temporary file beside it"};
}

void OutputFiles::forget(const Temporary& file) {
  temporaries_.erase(std::remove(temporaries_.begin(), temporaries_.end(), file.name), temporaries_.end());
}

Status OutputFiles::put_in_place(Temporary& file, const fs::path& path, const fs::path& target, Durability durability) {
  const std::lock_guard lock(mutex_);
  if (is_abandoned_) return Error{ErrorCode::kIo, path.string(), "not written: interrupted"};
  if (Status status = check_identity(path); !status) return status;
  const auto info = system::info_of(file.handle);
  if (!info) return io_error(path, "cannot stat its temporary file");
  if (!system::rename_over(file.name, target)) return io_error(path, "cannot rename into place");
  forget(file);
  if (durability == Durability::kSynced) written_.insert(info->id);
  return Ok{};
}

Status OutputFiles::write(const fs::path& path, std::span<const std::uint8_t> bytes) {
  return write_as(path, bytes, Durability::kSynced);
}

Status OutputFiles::rewrite(const fs::path& path, std::span<const std::uint8_t> bytes) {
  return write_as(path, bytes, Durability::kWrittenAgain);
}

Status OutputFiles::write_as(const fs::path& path, std::span<const std::uint8_t> bytes, Durability durability) {
  if (Status status = claim(path); !status) return status;
  const auto there = system::find_info(path);
  if (there && there->kind != FileKind::kRegular) return write_through(path, bytes);
  const fs::path target = follow_links(path);
  if (makes_folders_) {
    std::error_code error;
    fs::create_directories(folder_of(target), error);
    if (error) return Error{ErrorCode::kIo, path.string(), "cannot make its folder: " + error.message()};
  }
  const bool is_synced = durability == Durability::kSynced;
  Temporary file;
  if (Status status = create(file, path); !status) return status;
  Status status = Ok{};
  if (!system::write_all(file.handle, bytes)) {
    status = io_error(path, "cannot write");
  } else if (is_synced && !system::sync(file.handle)) {
    status = io_error(path, "cannot sync");
  } else {
    status = put_in_place(file, path, target, durability);
  }
  if (!status) {
    const std::lock_guard lock(mutex_);
    system::remove_file(file.name);
    forget(file);
  }
  system::close(file.handle);  // after the sync it has nothing to report
  if (!status) return status;
  // The rename itself must survive a power cut.
  if (is_synced && !system::sync_folder(folder_of(target)))
    return io_error(path, "written, but its folder cannot be synced");
  return Ok{};
}

bool OutputFiles::has_written(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  const auto info = system::find_info(path);
  return info && written_.contains(info->id);
}

void OutputFiles::abandon() {
  const std::lock_guard lock(mutex_);
  is_abandoned_ = true;
  for (const std::string& name : temporaries_) system::remove_file(name);
  temporaries_.clear();
}

bool is_same_place(const fs::path& a, const fs::path& b) {
  const auto info_a = system::find_info(a), info_b = system::find_info(b);
  if (info_a && info_b) return info_a->id == info_b->id;
  if (info_a || info_b) return false;
  const fs::path end_a = follow_links(a), end_b = follow_links(b);
  const auto folder_a = system::find_info(folder_of(end_a)), folder_b = system::find_info(folder_of(end_b));
  if (!folder_a || !folder_b) return end_a.lexically_normal() == end_b.lexically_normal();
  return folder_a->id == folder_b->id && end_a.filename() == end_b.filename();
}

Status write_file_atomically(const fs::path& path, std::span<const std::uint8_t> bytes) {
  return OutputFiles().write(path, bytes);
}

}  // namespace meshlode
