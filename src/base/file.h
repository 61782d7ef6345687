// SPDX-License-Identifier: MIT
// Files appear whole or not at all; inputs are mapped, not copied.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include <meshlode/result.h>

#include "base/file_id.h"

namespace meshlode {

/// Links are followed; nothing where there is no such file.
[[nodiscard]] std::optional<FileId> find_file_id(const std::filesystem::path& path);

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
  [[nodiscard]] FileId id() const { return id_; }

 private:
  MappedFile() = default;
  std::span<const std::uint8_t> bytes_;
  FileId id_;
};

/// One file by itself (base/output_files.h): whole or not at all, and on error nothing is left behind.
[[nodiscard]] Status write_file_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

}  // namespace meshlode
