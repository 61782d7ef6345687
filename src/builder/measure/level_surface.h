// SPDX-License-Identifier: GPL-3.0-or-later
// What is there once the groups of a level are replaced: all clusters that nothing has replaced yet, as one surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/release.h"
#include "base/vec.h"
#include "builder/deviation/surface_tree.h"
#include "builder/lod_dag.h"
#include "builder/measure/canonical_form.h"
#include "builder/measure/overlay.h"
#include "format/grid.h"

namespace meshlode::builder {

struct LevelSurface {
  using Triangle = std::array<std::uint32_t, 3>;

  /// `first_group`, `end_group`: the level's groups. `outputs`: per group of the DAG, the clusters made from it.
  LevelSurface(const LodDag& dag, const format::PositionGrid& grid, const CanonicalForm& form,
               std::uint32_t first_group, std::uint32_t end_group, std::span<const std::vector<std::uint32_t>> outputs);

  [[nodiscard]] TriangleCorners corners(std::uint32_t triangle) const {
    const Triangle& t = triangles[triangle];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }

  [[nodiscard]] LinkedSurface linked() const { return {positions, triangles, neighbor, normal, tree, slot}; }

  /// Frees what finds and passes to triangles: tree, slot, neighbor.
  void free_search() {
    tree = {};
    release(neighbor, slot);
  }

  std::vector<Vec3d> positions;        ///< no two in one place
  std::vector<Triangle> triangles;     ///< those of the level's groups last, group by group
  std::vector<std::uint32_t> cluster;  ///< per triangle
  std::vector<Triangle> neighbor;      ///< LinkedSurface::neighbor
  std::vector<Vec3f> normal;           ///< per triangle, of unit length or 0
  std::vector<std::uint32_t> start;    ///< per group of the level and one more: where its triangles begin
  SurfaceTree tree;
  std::vector<TreeSlot> slot;  ///< per triangle

 private:
  void add(const LodDag& dag, const format::PositionGrid& grid, const CanonicalForm& form,
           std::span<const std::uint32_t> clusters, std::size_t triangle_count);
};

}  // namespace meshlode::builder
