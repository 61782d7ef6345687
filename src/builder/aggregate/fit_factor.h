// SPDX-License-Identifier: GPL-3.0-or-later
// Cards that stand for an aggregate's pieces get one factor for their areas, so that they cover as much as the pieces
// do over all views.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/covered_samples.h"
#include "builder/aggregate/pictures.h"
#include "builder/aggregate/views.h"
#include "format/grid.h"

namespace meshlode::builder {

/// How samples are looked at to find factors.
struct Sampling {
  std::span<const View> views;
  std::size_t counted = 0;  ///< of the views, the first ones: those over which as much is to be covered
  double spacing = 0.0;     ///< of the source's; cards that are larger need fewer samples
  double samples_each = 0.0;

  [[nodiscard]] std::span<const View> counted_views() const { return views.first(counted); }
  [[nodiscard]] double sum(const Covered& covered) const {
    double all = 0.0;
    for (std::size_t v = 0; v < counted; ++v) all += static_cast<double>(covered[v]);
    return all;
  }
  /// For so many cards of an area together: so many samples each, and as many as a mean over all of them asks for.
  [[nodiscard]] double spacing_of(double area, std::size_t cards) const {
    constexpr double kFewestSamples = 8192.0;
    const double samples = std::max(kFewestSamples, samples_each * static_cast<double>(cards));
    return std::max(spacing, std::sqrt(area / samples));
  }
};

/// What views show of cards that do not hide each other, and how much that is over all directions.
class ShownArea {
 public:
  void add(std::span<const View> views, const Vec3d& normal, double area) {
    area_ += area;
    views_ = views.size();
    for (const View& view : views) shown_ += area * std::fabs(glm::dot(normal, view.toward));
  }
  /// \pre in the same views
  void add(const ShownArea& other) {
    area_ += other.area_;
    shown_ += other.shown_;
    views_ = std::max(views_, other.views_);
  }
  /// How much more the views show than as many directions do in the mean, which is half of the area: of a large plate
  /// or a handful of cards that is luck, some percent of it.
  [[nodiscard]] double luck() const {
    const double mean = 0.5 * area_ * static_cast<double>(views_);
    return mean > 0.0 && shown_ > 0.0 ? shown_ / mean : 1.0;
  }

 private:
  double area_ = 0.0, shown_ = 0.0;
  std::size_t views_ = 0;
};

[[nodiscard]] ShownArea shown_by(std::span<const View> views, const Splats& splats);

/// A way of thinning out that covers as much, or none.
struct Fitted {
  Splats splats;    ///< until they are forgotten, but for their attributes
  ShownArea shown;  ///< of the splats, as the usual views show it
  std::vector<Corners> triangles;
  std::vector<std::uint32_t> material;  ///< of the source, per triangle; once the splats are forgotten
  double luck = 1.0;        ///< how much more the usual views show of it than of its pieces, of what each has
  double factor = 1.0;      ///< of the splats' areas
  double worst_view = 0.0;  ///< what a single view's sum changes by at most
  double finest = 0.0;      ///< as NoiseCurve::finest
  bool is_there = false;
  bool is_fair = false;  ///< is there, and changes single views no more than other ways do

  /// Large meshes have many. Of a way that is not fair everything goes.
  void forget_splats();
};

/// What splats are to cover over all views, of which area, and the luck of the cards that cover it.
struct Target {
  const Covered& covered;
  const Sampling& sampling;  ///< that it is of
  double area = 0.0, luck = 1.0;
};

/// What a single view's sum changes by at most, as a share of it. `weight`: samples of `before` for one of `now`.
[[nodiscard]] double worst_view(const Covered& before, const Covered& now, double weight);

/// Finds the factor for which the splats cover as much as that. `start`: where to begin.
void fit_factor(const MeshFrame& frame, const format::PositionGrid& grid, const Target& target, double start,
                Fitted& way);

/// Seen along a field of grass, cards rise out of it: ways that do are left out where there are others.
void leave_out_unfair(std::span<Fitted> ways);

/// Only fair ways are proposed: which of all ways is the one proposed at that place.
[[nodiscard]] std::size_t way_of(std::span<const Fitted> ways, std::size_t proposal);

}  // namespace meshlode::builder
