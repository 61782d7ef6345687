// SPDX-License-Identifier: MIT
// Files appear whole or not at all; inputs are mapped, not copied.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include <meshlode/result.h>

namespace meshlode {

/// A file mapped read-only. Regular files only: a pipe or a folder is an error. An empty file maps to an empty span.
class MappedFile {
 public:
  [[nodiscard]] static Result<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  MappedFile() = default;
  std::span<const std::uint8_t> bytes_;
};

/// Writes to a temporary file beside `path`, fsyncs it, and renames it over `path`. On error nothing is left behind.
[[nodiscard]] Status write_file_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

}  // namespace meshlode
