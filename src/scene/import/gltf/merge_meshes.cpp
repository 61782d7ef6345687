// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/merge_meshes.h"

#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/variants.h"

namespace meshlode::scene {

namespace {

template <class T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

/// Calls `visit` with the bytes of each array of a primitive, in an order that is always the same.
template <class Visit>
void for_each_array(const Primitive& p, const Visit& visit) {
  visit(bytes_of(p.positions));
  visit(bytes_of(p.normals));
  for (const auto& set : p.uvs) visit(bytes_of(set));
  visit(bytes_of(p.colors));
  visit(bytes_of(p.indices));
}

std::vector<std::span<const std::uint8_t>> arrays_of(const Primitive& p) {
  std::vector<std::span<const std::uint8_t>> out;
  for_each_array(p, [&](std::span<const std::uint8_t> bytes) { out.push_back(bytes); });
  return out;
}

/// By bits: -0 is not 0, because what is stored is not.
bool is_same(const Primitive& a, const Primitive& b) {
  if (a.material != b.material || a.has_tangents != b.has_tangents) return false;
  const auto left = arrays_of(a), right = arrays_of(b);
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (left[i].size() != right[i].size()) return false;
    if (!left[i].empty() && std::memcmp(left[i].data(), right[i].data(), left[i].size()) != 0) return false;
  }
  return true;
}

bool is_same(const SourceMesh& a, const SourceMesh& b) {
  if (a.primitives.size() != b.primitives.size()) return false;
  for (std::size_t p = 0; p < a.primitives.size(); ++p) {
    if (!is_same(a.primitives[p], b.primitives[p])) return false;
  }
  return true;
}

bool has_triangles(const SourceMesh& mesh) {
  for (const Primitive& primitive : mesh.primitives) {
    if (!primitive.indices.empty()) return true;
  }
  return false;
}

Hash128 hash_of(const SourceMesh& mesh) {
  Hasher hasher;
  for (const Primitive& primitive : mesh.primitives) {
    for_each_array(primitive, [&](std::span<const std::uint8_t> bytes) {
      const std::uint64_t size = bytes.size();
      hasher.update({reinterpret_cast<const std::uint8_t*>(&size), sizeof size});
      hasher.update(bytes);
    });
  }
  return hasher.digest();
}

std::string variants_of(const GltfAsset& asset, std::uint32_t mesh) {
  std::vector<LeftOut> said_elsewhere;
  return dump_json(Json{variant_primitives(asset, mesh, said_elsewhere)});
}

/// For each mesh the one that is built in its place: itself, or the first that equals it. Of several with one hash only
/// the first is compared: a collision costs a mesh that could have been shared, and nothing else.
std::vector<std::uint32_t> find_first_equal(const GltfAsset& asset, const std::vector<SourceMesh>& meshes) {
  std::vector<std::uint32_t> out(meshes.size());
  std::map<Hash128, std::uint32_t> first;
  for (std::uint32_t m = 0; m < meshes.size(); ++m) {
    out[m] = m;
    if (!has_triangles(meshes[m])) continue;
    const auto [known, is_new] = first.try_emplace(hash_of(meshes[m]), m);
    if (!is_new && is_same(meshes[known->second], meshes[m]) &&
        variants_of(asset, known->second) == variants_of(asset, m)) {
      out[m] = known->second;
    }
  }
  return out;
}

}  // namespace

void merge_equal_meshes(GltfAsset& asset, Scene& scene) {
  constexpr std::size_t kMostNamed = 8;
  const std::vector<std::uint32_t> place = find_first_equal(asset, scene.meshes);
  std::string names;
  std::size_t merged = 0;
  for (std::uint32_t m = 0; m < place.size(); ++m) {
    if (place[m] == m) continue;
    scene.meshes[m].primitives.clear();
    if (merged < kMostNamed) {
      names += (merged == 0 ? "" : ", ") + std::to_string(m);
      if (!scene.meshes[m].name.empty()) names += " '" + pointer_part(scene.meshes[m].name) + "'";
    }
    ++merged;
  }
  if (merged == 0) return;
  if (merged > kMostNamed) names += " …";
  scene.left_out.push_back({"second copies of " + std::to_string(merged) + " meshes: " + names,
                            "each equals an earlier mesh, which is built once and instanced in its place"});
  for (SceneInstance& instance : scene.instances) instance.mesh = MeshId(place[instance.mesh.value]);
  Json* nodes = asset.root.find("nodes");
  if (nodes == nullptr) return;
  for (Json& node : std::get<Json::Array>(nodes->value)) {
    const Json* mesh = node.find("mesh");
    if (mesh == nullptr) continue;
    const std::uint64_t index = mesh->index().value_or(0);
    if (place[index] != index) node.set("mesh", Json::make_index(place[index]));
  }
}

}  // namespace meshlode::scene
