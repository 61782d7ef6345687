// SPDX-License-Identifier: GPL-3.0-or-later
// How much noise single groups of an aggregate may have, so that whole cuts have no more than they may.
//
// A cut at a pixel size has groups that have just come to be good enough for it and others that have long been: what is
// seen is the mean of their squares. So where many groups are out of step each may have more than the whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::build {

/// The noise of one way of thinning out (coverage_error.h) over pixel sizes.
struct NoiseCurve {
  struct Point {
    double pixel_size, noise;
  };
  std::vector<Point> points;  ///< from large pixels to small ones, as far as anybody looked

  /// The smallest pixel from which on there is no more noise than that; +inf where there is none. In between points it
  /// is taken to grow evenly: it grows slower at first, so that this is on the safe side.
  [[nodiscard]] double size_for(double limit) const;
  /// At a pixel size; of larger or smaller pixels than were looked at that of the nearest.
  [[nodiscard]] double at(double pixel_size) const;
};

/// A group as a cut sees it. Those of a level cover all leaves, in order.
struct NoisyGroup {
  std::uint32_t first_leaf = 0, end_leaf = 0;
  double share = 0.0;  ///< of the whole mesh's squared coverage, about
  std::vector<const NoiseCurve*> ways;
};

/// No group has more, alone or not.
constexpr double kLoosestNoise = 0.30;

/// By level, finest first: what each of its groups may have, from `strict` to kLoosestNoise, so that no uniform cut is
/// thought to have more than `most` if groups are independent of each other. Where they are too few for that it is
/// `strict`. \pre levels as ThinMesh's
[[nodiscard]] std::vector<double> choose_noise_limits(std::span<const std::vector<NoisyGroup>> levels, double strict,
                                                      double most);

}  // namespace meshlode::build
