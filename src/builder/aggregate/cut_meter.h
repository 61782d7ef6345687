// SPDX-License-Identifier: GPL-3.0-or-later
// Whole cuts of an aggregate against its source: what groups measured one by one (coverage_error.h) do not know of each
// other is in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/pictures.h"
#include "builder/aggregate/views.h"

namespace meshlode::builder {

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
  double samples = 0.0;    ///< of the source that were seen, in all views together
};

/// Of the usual views and fewer the source is drawn once and held; of more for each cut, for it is small.
class CutMeter {
 public:
  /// From `views`, which as all else must outlive this, at `count` pixel sizes, each twice as large as the one before.
  /// Samples are as wide as `grain` at most, but never finer than measure_proposals() has them for pixels of `finest`.
  CutMeter(const SourceSurface& source, const MeshFrame& frame, const ByPiece& leaf_triangles,
           std::span<const View> views, double smallest, std::size_t count, double grain, double finest);
  [[nodiscard]] CutChange measure(const ThinnedCut& cut, std::size_t size) const;

 private:
  struct Size {
    unsigned halvings = 0;  ///< of the samples' blocks
    std::size_t lattice = 0;
  };
  /// What leaves of the source cover.
  [[nodiscard]] SampleMask draw(std::size_t view, std::size_t lattice, std::span<const std::uint32_t> leaves) const;

  const SourceSurface& source_;
  const ByPiece& leaf_triangles_;
  std::span<const View> views_;
  std::vector<Size> sizes_;
  std::vector<Lattice> lattices_;  ///< each half as fine as the one before
  std::vector<LeafMasks> leaves_;  ///< by view, from the finest lattice on; none where they are drawn anew
};

}  // namespace meshlode::builder
