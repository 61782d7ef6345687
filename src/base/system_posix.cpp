// SPDX-License-Identifier: MIT
// Linux, and what else is POSIX with mmap and flock.
#include "base/system.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace meshlode::system {

namespace {

namespace fs = std::filesystem;

FileInfo info_from(const struct stat& info) {
  const FileId id{static_cast<std::uint64_t>(info.st_dev), static_cast<std::uint64_t>(info.st_ino)};
  if (S_ISREG(info.st_mode)) return {id, FileKind::kRegular};
  return {id, S_ISDIR(info.st_mode) ? FileKind::kFolder : FileKind::kOther};
}

int descriptor_of(Handle file) {
  return static_cast<int>(file);
}

Error io_error(const fs::path& path, const char* what) {
  return {ErrorCode::kIo, path.string(), std::string(what) + ": " + last_error()};
}

Result<Mapping> map_descriptor(int descriptor, const fs::path& path) {
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) return io_error(path, "cannot stat");
  if (!S_ISREG(info.st_mode)) return Error{ErrorCode::kIo, path.string(), "not a regular file"};
  Mapping out{{}, info_from(info).id};
  if (info.st_size == 0) return out;
  const auto size = static_cast<std::size_t>(info.st_size);
  void* address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (address == MAP_FAILED) return io_error(path, "cannot map");
  out.bytes = {static_cast<const std::uint8_t*>(address), size};
  return out;
}

}  // namespace

std::string last_error() {
  return std::strerror(errno);
}

std::optional<FileInfo> find_info(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return std::nullopt;
  return info_from(info);
}

bool may_write(const fs::path& path, FileKind kind) {
  const int mode = kind == FileKind::kFolder ? W_OK | X_OK : W_OK;
  return ::faccessat(AT_FDCWD, path.c_str(), mode, AT_EACCESS) == 0;
}

Result<Mapping> map_file(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return io_error(path, "cannot open");
  auto mapping = map_descriptor(descriptor, path);
  ::close(descriptor);
  return mapping;
}

void unmap(std::span<const std::uint8_t> bytes) {
  ::munmap(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
}

Created create_locked(const fs::path& path, Handle& file) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return errno == EEXIST ? Created::kNameTaken : Created::kFailed;
  // A file system without locks is one where nobody can take this file for a dead one either.
  ::flock(descriptor, LOCK_EX);
  struct stat info {};
  if (::fstat(descriptor, &info) == 0 && info.st_nlink > 0) {
    file = descriptor;
    return Created::kYes;
  }
  ::close(descriptor);  // someone took it for a dead one before it was locked
  return Created::kNameTaken;
}

Handle open_device(const fs::path& path) {
  return ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
}

bool write_all(Handle file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_of(file), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = EIO;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

bool sync(Handle file) {
  return ::fsync(descriptor_of(file)) == 0;
}

bool close(Handle file) {
  return ::close(descriptor_of(file)) == 0;
}

std::optional<FileInfo> info_of(Handle file) {
  struct stat info {};
  if (::fstat(descriptor_of(file), &info) != 0) return std::nullopt;
  return info_from(info);
}

bool rename_over(const fs::path& from, const fs::path& to) {
  return ::rename(from.c_str(), to.c_str()) == 0;
}

void remove_file(const fs::path& path) {
  ::unlink(path.c_str());
}

void remove_unlocked(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return;
  struct stat info {};
  // A name without links is one that its owner has just renamed or removed.
  if (::fstat(file, &info) == 0 && S_ISREG(info.st_mode) && ::flock(file, LOCK_EX | LOCK_NB) == 0 &&
      ::fstat(file, &info) == 0 && info.st_nlink > 0) {
    ::unlink(path.c_str());
  }
  ::close(file);
}

/// File systems that cannot sync folders, and folders that may be written but not read, are left alone.
bool sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return true;
  const bool is_synced = ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS;
  const int error = errno;
  ::close(descriptor);
  errno = error;
  return is_synced;
}

std::uint64_t random_number() {
  std::uint64_t number = 0;
  if (::getentropy(&number, sizeof number) != 0) number = static_cast<std::uint64_t>(::getpid());
  return number;
}

std::optional<std::uint64_t> memory_left() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  const std::uint64_t used = resident_memory();  // of addresses more are taken: an estimate, as all of this is
  return limit.rlim_cur - (used < limit.rlim_cur ? used : limit.rlim_cur);
}

std::uint64_t resident_memory() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t pages = 0, resident = 0;
  if (!(in >> pages >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

bool restart_peak_memory() {
  std::ofstream out("/proc/self/clear_refs");
  return static_cast<bool>(out << "5" << std::flush);  // proc(5): the peak starts anew from what is resident now
}

std::uint64_t peak_memory() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("VmHWM:")) return std::strtoull(line.c_str() + 6, nullptr, 10) * 1024;
  }
  return 0;
}

void give_back_freed_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

}  // namespace meshlode::system
