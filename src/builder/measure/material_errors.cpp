// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/material_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "base/box.h"
#include "base/ids.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "builder/deviation/attribute_deviation.h"
#include "builder/deviation/surface_tree.h"
#include "builder/measure/cluster_surface.h"
#include "builder/measure/groups_by_level.h"

namespace meshlode::builder {

namespace {

/// Of a group's extent: what floats, by which the nearest triangle is chosen, make of nothing.
constexpr double kNoiseOfFloats = 1e-6;

[[nodiscard]] std::span<const std::uint32_t> materials_of(const LodDag& dag, const DagCluster& cluster) {
  return std::span(dag.triangle_material).subspan(cluster.first_triangle, cluster.triangle_count);
}

/// Clusters with their materials.
struct PaintedSurface {
  ClusterSurface surface;
  std::vector<std::uint32_t> material;  ///< per triangle

  void add(const LodDag& dag, const format::PositionGrid& grid, const DagCluster& cluster) {
    surface.add(dag, grid, cluster);
    const std::span<const std::uint32_t> materials = materials_of(dag, cluster);
    material.insert(material.end(), materials.begin(), materials.end());
  }
  [[nodiscard]] TriangleCorners corners(std::size_t triangle) const {
    const auto& [a, b, c] = surface.triangles[triangle];
    return {surface.positions[a], surface.positions[b], surface.positions[c]};
  }
  [[nodiscard]] double extent() const {
    Box3d box;
    for (const Vec3d& position : surface.positions) box.add(position);
    return surface.positions.empty() ? 0.0 : glm::length(box.size());
  }
};

/// Distances from a surface, material by material.
class MaterialDistance {
 public:
  explicit MaterialDistance(const PaintedSurface& painted) {
    for (std::size_t t = 0; t < painted.material.size(); ++t) {
      parts_[painted.material[t]].triangles.push_back(painted.surface.triangles[t]);
    }
    for (auto& [material, part] : parts_) part.tree.build({painted.surface.positions, part.triangles});
  }

  /// Infinite where nothing has the material.
  [[nodiscard]] double at(const Vec3d& x, std::uint32_t material) {
    const auto found = parts_.find(material);
    if (found == parts_.end()) return std::numeric_limits<double>::infinity();
    Part& part = found->second;
    const Vec3f place = part.tree.to_frame(x);
    SurfaceTree::Hit hit;
    if (part.near.is_valid()) hit = part.tree.look_around(place, part.near, hit);
    hit = part.tree.find_nearest(place, hit, 0.0F);
    if (!hit.slot.is_valid()) return std::numeric_limits<double>::infinity();
    part.near = hit.slot;
    return std::sqrt(part.tree.distance2_at(x, hit.slot));
  }

 private:
  struct Part {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    SurfaceTree tree;
    TreeSlot near;  ///< what the point before was near to
  };
  std::map<std::uint32_t, Part> parts_;
};

/// The largest distance x beyond which an area of x² is lost.
[[nodiscard]] double lost_width(const PaintedSurface& before, const PaintedSurface& after) {
  struct Lost {
    double distance, area;
  };
  std::vector<Lost> lost;
  MaterialDistance distance(after);
  const double extent = before.extent();
  // Of a vertex, for the material that it was asked for last: seldom another one's.
  std::vector<std::pair<std::uint32_t, double>> known(before.surface.positions.size(), {kNoId, 0.0});
  for (std::size_t t = 0; t < before.material.size(); ++t) {
    const std::uint32_t material = before.material[t];
    const TriangleCorners corners = before.corners(t);
    double most = distance.at((corners[0] + corners[1] + corners[2]) / 3.0, material);
    for (std::size_t k = 0; k < 3; ++k) {
      auto& [of, there] = known[before.surface.triangles[t][k]];
      if (of != material) there = distance.at(corners[k], material);
      of = material;
      most = std::max(most, there);
    }
    if (most > kNoiseOfFloats * extent) lost.push_back({std::min(most, extent), 0.5 * area_of(corners)});
  }
  std::sort(lost.begin(), lost.end(), [](const Lost& a, const Lost& b) {
    return a.distance != b.distance ? a.distance > b.distance : a.area > b.area;
  });
  double width = 0.0, area = 0.0;
  for (const Lost& triangle : lost) {
    area += triangle.area;
    width = std::max(width, std::min(triangle.distance, std::sqrt(area)));
  }
  return width;
}

/// Of one group alone.
[[nodiscard]] double moved_by(const PreparedMesh& mesh, const LodDag& dag, const DagGroup& group,
                              std::span<const std::uint32_t> made) {
  const std::span members = std::span(dag.clusters).subspan(group.first_cluster, group.cluster_count);
  std::uint32_t least = kNoId, most = 0;
  for (const DagCluster& cluster : members) {
    for (const std::uint32_t material : materials_of(dag, cluster)) {
      least = std::min(least, material);
      most = std::max(most, material);
    }
  }
  if (least >= most) return 0.0;  // one material
  PaintedSurface before, after;
  for (const DagCluster& cluster : members) before.add(dag, mesh.grid, cluster);
  for (const std::uint32_t c : made) after.add(dag, mesh.grid, dag.clusters[c]);
  return lost_width(before, after);
}

}  // namespace

std::vector<double> material_errors(const PreparedMesh& mesh, const LodDag& dag) {
  const std::vector<std::uint32_t>& materials = dag.triangle_material;
  if (std::adjacent_find(materials.begin(), materials.end(), std::not_equal_to<>()) == materials.end()) return {};
  const std::vector<std::vector<std::uint32_t>> made_of = clusters_made_of_groups(dag);
  std::vector<double> errors(dag.groups.size(), 0.0);
  parallel_for_each_index(dag.groups.size(), 1, [&](std::size_t g) {
    if (!dag.groups[g].is_terminal) errors[g] = moved_by(mesh, dag, dag.groups[g], made_of[g]);
  });
  for (std::size_t g = dag.groups.size(); g-- > 0;) {  // from fine to coarse
    const DagGroup& group = dag.groups[g];
    double below = 0.0;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const GroupId own = dag.clusters[c].own_group;
      if (own.is_valid()) below = std::max(below, errors[own.value]);
    }
    const double moved = std::sqrt(errors[g] * errors[g] + below * below);  // hypot() depends on the C library
    errors[g] = std::min(moved, mesh.diagonal);
  }
  return errors;
}

}  // namespace meshlode::builder
