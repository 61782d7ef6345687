// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/promise/painted_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "builder/prepare/zero_area.h"

namespace meshlode::builder {

namespace {

/// A normal turned by an angle counts like a way of the angle times this share of the diagonal: what a highlight moves
/// by on a ball of that radius.
constexpr double kHighlightRadius = 1.0 / 8.0;

/// A positive, finite float that can be multiplied with.
bool is_scale(double value) {
  return value >= 0x1p-100 && value <= 0x1p100;
}

Vec2d uv_of(const scene::Primitive& primitive, std::uint32_t set, std::uint32_t vertex) {
  if (primitive.uvs[set].empty()) return Vec2d(0.0);
  const auto& uv = primitive.uvs[set][vertex];
  return {std::isfinite(uv.x) ? uv.x : 0.0F, std::isfinite(uv.y) ? uv.y : 0.0F};
}

/// U and V of one TEXCOORD_n; 0 0 where nothing samples it, or no texel is covered.
std::array<double, 2> uv_units_of(const scene::SourceMesh& mesh, std::span<const TexelExtents> extents,
                                  std::uint32_t set) {
  double width = 0.0, height = 0.0, surface = 0.0, uv = 0.0;
  for (const scene::Primitive& primitive : mesh.primitives) {
    if (primitive.material.value >= extents.size()) continue;
    const std::array<double, 2>& extent = extents[primitive.material.value][set];
    if (!(extent[0] > 0.0) || !(extent[1] > 0.0)) continue;
    width = std::max(width, extent[0]);
    height = std::max(height, extent[1]);
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      const std::uint32_t* const v = &primitive.indices[i];
      const Vec3d &a = primitive.positions[v[0]], &b = primitive.positions[v[1]], &c = primitive.positions[v[2]];
      // What draws nothing covers no texels either.
      if (are_collinear(a, b, c)) continue;
      const Vec3d n = glm::cross(b - a, c - a);
      surface += 0.5 * std::sqrt(glm::dot(n, n));
      const Vec2d corner = uv_of(primitive, set, v[0]);
      const Vec2d e = uv_of(primitive, set, v[1]) - corner, f = uv_of(primitive, set, v[2]) - corner;
      uv += 0.5 * std::abs(e.x * f.y - e.y * f.x);
    }
  }
  const double texel = std::sqrt(surface / (width * height * uv));
  if (!is_scale(texel * width) || !is_scale(texel * height)) return {0.0, 0.0};
  return {texel * width, texel * height};
}

}  // namespace

UvUnits uv_units_of(const scene::SourceMesh& mesh, const AttributeLayout& layout,
                    std::span<const TexelExtents> extents) {
  UvUnits units{};
  for (std::uint32_t set = 0; set < layout.uv_set_count; ++set)
    units[set] = uv_units_of(mesh, extents, layout.uv_set_source[set]);
  return units;
}

PaintedSource keep_painted_source(PreparedMesh& mesh, const UvUnits& uv_units, bool has_normals, bool keeps_grid) {
  PaintedSource source;
  source.layout = mesh.layout;
  source.positions = mesh.exact_positions;
  source.triangles = mesh.exact_triangles;
  source.wedges = mesh.triangles;
  source.attributes = mesh.wedge_attributes;
  source.flat_normals = std::move(mesh.exact_normals);
  if (keeps_grid) {
    for (const std::uint32_t position : mesh.wedge_position) source.on_grid.push_back(mesh.positions[position]);
  }
  const double radius = kHighlightRadius * mesh.diagonal;
  if (has_normals && (mesh.layout.has_normal || mesh.layout.flat_normal) && is_scale(radius)) {
    source.units.normal_object = static_cast<float>(radius);
  }
  for (std::size_t set = 0; set < uv_units.size(); ++set) {
    for (std::size_t axis = 0; axis < 2; ++axis)
      source.units.uv_object[set][axis] = static_cast<float>(uv_units[set][axis]);
  }
  return source;
}

PaintedUnits units_to_simplify_by(const PaintedSource& painted, double diagonal) {
  constexpr double kShadingShare = 1.0 / 16.0;  // of what appearance counts
  PaintedUnits units;
  bool has_texels = false;
  for (std::size_t set = 0; set < units.uv.size(); ++set) {
    for (std::size_t axis = 0; axis < 2; ++axis) units.uv[set][axis] = double{painted.units.uv_object[set][axis]};
    has_texels = has_texels || units.uv[set][0] > 0.0;
  }
  units.normal = double{painted.units.normal_object};
  if (has_texels && units.normal == 0.0) units.normal = kShadingShare * kHighlightRadius * diagonal;
  return units;
}

}  // namespace meshlode::builder
