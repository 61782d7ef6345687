// SPDX-License-Identifier: MIT
#include "base/file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace meshlode {

namespace {

Error io_error(const std::filesystem::path& path, const char* what) {
  return {ErrorCode::kIo, path.string(), std::string(what) + ": " + std::strerror(errno)};
}

}  // namespace

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return io_error(path, "cannot open");
  struct stat info {};
  MappedFile file;
  if (::fstat(descriptor, &info) != 0) {
    const Error error = io_error(path, "cannot stat");
    ::close(descriptor);
    return error;
  }
  if (!S_ISREG(info.st_mode)) {
    ::close(descriptor);
    return Error{ErrorCode::kIo, path.string(), "not a regular file"};
  }
  if (info.st_size > 0) {
    const auto size = static_cast<std::size_t>(info.st_size);
    void* address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (address == MAP_FAILED) {
      const Error error = io_error(path, "cannot map");
      ::close(descriptor);
      return error;
    }
    file.bytes_ = {static_cast<const std::uint8_t*>(address), size};
  }
  ::close(descriptor);
  return file;
}

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

Status write_file_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::string name = path.string() + ".XXXXXX";
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) return io_error(path, "cannot create a temporary file beside it");
  const auto fail = [&](const char* what) {
    Error error = io_error(path, what);
    ::close(descriptor);
    ::unlink(name.c_str());
    return error;
  };
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t written = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (written < 0) {
      if (errno == EINTR) continue;
      return fail("cannot write");
    }
    done += static_cast<std::size_t>(written);
  }
  // mkstemp makes the file private; give it the mode that any other new file would have.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  if (::fchmod(descriptor, 0666 & ~mask) != 0) return fail("cannot set the mode");
  if (::fsync(descriptor) != 0) return fail("cannot sync");
  if (::close(descriptor) != 0) {
    Error error = io_error(path, "cannot close");
    ::unlink(name.c_str());
    return error;
  }
  if (::rename(name.c_str(), path.c_str()) != 0) {
    Error error = io_error(path, "cannot rename into place");
    ::unlink(name.c_str());
    return error;
  }
  return Ok{};
}

}  // namespace meshlode
