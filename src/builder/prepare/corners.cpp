// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/prepare/corners.h"

#include <cmath>
#include <cstddef>

#include "base/parallel.h"

namespace meshlode::builder {

namespace {

float canonical_zero(float value) {
  return value == 0.0F ? 0.0F : value;
}

Vec3f flat_normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d cross = glm::cross(b - a, c - a);
  const double length = std::sqrt(glm::dot(cross, cross));
  return length > 0.0 && std::isfinite(length) ? Vec3f(cross / length) : Vec3f(0.0F, 0.0F, 1.0F);
}

/// `to`: where it goes in `out`, which has room.
void write_vertex(const scene::Primitive& primitive, std::uint32_t vertex, const Vec3f& normal,
                  const AttributeLayout& layout, std::size_t to, Corners& out) {
  out.positions[to] = primitive.positions[vertex] + 0.0;  // + 0.0 turns -0 into 0
  float* next = out.attributes.data() + to * layout.stride();
  if (layout.has_normal) {
    for (int k = 0; k < 3; ++k) *next++ = canonical_zero(normal[k]);
  }
  for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
    const std::vector<Vec2f>& uvs = primitive.uvs[layout.uv_set_source[set]];
    const Vec2f uv = uvs.empty() ? Vec2f(0.0F) : uvs[vertex];
    *next++ = canonical_zero(uv.x);
    *next++ = canonical_zero(uv.y);
  }
  if (layout.has_color) {
    const Vec4f color = primitive.colors.empty() ? Vec4f(1.0F) : primitive.colors[vertex];
    for (int k = 0; k < 4; ++k) *next++ = canonical_zero(color[k]);
  }
}

/// Flat normals, as glTF asks for: every corner becomes a vertex of its own.
bool has_flat_corners(const scene::Primitive& primitive, const AttributeLayout& layout) {
  return layout.has_normal && primitive.normals.empty();
}

/// Writes a primitive's vertices from `first` on and its corners from `first_corner` on.
void write_primitive(const scene::Primitive& primitive, const AttributeLayout& layout, std::size_t first,
                     std::size_t first_corner, Corners& out) {
  const std::vector<std::uint32_t>& indices = primitive.indices;
  if (has_flat_corners(primitive, layout)) {
    parallel_for_each_index(indices.size() / 3, kLoopGrain, [&](std::size_t t) {
      const std::uint32_t* corner = &indices[3 * t];
      const Vec3f normal =
          flat_normal(primitive.positions[corner[0]], primitive.positions[corner[1]], primitive.positions[corner[2]]);
      for (std::size_t k = 3 * t; k < 3 * t + 3; ++k) {
        write_vertex(primitive, indices[k], normal, layout, first + k, out);
        out.triangles[first_corner + k] = static_cast<std::uint32_t>(first + k);
      }
    });
    return;
  }
  parallel_for_each_index(primitive.positions.size(), kLoopGrain, [&](std::size_t v) {
    const Vec3f normal = layout.has_normal ? primitive.normals[v] : Vec3f(0.0F);
    write_vertex(primitive, static_cast<std::uint32_t>(v), normal, layout, first + v, out);
  });
  parallel_for_each_index(indices.size(), kLoopGrain, [&](std::size_t i) {
    out.triangles[first_corner + i] = static_cast<std::uint32_t>(first) + indices[i];
  });
}

}  // namespace

Corners gather_corners(const scene::SourceMesh& mesh, const AttributeLayout& layout) {
  std::vector<std::size_t> first{0}, first_corner{0};  // of each primitive
  for (const scene::Primitive& primitive : mesh.primitives) {
    const std::size_t corners = primitive.indices.size() / 3 * 3;
    first.push_back(first.back() + (has_flat_corners(primitive, layout) ? corners : primitive.positions.size()));
    first_corner.push_back(first_corner.back() + corners);
  }
  Corners out;
  out.positions.resize(first.back());
  out.attributes.resize(first.back() * layout.stride());
  out.triangles.resize(first_corner.back());
  out.materials.reserve(first_corner.back() / 3);
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const scene::Primitive& primitive = mesh.primitives[p];
    write_primitive(primitive, layout, first[p], first_corner[p], out);
    out.materials.insert(out.materials.end(), primitive.indices.size() / 3, primitive.material.value);
  }
  return out;
}

}  // namespace meshlode::builder
