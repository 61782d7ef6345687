// SPDX-License-Identifier: GPL-3.0-or-later
// The door: tells formats apart and hands the bytes to the one that knows them.
#include "scene/import/import.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>

#include "base/file.h"
#include "base/guarded.h"
#include "base/try.h"
#include "scene/count/file_triangles.h"
#include "scene/import/gltf/gltf_import.h"
#include "scene/import/polygons/import_polygons.h"
#include "scene/import/polygons/obj_materials.h"
#include "scene/import/polygons/polygon_soup.h"
#include "scene/import/polygons/text_scan.h"
#include "scene/repair/repair.h"

namespace meshlode::scene {

namespace {

enum class Format { kGltf, kPly, kObj, kStl };

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return extension;
}

/// By content where it is clear, else by extension.
std::optional<Format> find_format(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("glTF")) return Format::kGltf;
  std::string_view rest = text_of(bytes.first(std::min<std::size_t>(bytes.size(), 16)));
  if (rest.starts_with("ply") && trimmed(take_line(rest)) == "ply") return Format::kPly;
  const std::string extension = lower_extension(path);
  if (extension == ".gltf" || extension == ".glb") return Format::kGltf;
  if (extension == ".ply") return Format::kPly;
  if (extension == ".obj") return Format::kObj;
  if (extension == ".stl") return Format::kStl;
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string_view::npos && text[first] == '{') return Format::kGltf;
  return std::nullopt;
}

/// Files that are no scene whatever they are called. Errors: kInvalid nothing is in it; kUnsupported an asset.
Status check_is_scene(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.empty()) return Error{ErrorCode::kInvalid, path.string(), "the file is empty"};
  if (text.starts_with("LODE")) {
    return Error{
        ErrorCode::kUnsupported, path.string(),
        "this is a .lode asset, not a scene; look at it with 'meshlode info', change its codec with 'meshlode repack'"};
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.find_first_not_of(" \t\r\n\f\v") != std::string_view::npos) return Ok{};
  return Error{ErrorCode::kInvalid, path.string(), "the file is empty: nothing but white space"};
}

PolygonReader reader_of(Format format) {
  return format == Format::kPly ? &read_ply : format == Format::kObj ? &read_obj : &read_stl;
}

}  // namespace

Result<Scene> import_scene(const std::filesystem::path& path, const ImportOptions& options) {
  return guarded(path, [&]() -> Result<Scene> {
    TRY_LET(file, MappedFile::open(path));
    if (options.files_read != nullptr) options.files_read->push_back(file->id());
    const auto bytes = file->bytes();
    TRY(check_is_scene(path, bytes));
    const auto format = find_format(path, bytes);
    if (!format) {
      return Error{ErrorCode::kUnsupported, path.string(), "not glTF, GLB, PLY, OBJ or STL, by content or extension"};
    }
    if (*format != Format::kGltf && !options.scene.empty() && options.scene != "all") {
      return Error{ErrorCode::kUsage, path.string(), "--scene: only glTF has scenes"};
    }
    auto scene = *format == Format::kGltf ? import_gltf(path, bytes, options)
                                          : import_polygons(reader_of(*format), path, bytes, options);
    if (!scene) return scene;
    scene->source_name = path.filename().string();
    if (const auto held = count_file_triangles(bytes, scene->source_name)) scene->triangles_in_file = held->at_least;
    if (options.repair) repair_scene(*scene);
    return scene;
  });
}

std::string_view find_format_name(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  const auto format = check_is_scene(path, bytes) ? find_format(path, bytes) : std::nullopt;
  if (!format) return {};
  switch (*format) {
    case Format::kPly: return "PLY";
    case Format::kObj: return "OBJ";
    case Format::kStl: return "STL";
    default: break;
  }
  return bytes.front() == 'g' ? "GLB" : "glTF";
}

Result<std::vector<FileReference>> list_references(const std::filesystem::path& path,
                                                   std::span<const std::filesystem::path> allow_outside) {
  return guarded(path, [&]() -> Result<std::vector<FileReference>> {
    TRY_LET(file, MappedFile::open(path));
    TRY(check_is_scene(path, file->bytes()));
    const auto format = find_format(path, file->bytes());
    if (format == Format::kGltf) return list_gltf_references(path, file->bytes(), allow_outside);
    if (format == Format::kObj) return list_obj_references(path, file->bytes(), allow_outside);
    if (format == Format::kPly) return list_ply_references(path, file->bytes(), allow_outside);
    return std::vector<FileReference>{};
  });
}

}  // namespace meshlode::scene
