// SPDX-License-Identifier: GPL-3.0-or-later
// A Hausdorff distance of ids on screen: how far each pixel of either picture is from the nearest pixel of the other
// that shows the same surface.
#pragma once

#include <cstdint>
#include <vector>

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

/// The background is no surface: what vanishes before it, or comes, has an id of its own to be found by. A pixel that
/// is as near to the picture's edge as it may have moved is not astray: its surface may lie beyond. \pre pictures of
/// one size
[[nodiscard]] IdDistance measure_ids(const IdPicture& source, const IdPicture& cut);

}  // namespace meshlode::judge
