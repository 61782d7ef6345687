// SPDX-License-Identifier: GPL-3.0-or-later
// Aggregate: a mesh of many small loose pieces (leaves, blades of grass, crumbs) thinned out level by level, so that
// each level covers as much of a picture as the one before from some pixel size on.
//
// A collapse of edges cannot do that: a leaf that goes is a leaf's size away, however small it is on the screen, and
// what stays of the area says little of what is covered. Here pieces are cards, blocks of neighbours become one card,
// and what a group's error says is measured in pictures (coverage_error.h). Pieces share no border, so groups are the
// nodes of one tree: nothing is locked.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/pieces.h"
#include "builder/prepared.h"

namespace meshlode::builder {

struct ThinOptions {
  std::uint32_t leaf_triangles = 2560;  ///< of the source in a finest group, at most but for single pieces
};

/// Groups that come late keep less than half of their cards and early ones more: what a group replaces has at most so
/// many times leaf_triangles.
inline constexpr double kMostOfLeaf = 1.3;

/// What stands for the pieces of a run of leaves from some level on.
struct ThinGroup {
  std::uint32_t first_leaf = 0, end_leaf = 0;
  double pixel_size = 0.0;  ///< object units: from there on it covers what its pieces do; +inf: it does not
  std::vector<Corners> triangles;
  std::vector<float> attributes;        ///< AttributeLayout::stride() floats per triangle
  std::vector<std::uint32_t> material;  ///< SourceMaterial::coarse, per triangle
};

/// Groups of a level cover all leaves, in order. Those of the first level are single leaves, and those of a later one
/// hold one or two of the level before whole.
struct ThinMesh {
  ByPiece leaf_triangles;  ///< the source's triangles by leaf; pieces whole, neighbours near
  std::vector<std::vector<ThinGroup>> levels;
};

/// The same for any thread count (I10). `materials`: by id. \pre the mesh has a triangle
[[nodiscard]] ThinMesh thin_mesh(const PreparedMesh& mesh, std::span<const SourceMaterial> materials,
                                 const ThinOptions& options = {});

}  // namespace meshlode::builder
