// SPDX-License-Identifier: GPL-3.0-or-later
// The directions that coverage is measured from, and a picture's lattice of samples in each.
#pragma once

#include <array>
#include <cstddef>

#include "base/vec.h"
#include "builder/aggregate/card.h"

namespace meshlode::builder {

/// From all around above, evenly (a hemisphere's Fibonacci lattice). What is covered is the same from below.
constexpr std::size_t kViews = 13;
/// Behind them some from the side, along the ground: a field of grass is nearly nothing from there, and cards that rise
/// out of it are seen most. Errors are not measured from them.
constexpr std::size_t kSideViews = 2;

struct View {
  Vec3d right, up;  ///< of the picture, unit; each picture is turned by another angle
  Vec3d toward;     ///< right × up: to whoever looks
};
[[nodiscard]] const std::array<View, kViews + kSideViews>& views();
/// Many more from all around above. A handful of cards shows itself to thirteen directions by luck.
constexpr std::size_t kManyViews = 48;
[[nodiscard]] const std::array<View, kManyViews>& many_views();
/// More still: the noise of a handful of cards hangs on the direction more than what they cover does.
constexpr std::size_t kMostViews = 144;
[[nodiscard]] const std::array<View, kMostViews>& most_views();
/// Others, for cards that are moved to where these show least noise: it is measured from the ones above, which know
/// nothing of that. The last ones are from the side.
constexpr std::size_t kSettlingViews = 16 + kSideViews;
[[nodiscard]] const std::array<View, kSettlingViews>& settling_views();

/// Samples of a picture: a point's place in whole samples, the first ones at least some samples from the border.
struct Lattice {
  Vec3d center{0.0};
  double spacing = 1.0;
  double offset = 0.0;

  /// Of a mesh inside a ball.
  Lattice(const Vec3d& ball_center, double ball_radius, double sample_spacing);
  /// Twice as fine: its even samples are this one's.
  [[nodiscard]] Lattice finer() const {
    Lattice twice = *this;
    twice.spacing = 0.5 * spacing;
    twice.offset = 2.0 * offset;
    return twice;
  }
  /// All samples have coordinates from 0 to below this, and so have those of what sticks out, up to four times as far
  /// from the middle as the ball: a dozen cards for a whole mesh are that large.
  [[nodiscard]] int side() const { return static_cast<int>(2.0 * offset) + 2; }
  [[nodiscard]] Vec2d place(const View& view, const Vec3d& point) const {
    const Vec3d p = (point - center) / spacing;
    return {glm::dot(p, view.right) + offset, glm::dot(p, view.up) + offset};
  }
  [[nodiscard]] std::array<Vec2d, 3> places(const View& view, const Corners& corners) const {
    return {place(view, corners[0]), place(view, corners[1]), place(view, corners[2])};
  }
};

}  // namespace meshlode::builder
