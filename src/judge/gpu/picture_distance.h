// SPDX-License-Identifier: GPL-3.0-or-later
// Hardware raster is held within a stated distance of the CPU's picture (V409). docs/explanation/gpu-verifier.md says
// where its numbers come from.
#pragma once

#include <cstdint>
#include <string>

#include "draw/raster/raster.h"

namespace meshlode::judge {

/// How far a picture is from the CPU's of the same cut and camera.
struct PictureDistance {
  std::uint64_t covered = 0;    ///< pixels of the CPU's picture that show something
  std::uint64_t differing = 0;  ///< pixels covered in one picture alone, or with depths too far apart
  std::uint64_t astray = 0;     ///< of these: like nothing in the CPU's picture there or in the eight pixels around
  std::uint64_t may_differ = 0, may_be_astray = 0;  ///< how many pixels of a frame this size, by the rule
  std::string first;                                ///< the first astray pixel in words, else the first that differs

  [[nodiscard]] bool is_within_bounds() const { return differing <= may_differ && astray <= may_be_astray; }
};

/// \pre pictures of one size
[[nodiscard]] PictureDistance measure_distance(const draw::VisibilityBuffer& cpu, const draw::VisibilityBuffer& drawn,
                                               bool is_orthographic);

/// "12 pixels differ (250 may), 9 by more than a pixel (31 may); pixel 215,126: …"
[[nodiscard]] std::string describe(const PictureDistance& distance);

}  // namespace meshlode::judge
