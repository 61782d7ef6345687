// SPDX-License-Identifier: MIT
#include "base/file.h"

#include <utility>

#include "base/system.h"
#include "base/try.h"

namespace meshlode {

std::optional<FileId> find_file_id(const std::filesystem::path& path) {
  const auto info = system::find_info(path);
  if (!info) return std::nullopt;
  return info->id;
}

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  TRY_LET(mapping, system::map_file(path));
  MappedFile file;
  file.bytes_ = mapping->bytes;
  file.id_ = mapping->id;
  return file;
}

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})), id_(other.id_) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  std::swap(id_, other.id_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) system::unmap(bytes_);
}

}  // namespace meshlode
