// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/parts/split_parts.h"

#include <cstddef>
#include <utility>

#include "scene/parts/pieces.h"

namespace meshlode::scene {

namespace {

/// The triangles of a primitive whose piece is one of these or none of them, with their vertices in order.
Primitive take(const Primitive& from, std::span<const std::uint32_t> piece_of_triangle,
               std::span<const std::uint8_t> is_small, std::uint8_t wanted) {
  Primitive out;
  out.has_tangents = from.has_tangents;
  out.material = from.material;
  std::vector<std::uint32_t> number(from.positions.size(), kNoId);
  const auto is_in = [&](std::size_t triangle) { return is_small[piece_of_triangle[triangle]] == wanted; };
  for (std::size_t i = 0; i < from.indices.size(); ++i) {
    if (is_in(i / 3)) number[from.indices[i]] = 0;
  }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNoId) continue;
    number[v] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(v);
  }
  const auto gather = [&](const auto& all, auto& some) {
    if (all.empty()) return;
    some.reserve(kept.size());
    for (const std::uint32_t v : kept) some.push_back(all[v]);
  };
  gather(from.positions, out.positions);
  gather(from.normals, out.normals);
  for (std::size_t set = 0; set < kMaxUvSets; ++set) gather(from.uvs[set], out.uvs[set]);
  gather(from.colors, out.colors);
  for (std::size_t i = 0; i < from.indices.size(); ++i) {
    if (is_in(i / 3)) out.indices.push_back(number[from.indices[i]]);
  }
  return out;
}

/// What is left stays in `mesh`.
SourceMesh take_part(SourceMesh& mesh, const MeshPart& part) {
  const Pieces all(mesh);
  const std::vector<std::uint8_t> is_small = all.find_small(mesh, part.most_triangles);
  SourceMesh taken;
  taken.name = part.name;
  std::vector<Primitive> rest;
  std::size_t first = 0;
  for (Primitive& primitive : mesh.primitives) {
    const std::size_t triangles = primitive.indices.size() / 3;
    const std::span of_triangle = std::span(all.of_triangle).subspan(first, triangles);
    first += triangles;
    for (const bool is_taken : {true, false}) {
      Primitive some = take(primitive, of_triangle, is_small, is_taken ? 1 : 0);
      if (!some.indices.empty()) (is_taken ? taken.primitives : rest).push_back(std::move(some));
    }
    primitive = {};
  }
  mesh.primitives = std::move(rest);
  return taken;
}

}  // namespace

void split_parts(Scene& scene, std::span<const MeshPart> parts) {
  std::vector<MeshId> part_of(scene.meshes.size());  // by mesh; invalid where it has none
  for (const MeshPart& part : parts) {
    part_of[part.of] = MeshId(static_cast<std::uint32_t>(scene.meshes.size()));
    scene.meshes.push_back(take_part(scene.meshes[part.of], part));
  }
  const std::size_t instances = scene.instances.size();
  for (std::size_t i = 0; i < instances; ++i) {
    const MeshId mesh = part_of[scene.instances[i].mesh.value];
    if (!mesh.is_valid()) continue;
    scene.instances.push_back(scene.instances[i]);
    scene.instances.back().mesh = mesh;
  }
}

}  // namespace meshlode::scene
