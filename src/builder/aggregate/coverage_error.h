// SPDX-License-Identifier: GPL-3.0-or-later
// The coverage error of an aggregate's groups (docs/reference/format.md, "Aggregates"): from which pixel size on do
// fewer cards cover as much of each pixel as the pieces that they stand for?
//
// A pixel's coverage is the share of its samples that something covers. What other pieces hide does not count, before
// or after: a group is looked at in its place. The error of a group at a pixel size is the root mean square of what its
// pixels' coverage changes by, over that of the whole mesh and the group's share of it, over all views together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/noise_budget.h"
#include "builder/aggregate/pictures.h"
#include "builder/aggregate/views.h"

namespace meshlode::builder {

/// How large the error of a cut may be. A fifth is noise of some 16 samples a pixel; other directions have some percent
/// more.
constexpr double kMostCoverageError = 0.20;
/// How much more or less of all pictures may be covered; from other directions it may be as much again.
constexpr double kMostCoverageShift = 0.01;

/// One way of thinning out one group: the triangles that would replace its pieces.
struct Proposal {
  std::span<const Corners> triangles;
  double luck = 1.0;  ///< how much more the views show of it than of its pieces, of what each has
  /// Out: by view, how much more is covered, of what the whole mesh covers. Of a level with many groups every other
  /// view is 0, and the others count twice: neighbours have the others.
  std::array<double, kViews> shifts{};
  double sum_shift = 0.0;  ///< out: the same of all views together, without luck
  NoiseCurve noise;        ///< out but for `finest`: the error by pixel size, down to that, to where it is above
                           ///< kLoosestNoise or pixels are small
};

/// Groups are runs of leaves: those of a level are as long as those of the level before, or twice, and all of them
/// together all leaves.
struct GroupProposals {
  std::uint32_t first_leaf = 0, end_leaf = 0;
  double share = 0.0;  ///< of the mesh's area, as far as it is drawn
  double grain = 0.0;  ///< width of a piece or of what stands for it, whichever is finer, about
  std::vector<Proposal> proposals;
};

/// Sets what is out in proposals of all groups of all levels. `leaf_triangles`: the source's, by leaf. Pixels are tried
/// from the mesh's diameter down to `finest`. The same for any thread count (I10).
void measure_proposals(const SourceSurface& source, const MeshFrame& frame, const ByPiece& leaf_triangles,
                       double finest, std::span<std::vector<GroupProposals>> levels);

}  // namespace meshlode::builder
