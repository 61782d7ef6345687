// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces in the product space of positions, texture coordinates and normals (docs/reference/selection.md, "What is
// promised"): the source as it is painted, and clusters as they will be decoded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "builder/encode/quantize_normal.h"
#include "builder/encode/uv_grid.h"
#include "builder/lod_dag.h"
#include "builder/prepare/flat_normal.h"
#include "builder/promise/painted_source.h"
#include "builder/promise/product_tree.h"
#include "format/grid.h"

namespace meshlode::builder {

/// Which entries the points have, and in what units.
struct ProductSpace {
  AttributeLayout layout;
  double normal = 0.0;
  std::array<std::array<double, 2>, scene::kMaxUvSets> uv{};
  /// Normals are those of triangles: each has points of its own.
  [[nodiscard]] bool is_flat() const { return layout.flat_normal && normal > 0.0; }
  [[nodiscard]] std::size_t dimensions() const {
    std::size_t count = 3 + (normal > 0.0 ? 3 : 0);
    for (const auto& set : uv) count += set[0] > 0.0 ? 2 : 0;
    return count;
  }
};

[[nodiscard]] inline ProductSpace product_space_of(const PaintedSource& source, bool has_normals) {
  ProductSpace space;
  space.layout = source.layout;
  if (has_normals) space.normal = double{source.units.normal_object};
  for (std::uint32_t set = 0; set < scene::kMaxUvSets; ++set) {
    for (int axis = 0; axis < 2; ++axis) space.uv[set][axis] = double{source.units.uv_object[set][axis]};
  }
  return space;
}

[[nodiscard]] inline Vec3d unit_normal(const float* n) {
  const Vec3d v(n[0], n[1], n[2]);
  const double length = std::sqrt(glm::dot(v, v));
  // As it is stored where there is none: nearest_octahedral_point().
  return length > 0.0 && std::isfinite(length) ? v / length : Vec3d(0.0, 0.0, 1.0);
}

/// Makes surfaces of points with D coordinates. \pre D >= space.dimensions(). What it is given must outlive it.
template <std::size_t D>
class ProductSurfaces {
 public:
  using Point = ProductPoint<D>;
  using Surface = ProductSurface<D>;

  ProductSurfaces(const ProductSpace& space, const LodDag& dag, const format::MeshRecord& record)
      : space_(space), dag_(dag), record_(record) {}

  [[nodiscard]] Surface of_source(const PaintedSource& source) const {
    const AttributeLayout& layout = source.layout;
    const std::size_t stride = layout.stride();
    const auto point_of = [&](std::uint32_t position, std::uint32_t wedge, const Vec3d& flat) {
      const float* const a = source.attributes.data() + wedge * stride;
      std::array<Vec2d, scene::kMaxUvSets> uv;
      for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
        const float* const q = a + layout.uv_offset() + 2 * std::size_t{set};
        uv[set] = {std::isfinite(q[0]) ? q[0] : 0.0F, std::isfinite(q[1]) ? q[1] : 0.0F};
      }
      return make(source.positions[position], uv, layout.has_normal ? unit_normal(a) : flat);
    };
    Surface surface;
    surface.triangles.resize(source.triangles.size());
    if (space_.is_flat()) {
      surface.points.resize(3 * source.triangles.size());
      parallel_for_each_index(source.triangles.size(), kLoopGrain, [&](std::size_t t) {
        const Vec3d& n = source.flat_normals[t];
        for (std::uint32_t k = 0; k < 3; ++k) {
          const auto id = static_cast<std::uint32_t>(3 * t + k);
          surface.points[id] = point_of(source.triangles[t][k], source.wedges[t][k], n);
          surface.triangles[t][k] = id;
        }
      });
      return surface;
    }
    std::vector<std::uint64_t> keys;  // position and wedge of each corner: each pair is one point
    keys.reserve(3 * source.triangles.size());
    const auto key_of = [&](std::size_t t, std::size_t k) {
      return std::uint64_t{source.triangles[t][k]} << 32U | source.wedges[t][k];
    };
    for (std::size_t t = 0; t < source.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) keys.push_back(key_of(t, k));
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    surface.points.resize(keys.size());
    parallel_for_each_index(keys.size(), kLoopGrain, [&](std::size_t i) {
      surface.points[i] =
          point_of(static_cast<std::uint32_t>(keys[i] >> 32U), static_cast<std::uint32_t>(keys[i]), Vec3d(0.0));
    });
    parallel_for_each_index(source.triangles.size(), kLoopGrain, [&](std::size_t t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = std::lower_bound(keys.begin(), keys.end(), key_of(t, k));
        surface.triangles[t][k] = static_cast<std::uint32_t>(at - keys.begin());
      }
    });
    return surface;
  }

  /// Appends a cluster as it will be decoded.
  void add_cluster(const DagCluster& cluster, Surface& out) const {
    const AttributeLayout& layout = space_.layout;
    const std::size_t stride = layout.stride();
    const format::PositionGrid grid{record_.grid.log2, record_.grid.mantissa};
    std::vector<Vec3d> positions(cluster.vertex_count);
    std::vector<std::array<Vec2d, scene::kMaxUvSets>> uvs(cluster.vertex_count);
    std::vector<Vec3d> normals(cluster.vertex_count, Vec3d(0.0));
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      const std::size_t id = std::size_t{cluster.first_vertex} + v;
      const float* const a = dag_.vertex_attributes.data() + id * stride;
      positions[v] = grid.decode(dag_.vertex_position[id]);
      for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
        if (!(space_.uv[set][0] > 0.0)) continue;
        const double step = format::exp2_exact(record_.uv_log2[set]);
        const float* const q = a + layout.uv_offset() + 2 * std::size_t{set};
        uvs[v][set] = {step * quantize_uv(q[0], record_.uv_log2[set]), step * quantize_uv(q[1], record_.uv_log2[set])};
      }
      if (layout.has_normal && space_.normal > 0.0) {
        const auto n = nearest_octahedral_point({a[0], a[1], a[2]}, static_cast<std::int32_t>(record_.normal_scale));
        const Vec3d direction(n[0], n[1], n[2]);
        normals[v] = direction / std::sqrt(glm::dot(direction, direction));
      }
    }
    const auto base = static_cast<std::uint32_t>(out.points.size());
    if (!space_.is_flat()) {
      for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
        out.points.push_back(make(positions[v], uvs[v], normals[v]));
      }
    }
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
      const auto& local = dag_.triangles[cluster.first_triangle + t];
      if (!space_.is_flat()) {
        out.triangles.push_back({base + local[0], base + local[1], base + local[2]});
        continue;
      }
      const auto id = static_cast<std::uint32_t>(out.points.size());
      const Vec3d n = flat_normal(positions[local[0]], positions[local[1]], positions[local[2]]);
      for (const std::uint8_t corner : local) out.points.push_back(make(positions[corner], uvs[corner], n));
      out.triangles.push_back({id, id + 1, id + 2});
    }
  }

  /// Nothing is measured from a triangle without area where its normal would count: it has none, and draws nothing.
  [[nodiscard]] bool has_points(const Surface& surface, std::uint32_t triangle) const {
    if (!space_.is_flat()) return true;
    const Point& p = surface.points[surface.triangles[triangle][0]];
    const std::size_t d = space_.dimensions() - 3;
    return p[d] != 0.0 || p[d + 1] != 0.0 || p[d + 2] != 0.0;
  }

 private:
  [[nodiscard]] Point make(const Vec3d& p, const std::array<Vec2d, scene::kMaxUvSets>& uv, const Vec3d& n) const {
    Point out{};
    std::size_t d = 0;
    for (int axis = 0; axis < 3; ++axis) out[d++] = p[axis];
    for (std::uint32_t set = 0; set < scene::kMaxUvSets; ++set) {
      if (!(space_.uv[set][0] > 0.0)) continue;
      out[d++] = space_.uv[set][0] * uv[set].x;
      out[d++] = space_.uv[set][1] * uv[set].y;
    }
    if (space_.normal > 0.0) {
      for (int axis = 0; axis < 3; ++axis) out[d++] = space_.normal * n[axis];
    }
    return out;
  }

  ProductSpace space_;
  const LodDag& dag_;
  const format::MeshRecord& record_;
};

}  // namespace meshlode::builder
