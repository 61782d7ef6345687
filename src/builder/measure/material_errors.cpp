// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/material_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "base/box.h"
#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "builder/deviation/attribute_deviation.h"
#include "builder/deviation/surface_tree.h"
#include "builder/measure/groups_by_level.h"
#include "builder/measure/joined_clusters.h"

namespace meshlode::builder {

namespace {

/// Of a group's extent: what floats, by which the nearest triangle is chosen, make of nothing.
constexpr double kNoiseOfFloats = 1e-6;

/// Clusters with their materials.
struct MaterialSurface {
  JoinedClusters joined;
  std::vector<std::uint32_t> material;  ///< per triangle

  MaterialSurface(const PreparedMesh& mesh, const CanonicalForm& form, const LodDag& dag,
                  std::span<const std::uint32_t> clusters)
      : joined(dag, mesh.grid, form.position_of_vertex, clusters) {
    for (const std::uint32_t c : clusters) {
      const auto first = form.triangle_material.begin() + dag.clusters[c].first_triangle;
      material.insert(material.end(), first, first + dag.clusters[c].triangle_count);
    }
  }
  [[nodiscard]] TriangleCorners corners(std::size_t triangle) const {
    const auto& [a, b, c] = joined.triangles[triangle];
    return {joined.positions[a], joined.positions[b], joined.positions[c]};
  }
  [[nodiscard]] bool is_mixed() const {
    return std::any_of(material.begin(), material.end(), [&](std::uint32_t m) { return m != material.front(); });
  }
  [[nodiscard]] double extent() const {
    Box3d box;
    for (const Vec3d& position : joined.positions) box.add(position);
    return box.is_empty() ? 0.0 : glm::length(box.size());
  }
};

/// Distances from a surface, material by material.
class MaterialDistance {
 public:
  explicit MaterialDistance(const MaterialSurface& surface) {
    for (std::size_t t = 0; t < surface.material.size(); ++t) {
      parts_[surface.material[t]].triangles.push_back(surface.joined.triangles[t]);
    }
    for (auto& [material, part] : parts_) part.tree.build({surface.joined.positions, part.triangles});
  }

  /// Infinite where nothing has the material.
  [[nodiscard]] double at(const Vec3d& x, std::uint32_t material) {
    const auto found = parts_.find(material);
    if (found == parts_.end()) return std::numeric_limits<double>::infinity();
    Part& part = found->second;
    part.near = find_near(part.tree, x, part.near, 0.0).slot;
    return distance_at(part.tree, x, part.near);
  }

 private:
  struct Part {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    SurfaceTree tree;
    TreeSlot near;  ///< what the point before was near to
  };
  std::map<std::uint32_t, Part> parts_;
};

/// A triangle, how far it is lost, and what it hangs together with.
struct Lost {
  std::uint32_t piece = 0;
  double distance = 0.0, area = 0.0;
};

std::vector<Lost> lost_triangles(const MaterialSurface& before, MaterialDistance& distance) {
  struct Use {
    std::uint32_t position, material, triangle;
  };
  std::vector<Use> uses;
  std::vector<Lost> lost(before.material.size());
  for (std::uint32_t t = 0; t < lost.size(); ++t) {
    const TriangleCorners corners = before.corners(t);
    lost[t].area = 0.5 * area_of(corners);  // which says twice the area
    lost[t].distance = distance.at((corners[0] + corners[1] + corners[2]) / 3.0, before.material[t]);
    for (const std::uint32_t position : before.joined.triangles[t]) uses.push_back({position, before.material[t], t});
  }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::tie(a.position, a.material, a.triangle) < std::tie(b.position, b.material, b.triangle);
  });
  DisjointSets pieces(lost.size());
  for (std::size_t i = 0; i < uses.size();) {
    const Use first = uses[i];
    const double there = distance.at(before.joined.positions[first.position], first.material);
    for (; i < uses.size() && uses[i].position == first.position && uses[i].material == first.material; ++i) {
      (void)pieces.join(first.triangle, uses[i].triangle);
      lost[uses[i].triangle].distance = std::max(lost[uses[i].triangle].distance, there);
    }
  }
  for (std::uint32_t t = 0; t < lost.size(); ++t) lost[t].piece = pieces.find(t);
  return lost;
}

/// Of the worst piece the largest distance x beyond which an area of x² is lost.
double lost_width(const MaterialSurface& before, const MaterialSurface& after) {
  MaterialDistance distance(after);
  std::vector<Lost> lost = lost_triangles(before, distance);
  const double extent = before.extent();
  std::erase_if(lost, [&](const Lost& l) { return l.distance <= kNoiseOfFloats * extent; });
  std::sort(lost.begin(), lost.end(), [](const Lost& a, const Lost& b) {
    return std::tie(a.piece, b.distance, b.area) < std::tie(b.piece, a.distance, a.area);  // the farthest first
  });
  double width = 0.0, area = 0.0;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    if (i > 0 && lost[i].piece != lost[i - 1].piece) area = 0.0;
    area += lost[i].area;
    width = std::max(width, std::min({lost[i].distance, std::sqrt(area), extent}));
  }
  return width;
}

}  // namespace

std::vector<double> material_errors(const PreparedMesh& mesh, const CanonicalForm& form, const LodDag& dag) {
  if (form.triangle_material.empty()) return {};
  const std::vector<std::vector<std::uint32_t>> made_of = clusters_made_of_groups(dag);
  std::vector<double> errors(dag.groups.size(), 0.0);
  parallel_for_each_index(dag.groups.size(), 1, [&](std::size_t g) {
    const DagGroup& group = dag.groups[g];
    if (group.is_terminal) return;
    std::vector<std::uint32_t> members(group.cluster_count);
    std::iota(members.begin(), members.end(), group.first_cluster);
    const MaterialSurface before(mesh, form, dag, members);
    if (before.is_mixed()) errors[g] = lost_width(before, MaterialSurface(mesh, form, dag, made_of[g]));
  });
  for (std::size_t g = dag.groups.size(); g-- > 0;) {  // from fine to coarse
    const DagGroup& group = dag.groups[g];
    double below = 0.0;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const GroupId own = dag.clusters[c].own_group;
      if (own.is_valid()) below = std::max(below, errors[own.value]);
    }
    errors[g] = std::sqrt(errors[g] * errors[g] + below * below);  // hypot() depends on the C library
  }
  return errors;
}

}  // namespace meshlode::builder
