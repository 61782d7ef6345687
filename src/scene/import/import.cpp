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
#include "base/hash.h"
#include "base/utf8.h"
#include "scene/import/gltf/gltf_import.h"
#include "scene/import/polygons/obj_materials.h"
#include "scene/import/polygons/polygon_soup.h"
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
  if (text.starts_with("ply\n") || text.starts_with("ply\r\n")) return Format::kPly;
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
    return Error{ErrorCode::kUnsupported, path.string(),
                 "this is a .lode asset, not a scene; look at it with 'meshlode info', store it anew with "
                 "'meshlode repack'"};
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.find_first_not_of(" \t\r\n\f\v") != std::string_view::npos) return Ok{};
  return Error{ErrorCode::kInvalid, path.string(), "the file is empty: nothing but white space"};
}

/// OBJ's texture coordinates begin below, glTF's above.
void turn_uvs(std::vector<Primitive>& primitives) {
  for (Primitive& primitive : primitives) {
    for (Vec2f& uv : primitive.uvs[0]) uv.y = 1.0F - uv.y;
  }
}

/// One mesh, one instance; the materials that an OBJ names, or the default one.
Result<Scene> import_polygons(Format format, const std::filesystem::path& path, std::span<const std::uint8_t> bytes,
                              const ImportOptions& options) {
  const auto named = [&](const Error& error) {
    return Error{error.code, error.where.empty() ? path.string() : path.string() + ": " + error.where, error.detail};
  };
  auto file = format == Format::kPly   ? read_ply(bytes, options)
              : format == Format::kObj ? read_obj(bytes, options)
                                       : read_stl(bytes, options);
  if (!file) return named(file.error());
  Scene scene;
  scene.left_out = std::move(file->left_out);
  SourceMesh mesh;
  mesh.name = as_utf8(path.stem().string());
  mesh.drops = file->drops;
  Hasher hasher;
  hasher.update(bytes);
  if (const Status added = add_obj_materials(path, *file, options, hasher, scene); !added) return named(added.error());
  auto primitives = triangulate(std::move(file->soup), options, mesh.drops, scene.left_out);
  if (!primitives) return named(primitives.error());
  for (Primitive& primitive : *primitives) {
    if (!primitive.material.is_valid()) primitive.material = MaterialId(scene.materials.size() - 1);
  }
  if (primitives->size() == 1 && primitives->front().indices.empty() && !primitives->front().positions.empty()) {
    scene.left_out.push_back({"points", "the file has no faces"});
  }
  if (!scene.blobs.empty()) turn_uvs(*primitives);  // without a texture nobody samples with them
  mesh.primitives = std::move(*primitives);
  scene.instances.push_back({mesh.name, 0, MeshId(0U), Mat4d(1.0)});
  scene.meshes.push_back(std::move(mesh));
  scene.source_hash = to_hex(hasher.digest());
  return scene;
}

}  // namespace

Result<Scene> import_scene(const std::filesystem::path& path, const ImportOptions& options) {
  return guarded(path, [&]() -> Result<Scene> {
    auto file = MappedFile::open(path);
    if (!file) return file.error();
    if (options.files_read != nullptr) options.files_read->push_back(file->id());
    const auto bytes = file->bytes();
    if (Status scene = check_is_scene(path, bytes); !scene) return scene.error();
    const auto format = find_format(path, bytes);
    if (!format) {
      return Error{ErrorCode::kUnsupported, path.string(), "not glTF, GLB, PLY, OBJ or STL, by content or extension"};
    }
    if (*format != Format::kGltf && !options.scene.empty() && options.scene != "all") {
      return Error{ErrorCode::kUsage, path.string(), "--scene: only glTF has scenes"};
    }
    auto scene =
        *format == Format::kGltf ? import_gltf(path, bytes, options) : import_polygons(*format, path, bytes, options);
    if (!scene) return scene;
    scene->source_name = path.filename().string();
    if (options.repair) repair_scene(*scene);
    return scene;
  });
}

Result<std::vector<FileReference>> list_references(const std::filesystem::path& path,
                                                   std::span<const std::filesystem::path> allow_outside) {
  return guarded(path, [&]() -> Result<std::vector<FileReference>> {
    const auto file = MappedFile::open(path);
    if (!file) return file.error();
    if (Status scene = check_is_scene(path, file->bytes()); !scene) return scene.error();
    const auto format = find_format(path, file->bytes());
    if (format == Format::kGltf) return list_gltf_references(path, file->bytes(), allow_outside);
    if (format == Format::kObj) return list_obj_references(path, file->bytes(), allow_outside);
    return std::vector<FileReference>{};
  });
}

}  // namespace meshlode::scene
