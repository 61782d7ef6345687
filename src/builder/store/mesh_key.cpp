// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/store/mesh_key.h"

#include <array>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "builder/hooks.h"

namespace meshlode::builder {

namespace {

static_assert(sizeof(Vec2f) == 8 && sizeof(Vec3f) == 12 && sizeof(Vec4f) == 16 && sizeof(Vec3d) == 24);  // no padding

class KeyHasher {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    hasher_.update({reinterpret_cast<const std::uint8_t*>(&v), sizeof(T)});
  }
  template <class T, std::size_t N>
  void values(const std::array<T, N>& items) {
    for (const T& item : items) value(item);
  }
  /// With its length in front, so that no list runs into the next. `T`: numbers, and vectors of them, which GLM does
  /// not declare trivially copyable.
  template <class T>
  void list(const std::vector<T>& items) {
    static_assert(std::is_standard_layout_v<T>);
    value(std::uint64_t{items.size()});
    hasher_.update({reinterpret_cast<const std::uint8_t*>(items.data()), items.size() * sizeof(T)});
  }
  [[nodiscard]] Hash128 digest() const { return hasher_.digest(); }

 private:
  Hasher hasher_;
};

// In what follows every member has a name, so that one more does not compile before it is hashed or left out on
// purpose.

void add_mesh(KeyHasher& key, const scene::SourceMesh& mesh) {
  const auto& [name, primitives, drops, repairs, is_deformed] = mesh;
  static_cast<void>(name);         // written beside the mesh
  static_cast<void>(is_deformed);  // the gaps say what came of it
  static_cast<void>(repairs);      // reported; the triangles are as they are
  const auto& [repaired] = drops;
  key.value(repaired);
  key.value(std::uint64_t{primitives.size()});
  for (const scene::Primitive& primitive : primitives) {
    const auto& [positions, normals, uvs, colors, has_tangents, indices, material] = primitive;
    static_cast<void>(has_tangents);  // of the plan, which is never stored
    key.list(positions);
    key.list(normals);
    for (const auto& set : uvs) key.list(set);
    key.list(colors);
    key.list(indices);
    key.value(material.value);
  }
}

void add_layout(KeyHasher& key, const AttributeLayout& layout) {
  const auto& [has_normal, flat_normal, uv_set_count, uv_set_source, has_color] = layout;
  key.value(has_normal);
  key.value(flat_normal);
  key.value(uv_set_count);
  key.values(uv_set_source);
  key.value(has_color);
}

void add_encoding(KeyHasher& key, const EncodeOptions& encode) {
  const auto& [normal_error, uv_error, uv_error_may_fall_short, strip_trials, mixed_strip_trials, page_bytes,
               first_page_bytes] = encode;
  key.value(normal_error);
  key.values(uv_error);
  key.value(uv_error_may_fall_short);
  key.value(strip_trials);
  key.value(mixed_strip_trials);
  key.value(page_bytes);
  key.value(first_page_bytes);
}

void add_own_options(KeyHasher& key, const MeshOptions& own) {
  const auto& [error_tier, attributes, keep, drop, grid_step, position_error, normal_error, uv_error,
               uv_error_is_texels, uv_error_is_default, aggregate, aggregate_names, lock_borders] = own;
  key.value(error_tier);
  key.value(grid_step);
  key.value(position_error);
  key.value(lock_borders);
  static_cast<void>(attributes);  // the layout says what they came to, and EncodeOptions what the budgets did
  static_cast<void>(keep);
  static_cast<void>(drop);
  static_cast<void>(normal_error);
  static_cast<void>(uv_error);
  static_cast<void>(uv_error_is_texels);
  static_cast<void>(uv_error_is_default);
  key.value(aggregate);
  static_cast<void>(aggregate_names);  // of aggregates, which are not stored
}

void add_scene_options(KeyHasher& key, const SceneOptions& options) {
  const auto& [preset, codec, strip_effort, partition_seed, repair, linear_colors, promise, keep_topology, keep_layers,
               max_cluster_triangles, max_cluster_vertices, group_clusters, page_kib, page_order, root_bytes,
               page_hints, max_memory, mesh_store, looks, textures, images, hooks, mesh_options] = options;
  key.value(preset);
  key.value(partition_seed);
  key.value(max_cluster_triangles);
  key.value(max_cluster_vertices);
  key.value(group_clusters);
  key.value(page_order);
  key.value(keep_topology);
  key.value(promise);
  const std::string study = hooks != nullptr ? hooks->record : std::string();
  key.list(std::vector<char>(study.begin(), study.end()));
  static_cast<void>(strip_effort);   // EncodeOptions has what it came to
  static_cast<void>(page_kib);       // the same
  static_cast<void>(root_bytes);     // the same
  static_cast<void>(page_hints);     // of the whole asset
  static_cast<void>(keep_layers);    // the gaps say what came of it
  static_cast<void>(codec);          // of the pages on disk, later
  static_cast<void>(repair);         // the triangles are as they are
  static_cast<void>(linear_colors);  // the same
  static_cast<void>(max_memory);
  static_cast<void>(mesh_store);
  static_cast<void>(looks);     // of aggregates, which are not stored
  static_cast<void>(textures);  // no mesh has images
  static_cast<void>(images);
  static_cast<void>(mesh_options);  // this mesh's are its own
}

}  // namespace

Hash128 mesh_key(const scene::SourceMesh& mesh, const AttributeLayout& layout, const EncodeOptions& encode,
                 const MeshOptions& own, const SceneOptions& options, std::span<const TexelExtents> extents,
                 const MeshGaps& gaps) {
  KeyHasher key;
  for (const scene::Primitive& primitive : mesh.primitives) {
    if (primitive.material.value >= extents.size()) continue;
    for (const auto& extent : extents[primitive.material.value]) key.values(extent);
  }
  add_own_options(key, own);
  add_scene_options(key, options);
  add_layout(key, layout);
  add_encoding(key, encode);
  add_mesh(key, mesh);
  const auto& [reach, codes] = gaps;
  key.value(codes.empty() ? 0.0 : reach);
  key.list(codes);
  return key.digest();
}

}  // namespace meshlode::builder
