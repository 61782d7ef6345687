// SPDX-License-Identifier: GPL-3.0-or-later
#include "file_kind.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>

#include <meshlode/format.h>

#include "base/file.h"

namespace meshlode::cli {

namespace {

bool is_asset(std::span<const std::uint8_t> bytes) {
  std::uint32_t magic = 0;
  if (bytes.size() < sizeof(magic)) return false;
  std::memcpy(&magic, bytes.data(), sizeof(magic));
  return magic == format::kMagic;
}

/// nullptr: no scene.
const char* scene_name(const std::string& path, std::string_view text) {
  if (text.starts_with("glTF")) return "a GLB scene";
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return "a PLY scene";
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  const bool is_json = first != std::string_view::npos && text[first] == '{';
  if (extension == ".gltf" && is_json) return "a glTF scene";
  if (extension == ".obj") return "an OBJ scene";
  if (extension == ".stl") return "an STL scene";
  return nullptr;
}

}  // namespace

SeenFile look_at_file(const std::string& path) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return {FileForm::kUnreadable};
  const std::span<const std::uint8_t> bytes = file->bytes();
  if (bytes.empty()) return {FileForm::kEmpty};
  if (is_asset(bytes)) return {FileForm::kAsset};
  const char* const name =
      scene_name(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  return name != nullptr ? SeenFile{FileForm::kScene, name} : SeenFile{};
}

Status check_is_no_scene(const std::string& path) {
  const SeenFile seen = look_at_file(path);
  if (seen.form == FileForm::kEmpty) return Error{ErrorCode::kInvalid, path, "the file is empty"};
  if (seen.form != FileForm::kScene) return Ok{};
  return Error{ErrorCode::kInvalid, path,
               std::string("this is ") + seen.name +
                   ", not a .lode asset; make one with 'meshlode build', or look at the scene with 'meshlode plan' or "
                   "'meshlode doctor'"};
}

Result<run::Asset> open_asset(const std::string& path, std::uint64_t max_decoded) {
  if (const Status asset = check_is_no_scene(path); !asset) return asset.error();
  return run::Asset::open(path, max_decoded);
}

}  // namespace meshlode::cli
