// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/try.h"
#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/uri.h"

namespace meshlode::scene {

Result<std::span<const std::uint8_t>> GltfFiles::open(std::string_view uri) {
  if (is_data_uri(uri)) {
    TRY_LET(data, decode_data_uri(uri));
    decoded_.push_back(std::move(data->bytes));
    return std::span<const std::uint8_t>(decoded_.back());
  }
  TRY_LET(path, resolve_uri(folder_, uri, allow_outside_));
  const auto known = by_path_.find(path->string());
  if (known != by_path_.end()) return mapped_[known->second].bytes();
  auto file = MappedFile::open(*path);
  if (!file) return Error{file.error().code, "", file.error().message()};
  if (files_read_ != nullptr) files_read_->push_back(file->id());
  mapped_.push_back(std::move(*file));
  by_path_[path->string()] = mapped_.size() - 1;
  const auto bytes = mapped_.back().bytes();
  hasher_.update(bytes);
  total_bytes_ += bytes.size();
  return bytes;
}

}  // namespace meshlode::scene
