// SPDX-License-Identifier: GPL-3.0-or-later
// A Hausdorff distance of ids on screen: how far each pixel of either picture is from the nearest pixel of the other
// that shows the same surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "draw/raster/projection.h"
#include "judge/pictures/id_picture.h"

namespace meshlode::judge {

/// What a surface may have moved by on screen, of pictures from one camera.
class AllowedPixels {
 public:
  /// Of cuts of `pixel_error`. \pre `projection` outlives this
  AllowedPixels(const draw::Projection& projection, double pixel_error)
      : projection_(projection), pixel_error_(pixel_error) {}
  /// Infinite where it may have moved through the near plane, which opens what it cuts.
  [[nodiscard]] double at(const IdPicture& picture, std::size_t pixel) const;

 private:
  const draw::Projection& projection_;
  double pixel_error_;
};

/// A pixel whose surface, in one picture, the other has not within what is allowed.
struct AstrayPixel {
  std::uint32_t pixel = 0;
  double distance_px = 0.0;                      ///< to that surface; infinite where the other picture has it nowhere
  bool is_of_source = false, is_of_cut = false;  ///< which of the two surfaces it is; both may be
};

/// The background is no surface: what vanishes before it, or comes, has an id of its own to be found by. Not judged are
/// pixels as near to the picture's edge as they may have moved, as their surface may lie beyond. Ascending. \pre
/// pictures of one size
[[nodiscard]] std::vector<AstrayPixel> find_astray(const IdPicture& source, const IdPicture& cut,
                                                   const AllowedPixels& allowed);

/// Leaves out those whose surface is at most two pixels wide there, if the other scene shows it within what is allowed
/// in a picture of `finer` times as many pixels along each side. What is narrower than a pixel meets the middles of
/// pixels by chance: a ribbon seen from its edge is dots in one picture and a line in the other. A wide surface stays
/// astray. \pre `astray` is find_astray() of `source` and `cut`, and the finer ones are of the same scenes and camera
void dismiss_narrow(const IdPicture& source, const IdPicture& cut, const IdPicture& finer_source,
                    const IdPicture& finer_cut, std::uint32_t finer, const AllowedPixels& allowed,
                    std::vector<AstrayPixel>& astray);

struct IdDistance {
  std::uint64_t pixels = 0;  ///< that show a surface in either picture
  std::uint64_t astray = 0;
  double farthest_px = 0.0;  ///< of those

  [[nodiscard]] double share() const {
    return pixels > 0 ? static_cast<double>(astray) / static_cast<double>(pixels) : 0.0;
  }
};

[[nodiscard]] IdDistance sum_up(const IdPicture& source, const IdPicture& cut, std::span<const AstrayPixel> astray);

}  // namespace meshlode::judge
