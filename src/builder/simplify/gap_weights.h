// SPDX-License-Identifier: GPL-3.0-or-later
// What keeps layers in order: planes of triangles beside a gap weigh more as soon as a group's error comes near the
// gap. Far below it they weigh as all others do, so that fine levels stay as they are.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "builder/gap_label.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

class GapWeights {
 public:
  explicit GapWeights(const SimplifyInput& input) {
    weights_.fill(1.0);
    for (std::uint32_t code = 1; code <= kNarrowestGap && input.gap_reach > 0.0; ++code) {
      const double share = kGrowth * input.finer_error / gap_of_code(code, input.gap_reach);
      weights_[code] = std::clamp(share * share, 1.0, kMost);
    }
  }
  [[nodiscard]] double of(std::uint32_t label) const { return weights_[gap_code_of(label)]; }

 private:
  // Chosen on 21 layered scenes (lab/samples/layered.cpp, seeds 1 to 3; 640 x 480, errors of 2, 4 and 8 pixels): the
  // pixels that show another surface, and the triangles that are drawn. Without: 1.232%, 1,287. More costs triangles at
  // finer errors too, of FlightHelmet 12% at 4 pixels with 4 and 256.
  //   kGrowth    2        3        4        6        3        4        4        6
  //   kMost      64       64       64       64       256      256      1024     1024
  //   pixels     0.138%   0.084%   0.056%   0.128%   0.075%   0.048%   0.051%   0.092%
  //   triangles  1,384    1,370    1,391    1,401    1,404    1,455    1,447    1,528
  /// So much larger may a group's error be than those of the groups that it was made from, and a distance than the
  /// quadric's mean.
  static constexpr double kGrowth = 3.0;
  static constexpr double kMost = 64.0;

  std::array<double, kNarrowestGap + 1> weights_{};
};

}  // namespace meshlode::builder
