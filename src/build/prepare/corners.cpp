// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/prepare/corners.h"

#include <cmath>

namespace meshlode::build {

namespace {

float canonical_zero(float value) {
  return value == 0.0F ? 0.0F : value;
}

Vec3f flat_normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d cross = glm::cross(b - a, c - a);
  const double length = std::sqrt(glm::dot(cross, cross));
  return length > 0.0 && std::isfinite(length) ? Vec3f(cross / length) : Vec3f(0.0F, 0.0F, 1.0F);
}

void append_vertex(const scene::Primitive& primitive, std::uint32_t vertex, const Vec3f& normal,
                   const AttributeLayout& layout, Corners& out) {
  out.positions.push_back(primitive.positions[vertex] + 0.0);  // + 0.0 turns -0 into 0
  if (layout.has_normal) {
    for (int k = 0; k < 3; ++k) out.attributes.push_back(canonical_zero(normal[k]));
  }
  for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
    const std::vector<Vec2f>& uvs = primitive.uvs[layout.uv_set_source[set]];
    const Vec2f uv = uvs.empty() ? Vec2f(0.0F) : uvs[vertex];
    out.attributes.push_back(canonical_zero(uv.x));
    out.attributes.push_back(canonical_zero(uv.y));
  }
  if (layout.has_color) {
    const Vec4f color = primitive.colors.empty() ? Vec4f(1.0F) : primitive.colors[vertex];
    for (int k = 0; k < 4; ++k) out.attributes.push_back(canonical_zero(color[k]));
  }
}

}  // namespace

Corners gather_corners(const scene::SourceMesh& mesh, const AttributeLayout& layout) {
  Corners out;
  for (const scene::Primitive& primitive : mesh.primitives) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    const std::size_t triangle_count = primitive.indices.size() / 3;
    if (layout.has_normal && primitive.normals.empty()) {
      // Flat normals, as glTF asks for: every corner becomes a vertex of its own.
      for (std::size_t t = 0; t < triangle_count; ++t) {
        const std::uint32_t* corner = &primitive.indices[3 * t];
        const Vec3f normal =
            flat_normal(primitive.positions[corner[0]], primitive.positions[corner[1]], primitive.positions[corner[2]]);
        for (std::size_t k = 0; k < 3; ++k) {
          append_vertex(primitive, corner[k], normal, layout, out);
          out.triangles.push_back(first + static_cast<std::uint32_t>(3 * t + k));
        }
      }
    } else {
      for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
        const Vec3f normal = layout.has_normal ? primitive.normals[v] : Vec3f(0.0F);
        append_vertex(primitive, static_cast<std::uint32_t>(v), normal, layout, out);
      }
      for (const std::uint32_t index : primitive.indices) out.triangles.push_back(first + index);
    }
    out.materials.insert(out.materials.end(), triangle_count, primitive.material.value);
  }
  return out;
}

}  // namespace meshlode::build
