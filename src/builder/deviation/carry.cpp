// SPDX-License-Identifier: GPL-3.0-or-later
// Source to group: carried samples find their new nearest triangle, and are thinned.
#include <algorithm>
#include <cmath>
#include <limits>

#include "builder/deviation/group_measure.h"

namespace meshlode::builder {

double project_samples(const SurfaceTree& group_tree, std::vector<CarriedSample>& samples) {
  // Below this share of the largest distance it is enough to know that a sample is near: nothing is done around it, and
  // of its triangle's samples the farther ones are kept.
  constexpr double kNearShare = 0.4;
  const double frame2 = kNearShare * kNearShare * group_tree.scale() * group_tree.scale();
  double largest2 = 0.0;
  float enough = 0.0F;
  TreeSlot place{0U};  // of the sample before: samples come in the order of the surface that carried them
  for (CarriedSample& sample : samples) {
    const Vec3f point = group_tree.to_frame(sample.point);
    SurfaceTree::Hit hit = group_tree.look_around(point, place, {});
    if (!(hit.distance2 <= enough)) hit = group_tree.find_nearest(point, hit, enough);
    place = hit.slot.is_valid() ? hit.slot : TreeSlot{0U};
    const double distance2 = group_tree.distance2_at(sample.point, place);
    sample.triangle = group_tree.triangle_at(place);
    sample.distance = static_cast<float>(std::sqrt(distance2));
    if (!(distance2 > largest2)) continue;
    largest2 = distance2;
    enough = static_cast<float>(frame2 * largest2);
  }
  return std::sqrt(largest2);
}

UnsetVector<CarriedSample> thin_samples(std::span<const CarriedSample> samples, std::size_t triangle_count,
                                        std::uint32_t samples_per_triangle, double maximum) {
  std::vector<std::uint32_t> start(triangle_count + 1, 0);
  for (const CarriedSample& sample : samples) ++start[sample.triangle + 1];
  for (std::size_t t = 0; t < triangle_count; ++t) start[t + 1] += start[t];
  std::vector<std::uint32_t> order(samples.size());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::uint32_t i = 0; i < samples.size(); ++i) order[next[samples[i].triangle]++] = i;

  UnsetVector<CarriedSample> kept;
  kept.reserve(std::min(samples.size(), triangle_count * (samples_per_triangle + 1)));
  const auto high = static_cast<float>(0.5 * maximum);
  const std::uint32_t most = 3 * samples_per_triangle;  // of those near the maximum
  for (std::size_t t = 0; t < triangle_count; ++t) {
    const auto first = order.begin() + static_cast<std::ptrdiff_t>(start[t]);
    const auto last = order.begin() + static_cast<std::ptrdiff_t>(start[t + 1]);
    const auto is_farther = [&](std::uint32_t a, std::uint32_t b) {
      return samples[a].distance != samples[b].distance ? samples[a].distance > samples[b].distance : a < b;
    };
    std::sort(first, last, is_farther);
    std::uint32_t taken = 0;
    auto at = first;
    for (; at != last; ++at) {
      const bool is_high = samples[*at].distance > high && taken < most;
      // All but the last by distance; the last for spread, below.
      if (!is_high && taken + 1 >= samples_per_triangle && taken > 0) break;
      kept.push_back(samples[*at]);
      ++taken;
    }
    if (at == last || taken >= samples_per_triangle) continue;
    // Of the others the one farthest from the farthest: the far end of the triangle is looked after too.
    std::uint32_t best = *at;
    double best2 = -1.0;
    for (auto other = at; other != last; ++other) {
      const Vec3d apart = samples[*other].point - samples[*first].point;
      const double apart2 = glm::dot(apart, apart);
      if (apart2 > best2) {
        best2 = apart2;
        best = *other;
      }
    }
    kept.push_back(samples[best]);
  }
  return kept;
}

}  // namespace meshlode::builder
