// SPDX-License-Identifier: GPL-3.0-or-later
// Cards that stand for a whole mesh are moved and turned a little, one after another, to where pictures of them are
// most like those of the pieces: a block's middle is a good place for its card, and seldom the best one beside its
// neighbours'. That takes a third off the noise, so that half as many cards are as good.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/half_pixels.h"
#include "builder/aggregate/pictures.h"

namespace meshlode::builder {

/// What the whole source covers in settling_views(), in halves of pixels of several sizes.
class SourcePictures {
 public:
  /// Down to pixels of that size.
  SourcePictures(const SourceSurface& source, const MeshFrame& frame, const ByPiece& leaf_triangles,
                 double finest_pixel);

  struct Size {
    double pixel_size = 0.0;          ///< object units
    std::vector<SourceHalves> views;  ///< of settling_views()
  };
  /// From small pixels to large ones; there is one at least.
  [[nodiscard]] std::span<const Size> sizes() const { return sizes_; }
  [[nodiscard]] const Lattice& lattice() const { return lattice_; }

 private:
  Lattice lattice_;
  std::vector<Size> sizes_;
};

/// One way of thinning the source out.
struct WayToSettle {
  Splats splats;
  double factor = 1.0;  ///< of their areas
};

/// Of all ways the one that comes to have least noise, settled: in the smallest pixels, of `finest` at least, in which
/// one has so little that it can be, and then in larger ones until little is left. Areas stay. \pre there is a way
[[nodiscard]] std::size_t settle(const SourcePictures& source, double finest, std::span<WayToSettle> ways);

}  // namespace meshlode::builder
