// SPDX-License-Identifier: GPL-3.0-or-later
// The coverage error of an aggregate's groups (docs/format.md, "Aggregates"): from which pixel size on do fewer cards
// cover as much of each pixel as the pieces that they stand for?
//
// A pixel's coverage is the share of its samples that something covers. What other pieces hide does not count, before
// or after: a group is looked at in its place. The error of a group at a pixel size is the root mean square of what its
// pixels' coverage changes by, over that of the whole mesh and the group's share of it, over all views together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "build/aggregate/card.h"
#include "build/aggregate/noise_budget.h"
#include "build/aggregate/pieces.h"
#include "build/aggregate/sample_mask.h"
#include "build/aggregate/views.h"
#include "build/prepared.h"

namespace meshlode::build {

/// How large the error of a cut may be. A fifth is noise of some 16 samples a pixel; other directions have some percent
/// more.
constexpr double kMostCoverageError = 0.20;
/// How much more or less of all pictures may be covered; from other directions it may be as much again.
constexpr double kMostCoverageShift = 0.01;

/// What pieces cover, triangle by triangle, and where they are.
class SourceSurface {
 public:
  /// Everything must outlive this.
  SourceSurface(const PreparedMesh& mesh, std::span<const SourceMaterial> materials,
                std::span<const std::uint8_t> is_closed)
      : mesh_(mesh), materials_(materials), is_closed_(is_closed) {}
  [[nodiscard]] Corners corners(std::uint32_t triangle) const { return corners_of(mesh_, triangle); }
  [[nodiscard]] const SourceMaterial& material(std::uint32_t triangle) const {
    return materials_[mesh_.triangle_material[triangle]];
  }
  [[nodiscard]] std::array<Vec2d, 3> uvs(std::uint32_t triangle) const {
    return corner_uvs(mesh_, triangle, material(triangle));
  }
  /// Whether its piece is closed, and not masked.
  [[nodiscard]] bool is_closed(std::uint32_t triangle) const { return is_closed_[triangle] != 0; }

 private:
  const PreparedMesh& mesh_;
  std::span<const SourceMaterial> materials_;
  std::span<const std::uint8_t> is_closed_;
};

/// A ball around the mesh, and how finely it may be looked at.
struct MeshFrame {
  Vec3d center{0.0};
  double radius = 0.0;
  double longest = 0.0;  ///< side of its box
};

/// One way of thinning out one group: the triangles that would replace its pieces.
struct Proposal {
  std::vector<Corners> triangles;
  double luck = 1.0;                    ///< how much more the views show of it than of its pieces, of what each has
  std::array<double, kViews> shifts{};  ///< out: by view, how much more is covered, of what the whole mesh covers
  double sum_shift = 0.0;               ///< out: the same of all views together, without luck
  NoiseCurve noise;  ///< out: the error by pixel size, down to where it is above kLoosestNoise or pixels are small
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

/// What is drawn at a pixel size: some leaves as they are, and triangles instead of the others.
struct ThinnedCut {
  std::vector<std::uint32_t> source_leaves;  ///< what it is compared with: those that something replaces at some size
  std::vector<std::uint32_t> leaves;         ///< of these
  std::vector<Corners> triangles;
  double luck = 1.0;  ///< how much more the views show of all of it than of the source, of what each has
};
struct CutChange {
  double noise = 0.0;      ///< as Proposal::noise, of the whole
  double sum_shift = 0.0;  ///< as Proposal::sum_shift
};
/// Cuts against the source as a whole: what groups measured one by one do not know of each other is in it. The source
/// is drawn once.
class CutMeter {
 public:
  /// At `count` pixel sizes, each twice as large as the one before. Samples are as wide as `grain` at most, but for the
  /// smallest that measure_proposals() has for `finest`.
  CutMeter(const SourceSurface& source, const MeshFrame& frame, const ByPiece& leaf_triangles, double smallest,
           std::size_t count, double grain, double finest);
  [[nodiscard]] CutChange measure(const ThinnedCut& cut, std::size_t size) const;

 private:
  struct Size {
    std::size_t octaves = 1, lattice = 0;
  };
  std::vector<Size> sizes_;
  std::vector<Lattice> lattices_;                                    ///< each half as fine as the one before
  std::array<std::vector<std::vector<SampleMask>>, kViews> leaves_;  ///< [view][lattice][leaf]
};

/// Samples by view.
using Covered = std::vector<std::uint64_t>;

/// Samples that runs of so many leaves cover at a spacing in each view, each run alone: a list for each length.
/// \pre lengths are powers of two, rising, and none is above the number of leaves
[[nodiscard]] std::vector<std::vector<Covered>> covered_samples(const SourceSurface& source, const MeshFrame& frame,
                                                                const ByPiece& leaf_triangles, double spacing,
                                                                std::span<const View> views,
                                                                std::span<const std::uint32_t> run_lengths);
/// The same of other triangles together.
[[nodiscard]] Covered covered_samples(const MeshFrame& frame, std::span<const Corners> triangles, double spacing,
                                      std::span<const View> views);

}  // namespace meshlode::build
