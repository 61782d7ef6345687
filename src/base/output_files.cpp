// SPDX-License-Identifier: MIT
#include "base/output_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>

namespace meshlode {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = ".meshlode-", kSuffix = ".tmp";
constexpr std::size_t kDigits = 16;

Error io_error(const fs::path& path, const char* what) {
  return {ErrorCode::kIo, path.string(), std::string(what) + ": " + std::strerror(errno)};
}

std::optional<struct stat> stat_of(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return std::nullopt;
  return info;
}

FileId id_of(const struct stat& info) {
  return {static_cast<std::uint64_t>(info.st_dev), static_cast<std::uint64_t>(info.st_ino)};
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
  std::array<std::uint8_t, kDigits / 2> bytes{};
  if (::getentropy(bytes.data(), bytes.size()) != 0) {
    const auto pid = static_cast<std::uint64_t>(::getpid());  // names need only be free: the file is opened exclusively
    std::memcpy(bytes.data(), &pid, sizeof pid);
  }
  std::string name(kPrefix);
  for (const std::uint8_t byte : bytes) {
    name += "0123456789abcdef"[byte >> 4U];
    name += "0123456789abcdef"[byte & 15U];
  }
  return name += kSuffix;
}

bool is_temporary_name(std::string_view name) {
  constexpr std::size_t kSize = kPrefix.size() + kDigits + kSuffix.size();
  if (name.size() != kSize || !name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return false;
  const std::string_view digits = name.substr(kPrefix.size(), kDigits);
  return digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Unlinks the temporary files in a folder that no living writer has locked. What cannot be opened or locked stays.
void remove_left_behind(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (!is_temporary_name(entry->path().filename().native())) continue;
    const int file = ::open(entry->path().c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) continue;
    struct stat info {};
    // A name without links is one that its owner has just renamed or removed.
    if (::fstat(file, &info) == 0 && S_ISREG(info.st_mode) && ::flock(file, LOCK_EX | LOCK_NB) == 0 &&
        ::fstat(file, &info) == 0 && info.st_nlink > 0) {
      ::unlink(entry->path().c_str());
    }
    ::close(file);
  }
}

bool write_all(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = EIO;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

/// Devices and pipes: there is nothing to rename over.
Status write_through(const fs::path& path, std::span<const std::uint8_t> bytes) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return io_error(path, "cannot open");
  if (!write_all(descriptor, bytes)) {
    Error error = io_error(path, "cannot write");
    ::close(descriptor);
    return error;
  }
  if (::close(descriptor) != 0) return io_error(path, "cannot close");
  return Ok{};
}

/// The rename itself must survive a power cut. File systems that cannot sync folders, and folders that may be written
/// but not read, are left alone.
Status sync_folder(const fs::path& path) {
  const int folder = ::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return Ok{};
  Status status = Ok{};
  if (::fsync(folder) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS) {
    status = io_error(path, "written, but its folder cannot be synced");
  }
  ::close(folder);
  return status;
}

}  // namespace

struct OutputFiles::Temporary {
  std::string name;
  int descriptor = -1;
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
  const auto info = stat_of(path);
  if (!info) return Ok{};
  if (read_.contains(id_of(*info))) {
    return Error{ErrorCode::kUsage, path.string(), "the output would overwrite a file that was read"};
  }
  if (written_.contains(id_of(*info))) {
    return Error{ErrorCode::kUsage, path.string(), "the output would overwrite another output"};
  }
  return Ok{};
}

Status OutputFiles::claim(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  if (Status status = check_identity(path); !status) return status;
  if (const auto info = stat_of(path); info && !S_ISREG(info->st_mode)) {
    if (S_ISDIR(info->st_mode)) return Error{ErrorCode::kIo, path.string(), "is a folder"};
    if (::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) return io_error(path, "cannot be written");
    return Ok{};
  }
  const fs::path folder = folder_of(follow_links(path));
  const auto info = stat_of(folder);
  if (!info) return io_error(path, "cannot be written, its folder");
  if (!S_ISDIR(info->st_mode)) return Error{ErrorCode::kIo, path.string(), "lies in a file, not in a folder"};
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    return io_error(path, "cannot be written, its folder");
  }
  if (swept_.insert(id_of(*info)).second) remove_left_behind(folder);
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
    // Born with the mode that any other new file here would have.
    file.descriptor = ::open(file.name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file.descriptor < 0 && errno == EEXIST) continue;
    if (file.descriptor < 0) return io_error(path, "cannot create a temporary file beside it");
    // A file system without locks is one where nobody can take this file for a dead one either.
    ::flock(file.descriptor, LOCK_EX);
    struct stat info {};
    if (::fstat(file.descriptor, &info) == 0 && info.st_nlink > 0) {
      temporaries_.push_back(file.name);
      return Ok{};
    }
    ::close(file.descriptor);  // someone took it for a dead one before it was locked
  }
  return Error{ErrorCode::kIo, path.string(), "cannot create a temporary file beside it"};
}

void OutputFiles::forget(const Temporary& file) {
  temporaries_.erase(std::remove(temporaries_.begin(), temporaries_.end(), file.name), temporaries_.end());
}

Status OutputFiles::put_in_place(Temporary& file, const fs::path& path, const fs::path& target) {
  const std::lock_guard lock(mutex_);
  if (is_abandoned_) return Error{ErrorCode::kIo, path.string(), "not written: interrupted"};
  if (Status status = check_identity(path); !status) return status;
  struct stat info {};
  if (::fstat(file.descriptor, &info) != 0) return io_error(path, "cannot stat its temporary file");
  if (::rename(file.name.c_str(), target.c_str()) != 0) return io_error(path, "cannot rename into place");
  forget(file);
  written_.insert(id_of(info));
  return Ok{};
}

Status OutputFiles::write(const fs::path& path, std::span<const std::uint8_t> bytes) {
  if (Status status = claim(path); !status) return status;
  if (const auto info = stat_of(path); info && !S_ISREG(info->st_mode)) return write_through(path, bytes);
  const fs::path target = follow_links(path);
  Temporary file;
  if (Status status = create(file, path); !status) return status;
  Status status = Ok{};
  if (!write_all(file.descriptor, bytes)) {
    status = io_error(path, "cannot write");
  } else if (::fsync(file.descriptor) != 0) {
    status = io_error(path, "cannot sync");
  } else {
    status = put_in_place(file, path, target);
  }
  if (!status) {
    const std::lock_guard lock(mutex_);
    ::unlink(file.name.c_str());
    forget(file);
  }
  ::close(file.descriptor);  // after the sync it has nothing to report
  if (!status) return status;
  return sync_folder(target);
}

void OutputFiles::abandon() {
  const std::lock_guard lock(mutex_);
  is_abandoned_ = true;
  for (const std::string& name : temporaries_) ::unlink(name.c_str());
  temporaries_.clear();
}

bool is_same_place(const fs::path& a, const fs::path& b) {
  const auto info_a = stat_of(a), info_b = stat_of(b);
  if (info_a && info_b) return id_of(*info_a) == id_of(*info_b);
  if (info_a || info_b) return false;
  const fs::path end_a = follow_links(a), end_b = follow_links(b);
  const auto folder_a = stat_of(folder_of(end_a)), folder_b = stat_of(folder_of(end_b));
  if (!folder_a || !folder_b) return end_a.lexically_normal() == end_b.lexically_normal();
  return id_of(*folder_a) == id_of(*folder_b) && end_a.filename() == end_b.filename();
}

Status write_file_atomically(const fs::path& path, std::span<const std::uint8_t> bytes) {
  return OutputFiles().write(path, bytes);
}

}  // namespace meshlode
