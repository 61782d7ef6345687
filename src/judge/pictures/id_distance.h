// SPDX-License-Identifier: GPL-3.0-or-later
// A Hausdorff distance of ids on screen: how far each pixel of either picture is from the nearest pixel of the other
// that shows the same surface.
#pragma once

#include <cstdint>
#include <vector>

#include "draw/raster/projection.h"
#include "judge/pictures/id_picture.h"

namespace meshlode::judge {

struct IdDistance {
  std::uint64_t pixels = 0;  ///< that show a surface in either picture
  std::uint64_t astray = 0;  ///< of these, whose surface the other picture has not within what is allowed
  double farthest_px = 0.0;  ///< of these, to that surface; infinite where the other picture has it nowhere

  [[nodiscard]] double share() const {
    return pixels > 0 ? static_cast<double>(astray) / static_cast<double>(pixels) : 0.0;
  }
};

/// What a surface may have moved by on screen, of pictures from one camera.
class AllowedPixels {
 public:
  /// Of cuts of `pixel_error`.
  AllowedPixels(const draw::Projection& projection, double pixel_error)
      : projection_(projection), pixel_error_(pixel_error) {}
  /// Infinite where it may have moved through the near plane, which opens what it cuts.
  [[nodiscard]] double at(const IdPicture& picture, std::size_t pixel) const;

 private:
  const draw::Projection& projection_;
  double pixel_error_;
};

/// The background is no surface: what vanishes before it, or comes, has an id of its own to be found by. Not judged are
/// pixels as near to the picture's edge as they may have moved, as their surface may lie beyond, and those behind
/// backs. \pre pictures of one size
[[nodiscard]] IdDistance measure_ids(const IdPicture& source, const IdPicture& cut, const AllowedPixels& allowed);

}  // namespace meshlode::judge
