// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/fit_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/release.h"
#include "builder/aggregate/coverage_error.h"

namespace meshlode::builder {

namespace {

constexpr double kMostInAView = 0.75;  // more or less: a level that shows a view so much else stands for nothing

/// As it will be stored: of a needle that is some steps wide much of the area.
Corners on_grid(const format::PositionGrid& grid, const Corners& corners) {
  const double most = format::kMaxGridCoordinate * grid.step();
  Corners stored;
  for (std::size_t k = 0; k < 3; ++k)
    stored[k] = grid.decode(grid.quantize(glm::clamp(corners[k], Vec3d(-most), Vec3d(most))));
  return stored;
}

}  // namespace

ShownArea shown_by(std::span<const View> views, const Splats& splats) {
  ShownArea shown;
  for (const Splat& splat : splats.splats) shown.add(views, splat.normal(), splat.area);
  return shown;
}

void Fitted::forget_splats() {
  if (is_fair) {
    material.reserve(splats.splats.size());
    for (const Splat& splat : splats.splats) material.push_back(splat.material);
  } else {
    release(splats.attributes, triangles);
  }
  release(splats.splats);
}

double worst_view(const Covered& before, const Covered& now, double weight) {
  double worst = 0.0;
  for (std::size_t v = 0; v < now.size(); ++v) {
    if (before[v] == 0) continue;
    const double share = weight * static_cast<double>(now[v]) / static_cast<double>(before[v]);
    worst = std::max(worst, std::fabs(share - 1.0));
  }
  return worst;
}

void fit_factor(const MeshFrame& frame, const format::PositionGrid& grid, const Target& target, double start,
                Fitted& way) {
  constexpr double kCloseEnough = 0.002;
  constexpr int kFactorSteps = 12;
  const Sampling& sampling = target.sampling;
  const double spacing = sampling.spacing_of(target.area, way.splats.splats.size());
  const double weight = spacing * spacing / (sampling.spacing * sampling.spacing);  // in samples of the source
  const double wanted =
      sampling.sum(target.covered) * shown_by(sampling.counted_views(), way.splats).luck() / target.luck;
  if (!(wanted > 0.0)) return;
  double factor = start;
  double low = 0.0, high = 0.0;  // what covers less, and more; 0: nothing so far
  double tried = 0.0, last_count = 0.0;
  Covered now;
  way.triangles.reserve(way.splats.splats.size());
  for (int step = 0; step < kFactorSteps; ++step) {
    way.triangles.clear();
    for (const Splat& splat : way.splats.splats) way.triangles.push_back(on_grid(grid, splat.corners(factor)));
    now = covered_samples(frame, way.triangles, spacing, sampling.views);
    const double count = weight * sampling.sum(now);
    const double before = std::exchange(tried, factor);
    if (std::fabs(count - wanted) <= kCloseEnough * wanted) break;
    (count < wanted ? low : high) = factor;
    const double slope = step > 0 ? (count - last_count) / (factor - before) : 0.0;
    // Further than in proportion, since cards come to hide each other.
    const double more = std::clamp(wanted / std::max(count, 1.0), 0.5, std::sqrt(2.0));
    double next = slope > 0.0 ? factor + (wanted - count) / slope : factor * more * more;
    if (low > 0.0 && high > 0.0) {
      const double margin = 0.1 * (high - low);
      next = std::clamp(next, low + margin, high - margin);
    } else {
      next = std::clamp(next, 0.5 * factor, 2.0 * factor);
    }
    factor = next;
    last_count = count;
  }
  way.worst_view = worst_view(target.covered, now, weight);
  way.is_there =
      std::fabs(weight * sampling.sum(now) - wanted) <= kMostCoverageShift * wanted && way.worst_view <= kMostInAView;
  way.factor = tried;
}

void leave_out_unfair(std::span<Fitted> ways) {
  constexpr double kFineView = 0.10, kNearlyAsGood = 1.1;
  double fairest = std::numeric_limits<double>::infinity();
  for (const Fitted& way : ways) {
    if (way.is_there) fairest = std::min(fairest, way.worst_view);
  }
  for (Fitted& way : ways) {
    way.is_fair = way.is_there && way.worst_view <= std::max(kFineView, kNearlyAsGood * fairest);
  }
}

std::size_t way_of(std::span<const Fitted> ways, std::size_t proposal) {
  const auto way =
      std::find_if(ways.begin(), ways.end(), [&](const Fitted& each) { return each.is_fair && proposal-- == 0; });
  return static_cast<std::size_t>(way - ways.begin());
}

}  // namespace meshlode::builder
