// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/import_polygons.h"

#include <string>
#include <utility>

#include "base/hash.h"
#include "base/utf8.h"
#include "scene/import/polygons/obj_materials.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

/// Texture coordinates of OBJ and PLY begin below, glTF's above.
void turn_uvs(std::vector<Primitive>& primitives) {
  for (Primitive& primitive : primitives) {
    for (Vec2f& uv : primitive.uvs[0]) uv.y = 1.0F - uv.y;
  }
}

void add_mesh(Scene& scene, std::string name, std::vector<Primitive> primitives) {
  SourceMesh mesh;
  mesh.name = std::move(name);
  mesh.primitives = std::move(primitives);
  for (Primitive& primitive : mesh.primitives) {
    if (!primitive.material.is_valid()) primitive.material = MaterialId(scene.materials.size() - 1);
  }
  turn_uvs(mesh.primitives);
  scene.instances.push_back({mesh.name, 0, MeshId(scene.meshes.size()), Mat4d(1.0)});
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace

Result<Scene> import_polygons(PolygonReader read, const std::filesystem::path& path,
                              std::span<const std::uint8_t> bytes, const ImportOptions& options) {
  const auto named = [&](const Error& error) {
    return Error{error.code, error.where.empty() ? path.string() : path.string() + ": " + error.where, error.detail};
  };
  auto file = read(bytes, options);
  if (!file) return named(file.error());
  Scene scene;
  scene.left_out = std::move(file->left_out);
  Hasher hasher;
  hasher.update(bytes);
  if (const Status added = add_obj_materials(path, *file, options, hasher, scene); !added) return named(added.error());
  const std::size_t polygon_count = file->soup.polygon_sizes.size(), point_count = file->soup.positions.size();
  auto meshes = triangulate(std::move(file->soup), options, file->drops, scene.left_out);
  if (!meshes) return named(meshes.error());
  for (PolygonMesh& mesh : *meshes) {
    add_mesh(scene, as_utf8(mesh.object == kNoId ? path.stem().string() : file->object_names[mesh.object]),
             std::move(mesh.primitives));
  }
  scene.meshes.front().drops = file->drops;
  if (polygon_count == 0 && point_count != 0) {
    scene.left_out.push_back({"points", "the file has no faces, and " + counted(point_count, "vertex", "vertices")});
  }
  scene.source_hash = to_hex(hasher.digest());
  return scene;
}

}  // namespace meshlode::scene
