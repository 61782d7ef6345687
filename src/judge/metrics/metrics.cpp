// SPDX-License-Identifier: GPL-3.0-or-later
// Two-sided deviation in the manner of Metro (Cignoni, Rocchini and Scopigno 1998), with stratified samples.
#include "judge/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "judge/metrics/area_samples.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::judge {
namespace {

constexpr std::size_t kChunk = 1024;  // queries that share a hint and a partial sum, whatever the thread count

/// The points of a surface that are measured: its samples, then all vertices that it uses.
class MeasuredPoints {
 public:
  MeasuredPoints(const Surface& surface, const DeviationOptions& options)
      : surface_(surface), samples_(surface, options.samples, options.seed), vertices_(used_vertices(surface)) {}
  [[nodiscard]] std::size_t sample_count() const { return static_cast<std::size_t>(samples_.count()); }
  [[nodiscard]] std::size_t size() const { return sample_count() + vertices_.size(); }
  [[nodiscard]] Vec3d operator[](std::size_t i) const {
    return i < sample_count() ? samples_.position(samples_.sample(i))
                              : surface_.positions[vertices_[i - sample_count()]];
  }

 private:
  const Surface& surface_;
  AreaSamples samples_;
  std::vector<std::uint32_t> vertices_;
};

/// Neither surface is empty.
OneWayDeviation measure_one_way(const MeasuredPoints& points, const TriangleTree& tree) {
  OneWayDeviation result;
  struct Partial {
    double max2 = -1.0;
    Vec3d worst{0.0};
    double sum2 = 0.0;
  };
  std::vector<Partial> partials((points.size() + kChunk - 1) / kChunk);
  parallel_for_each_index(partials.size(), 1, [&](std::size_t chunk) {
    Partial& partial = partials[chunk];
    std::uint32_t hint = 0xFFFFFFFFu;
    for (std::size_t i = chunk * kChunk; i < std::min(points.size(), (chunk + 1) * kChunk); ++i) {
      const Vec3d p = points[i];
      const NearestPoint nearest = tree.nearest(p, hint);
      hint = nearest.triangle;
      if (i < points.sample_count()) partial.sum2 += nearest.distance2;
      if (nearest.distance2 > partial.max2) {
        partial.max2 = nearest.distance2;
        partial.worst = p;
      }
    }
  });
  Partial total;
  for (const Partial& p : partials) {
    total.sum2 += p.sum2;
    if (p.max2 > total.max2) {
      total.max2 = p.max2;
      total.worst = p.worst;
    }
  }
  result.max = std::sqrt(std::max(0.0, total.max2));
  const auto samples = static_cast<double>(points.sample_count());
  result.rms = samples > 0.0 ? std::sqrt(total.sum2 / samples) : 0.0;
  result.worst = total.worst;
  result.points = points.size();
  return result;
}

OneWayDeviation nowhere_near() {
  OneWayDeviation result;
  result.max = result.rms = std::numeric_limits<double>::infinity();
  return result;
}

}  // namespace

struct DeviationFrom::Parts {
  Parts(const Surface& a, const DeviationOptions& o)
      : surface(a), options(o), points(a, o), tree(a, TriangleTree::Positions::kShared) {}
  const Surface& surface;
  DeviationOptions options;
  MeasuredPoints points;
  TriangleTree tree;
};

DeviationFrom::DeviationFrom(const Surface& a, const DeviationOptions& options)
    : parts_(std::make_unique<Parts>(a, options)) {}
DeviationFrom::~DeviationFrom() = default;
DeviationFrom::DeviationFrom(DeviationFrom&&) noexcept = default;

DeviationReport DeviationFrom::measure(const Surface& b) const {
  DeviationReport report;
  const bool has_a = !parts_->surface.triangles.empty(), has_b = !b.triangles.empty();
  if (has_a && has_b) {
    report.a_to_b = measure_one_way(parts_->points, TriangleTree(b));
    report.b_to_a = measure_one_way(MeasuredPoints(b, parts_->options), parts_->tree);
  } else if (has_a) {
    report.a_to_b = nowhere_near();
  } else if (has_b) {
    report.b_to_a = nowhere_near();
  }
  return report;
}

}  // namespace meshlode::judge
