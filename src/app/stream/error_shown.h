// SPDX-License-Identifier: GPL-3.0-or-later
// Which error a cut shows, in pixels: of each drawn cluster that of the group it was made from, at the nearest point of
// its culling sphere. Shares weigh a cluster by the disc that its sphere covers: not pixels, but of their size.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "app/stream/scene.h"
#include "run/select/select.h"

namespace meshlode::app {

struct ErrorShown {
  double max_px = 0.0, p95_px = 0.0, p99_px = 0.0;           ///< by area, over all frames
  double share_over_asked = 0.0, share_over_fourfold = 0.0;  ///< of the area
};

class ErrorMeter {
 public:
  explicit ErrorMeter(double pixel_error) : pixel_error_(pixel_error) {}

  /// The largest error of the frame.
  float add_frame(const StreamScene& scene, const run::Camera& camera, std::span<const run::ClusterInstance> items);
  [[nodiscard]] ErrorShown result() const;

 private:
  /// 32 steps an octave from 2^-10 pixels on: two digits.
  static constexpr int kSteps = 32, kFirstOctave = -10, kOctaves = 40;
  [[nodiscard]] double quantile(double share) const;

  double pixel_error_;
  double max_px_ = 0.0, area_ = 0.0, over_asked_ = 0.0, over_fourfold_ = 0.0;
  std::array<double, std::size_t{kSteps} * kOctaves> area_of_bin_{};
};

/// Above what was asked for, by more than the rounding of the rule's floats.
[[nodiscard]] inline bool is_over(double px, double asked_px) {
  return px > asked_px * (1.0 + 0x1p-14);
}

}  // namespace meshlode::app
