// SPDX-License-Identifier: GPL-3.0-or-later
// Simplify: a group's triangles are reduced by edge collapse in order of quadric error, to a new vertex at the best
// place. What the group shares with others is locked: position and attributes stay bit for bit.
//
// A collapse maps vertices to vertices. The oriented border of a set of triangles commutes with such maps, so whatever
// is collapsed inside, a border whose vertices are locked is kept exactly (I6); degenerate triangles have no border and
// may go. Link condition and flip tests are about quality, not about cracks, and can be relaxed where nothing else
// helps.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "builder/lod_dag.h"
#include "builder/prepared.h"
#include "builder/promise/painted_units.h"
#include "format/grid.h"

namespace meshlode::builder {

struct SimplifyOptions {
  std::uint32_t target_triangles = 0;  ///< stop at or below this
  /// Weights of attribute errors against distance. A normal that is off by δ (length of the difference) counts like a
  /// distance of normal_weight · δ · √(mean triangle area).
  double normal_weight = 2.0;
  double uv_weight = 0.7;      ///< UV errors as distances on the surface (by the group's mean texel density)
  double color_weight = 0.7;   ///< as normals
  double border_weight = 8.0;  ///< of source borders and material borders, against area-weighted planes
  double seam_weight = 1.0;    ///< of texture seams
  PaintedUnits painted;        ///< collapses are also weighed by the largest distance in what these count
  /// Foliage and soups: grow the pieces that stay by as much as the ones that went covered, so that the whole neither
  /// thins out nor fades (Cook, Halstead, Planck and Ryu 2007). Only pieces without a locked vertex can grow.
  bool keep_area = false;
  bool may_relax_topology = true;  ///< break the link condition (small holes, handles, fans) where that is far cheaper
  /// Every cut of a manifold is one, and of its topology: the link condition is never broken, nor what it needs beyond
  /// the group (kept_topology.h). Not with keep_area, which moves vertices later.
  bool keep_topology = false;
  bool may_relax_flips = false;  ///< where the target is out of reach, go on without the flip test: a last resort
};

/// Source points that a vertex has come to stand for: those farthest from the surface around it. They are carried up
/// the DAG, so that a collapse is judged by what it leaves behind of the source and not only of the level before.
struct Witnesses {
  static constexpr std::size_t kCapacity = 3;
  std::array<Vec3i, kCapacity> points;  ///< grid units
  std::uint32_t count = 0;
  std::array<std::uint32_t, kCapacity> ids{};  ///< what the caller calls each of them: comes back with it
};

/// A group with local ids. Wedges are per position; see PreparedMesh.
struct SimplifyInput {
  format::PositionGrid grid;
  AttributeLayout layout;
  std::vector<Vec3i> positions;
  std::vector<std::uint8_t> is_locked;  ///< per position: shared with another group
  /// Per position: on an open border that every cut keeps, wherever groups are drawn. Empty: none.
  std::vector<std::uint8_t> is_border_locked;
  std::vector<Witnesses> witnesses;  ///< per position
  std::vector<std::uint32_t> wedge_position;
  std::vector<std::uint8_t> is_wedge_shared;  ///< per wedge: another group has it too, so shading is smooth across
  std::vector<float> wedge_attributes;
  std::vector<WedgeTriangle> triangles;
  std::vector<std::uint32_t> triangle_material;  ///< and gaps (gap_label.h)
  double gap_reach = 0.0;                        ///< of the gaps, object units
  /// Where keep_topology is asked: whether another group has, or ever had, a vertex there. None: nowhere.
  std::function<bool(const Vec3i& place)> is_place_taken;

  /// Whether the position stays where it is.
  [[nodiscard]] bool stays(std::uint32_t position) const {
    return is_locked[position] != 0 || (!is_border_locked.empty() && is_border_locked[position] != 0);
  }
};

struct SimplifyResult {
  std::vector<Vec3i> positions;      ///< distinct ids, but two may have the same coordinates
  std::vector<Witnesses> witnesses;  ///< per position
  std::vector<std::uint32_t> wedge_position;
  std::vector<float> wedge_attributes;
  std::vector<WedgeTriangle> triangles;
  std::vector<std::uint32_t> triangle_material;
  double quadric_error = 0.0;  ///< object units: root of the largest mean squared distance of a collapse
  StuckReason reason = StuckReason::kNotStuck;  ///< what stopped it short of the target: the commonest obstacle
  /// So many collapses the last pass refused for their size alone: at a hub (Ring::kMost), of an edge with too many
  /// triangles (CollapseStar::kMostOnEdge), or with too many vertices going at once (LeftBehind::kMostVertices).
  std::uint64_t crowded = 0;
};

/// The result has the input's border (I6, docs/reference/rules.md): edge by edge where both ends are locked, simplified
/// where the surface is open. No triangle of it has two corners in one place. It has every position of a locked border
/// that a triangle of the input has; no triangle at all where that cannot be had.
[[nodiscard]] SimplifyResult simplify_group(const SimplifyInput& input, const SimplifyOptions& options);

/// What may stand in its place, under the same contract.
using SimplifyGroup = std::function<SimplifyResult(const SimplifyInput&, const SimplifyOptions&)>;

}  // namespace meshlode::builder
