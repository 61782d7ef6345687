// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/views.h"

#include <algorithm>
#include <cmath>

namespace meshlode::builder {

namespace {

/// An angle by its cosine and sine; sums of angles without a C library's rounding (I10).
struct Angle {
  double cosine, sine;
  [[nodiscard]] Angle plus(const Angle& other) const {
    return {cosine * other.cosine - sine * other.sine, sine * other.cosine + cosine * other.sine};
  }
};

/// The first `above` are from above, evenly, the others along the ground.
template <std::size_t kCount>
std::array<View, kCount> make_views(std::size_t above) {
  constexpr Angle kGolden{-0.7373688782616119, 0.675490294061441};       // 2.39996323
  constexpr Angle kPictureStep{0.8150215158984804, 0.5794306935454344};  // 0.61803
  Angle around{0.8775825618903728, 0.479425538604203};                   // 0.5
  Angle turn{0.9323273456060345, 0.361615431964962};                     // 0.37
  std::array<View, kCount> all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double height = std::max(0.0, 1.0 - (static_cast<double>(i) + 0.5) / static_cast<double>(above));
    const double out = std::sqrt(1.0 - height * height);
    const Vec3d direction(out * around.cosine, height, out * around.sine);
    const Vec3d level(around.sine, 0.0, -around.cosine);  // at right angles to the direction, and flat
    const Vec3d other = glm::cross(direction, level);
    const Vec3d right = turn.cosine * level + turn.sine * other, up = turn.cosine * other - turn.sine * level;
    all[i] = {right, up, glm::cross(right, up)};
    around = around.plus(kGolden);
    turn = turn.plus(kPictureStep);
  }
  return all;
}

}  // namespace

const std::array<View, kViews + kSideViews>& views() {
  static const auto all = make_views<kViews + kSideViews>(kViews);
  return all;
}

const std::array<View, kManyViews>& many_views() {
  static const auto all = make_views<kManyViews>(kManyViews);
  return all;
}

const std::array<View, kMostViews>& most_views() {
  static const auto all = make_views<kMostViews>(kMostViews);
  return all;
}

const std::array<View, kSettlingViews>& settling_views() {
  static const auto all = make_views<kSettlingViews>(kSettlingViews - kSideViews);
  return all;
}

Lattice::Lattice(const Vec3d& ball_center, double ball_radius, double sample_spacing)
    : center(ball_center), spacing(sample_spacing), offset(std::ceil(4.0 * ball_radius / sample_spacing) + 16.0) {}

}  // namespace meshlode::builder
