// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/wedges.h"

#include <bit>

namespace meshlode::scene {

WedgeBuilder::WedgeBuilder(PolygonSoup& soup) : soup_(soup), is_used_(soup.positions.size(), false) {}

std::uint32_t WedgeBuilder::take(std::uint32_t position, const WedgeAttributes& attributes) {
  const auto& [uv, normal, color] = attributes;
  if (!uv && !normal && !color) return position;
  Key key{position};
  std::size_t next = 2;
  const auto put = [&](const auto& value, int components, std::uint32_t bit) {
    if (!value) return;
    key[1] |= bit;
    for (int c = 0; c < components; ++c) key[next++] = std::bit_cast<std::uint32_t>((*value)[c]);
  };
  put(uv, 2, kHasUvs);
  put(normal, 3, kHasNormals);
  put(color, 4, kHasColors);
  const auto [known, is_new] = wedges_.try_emplace(key, position);
  if (!is_new) return known->second;
  if (is_used_[position]) {
    known->second = static_cast<std::uint32_t>(soup_.positions.size());
    soup_.positions.push_back(Vec3d(soup_.positions[position]));
    // Copies first: what is pushed must not lie in the array that grows.
    if (!soup_.normals.empty()) soup_.normals.push_back(Vec3f(soup_.normals[position]));
    if (!soup_.uvs.empty()) soup_.uvs.push_back(Vec2f(soup_.uvs[position]));
    if (!soup_.colors.empty()) soup_.colors.push_back(Vec4f(soup_.colors[position]));
  }
  is_used_[position] = true;
  set(known->second, attributes);
  return known->second;
}

void WedgeBuilder::set(std::uint32_t vertex, const WedgeAttributes& attributes) {
  if (attributes.uv) soup_.uvs[vertex] = *attributes.uv;
  if (attributes.normal) soup_.normals[vertex] = *attributes.normal;
  if (attributes.color) soup_.colors[vertex] = *attributes.color;
}

}  // namespace meshlode::scene
