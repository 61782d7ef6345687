// SPDX-License-Identifier: GPL-3.0-or-later
// From which pixel size on each group of an aggregate is drawn, so that whole cuts have no more noise than they may.
//
// A cut at a pixel size has groups that have just come to be good enough for it and others that have long been: what is
// seen is the mean of their squares. So the whole has a budget, of which at every size those groups take a part that
// spare most triangles for it.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace meshlode::builder {

/// The noise of one way of thinning out (coverage_error.h) over pixel sizes.
struct NoiseCurve {
  struct Point {
    double pixel_size, noise;
  };
  std::vector<Point> points;  ///< from large pixels to small ones, as far as anybody looked
  double finest = 0.0;        ///< in smaller pixels it is not drawn, however little it is

  /// The most that it is from this pixel size on. In between points it is taken to grow evenly: it grows slower at
  /// first, so that this is on the safe side. +inf for pixels smaller than anybody looked at, or
  /// than the finest; of larger ones that of
  /// the largest.
  [[nodiscard]] double most_from(double pixel_size) const;
};

/// A way of thinning a group out, and how many triangles it leaves.
struct NoisyWay {
  const NoiseCurve* noise = nullptr;
  std::span<const double> shifts;  ///< by view: how much more is covered, as a share of what the whole mesh covers
  double sum_shift = 0.0;          ///< the same of all views together
  std::size_t triangles = 0;
};

/// A group as a cut sees it. Those of a level cover all leaves, in order.
struct NoisyGroup {
  double share = 0.0;                ///< of the whole mesh's squared coverage, about
  std::size_t source_triangles = 0;  ///< in its leaves
  std::vector<NoisyWay> ways;
};

/// What a group is drawn as, and from which pixel size on.
struct NoiseUse {
  double pixel_size = std::numeric_limits<double>::infinity();  ///< object units; +inf: never
  std::size_t way = 0;                                          ///< of its ways
};

/// No group has more, alone or not.
constexpr double kLoosestNoise = 0.30;

struct NoiseBudget {
  double noise = 0.0;        ///< of the whole
  double sum_shift = 1.0;    ///< of all views together, more or less
  double shift = 0.0;        ///< of a view, more or less
  double shift_below = 0.0;  ///< in pixels smaller than this
};

/// By level, finest first, and group: no uniform cut has more than the budget if groups are independent of each other,
/// and none comes before what it replaces; what has no use where the same leaves have one above is left out. \pre
/// levels as ThinMesh's; all ways have shifts from as many views
[[nodiscard]] std::vector<std::vector<NoiseUse>> share_out_noise(std::span<const std::vector<NoisyGroup>> levels,
                                                                 const NoiseBudget& budget);

/// Of the same leaves a level that comes no later than one below it is drawn instead of that, always: that one is left
/// out.
void leave_out_undrawn(std::vector<std::vector<NoiseUse>>& uses);

}  // namespace meshlode::builder
