// SPDX-License-Identifier: GPL-3.0-or-later
// Group to source where a border closed: a hole, a notch or the gap between two sheets that the coarser surface spans.
// The farthest point lies in the middle of what was open, which may be a sliver of one triangle of the group; points
// spread over triangles miss it. But the edges around it are known.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "builder/deviation/group_measure.h"

namespace meshlode::builder {

namespace {

// Away from a border by this much more than the maximum, since what is nearer to it cannot be farther from the source.
constexpr double kBeyond = 1.05;
// The group is looked for within this share of how far away that is.
constexpr double kBeside = 0.5;
constexpr int kDoublings = 6, kHalvings = 7;

class ClosedBorders {
 public:
  ClosedBorders(const SurfaceTree& source, const SurfaceTree& group, Farthest farthest)
      : source_(source), group_(group), farthest_(farthest) {}

  [[nodiscard]] const Farthest& farthest() const { return farthest_; }

  /// Beyond one border edge: `away` is unit, out of the triangle that has the edge.
  void look_beyond(const Vec3d& middle, const Vec3d& along, const Vec3d& away, double length) {
    double step = std::max(kBeyond * farthest_.to_beat(), length / 16.0);
    double best = 0.0, best_step = 0.0;
    Vec3d at_best{0.0};
    for (int i = 0; i < kDoublings; ++i, step *= 2.0) {
      Vec3d at{0.0};
      if (!find_group(middle + away * step, kBeside * step, at)) break;
      const double distance = distance_to_source(at);
      if (!(distance > best)) break;  // beyond the middle of what was open
      best = distance;
      best_step = step;
      at_best = at;
    }
    if (best > farthest_.to_beat()) climb(at_best, along, away, best, 0.5 * best_step);
  }

 private:
  /// The group's point that is nearest, if one is so near.
  bool find_group(const Vec3d& point, double within, Vec3d& at) const {
    const double bound = within * group_.scale();
    const SurfaceTree::Hit hit =
        group_.find_nearest(group_.to_frame(point), {TreeSlot(), static_cast<float>(bound * bound)}, 0.0F);
    if (!hit.slot.is_valid()) return false;
    at = nearest_point(point, group_.corners_at(hit.slot));
    return true;
  }

  /// 0 where it is not above the maximum.
  double distance_to_source(const Vec3d& point) {
    const float enough = source_.squared_in_frame(farthest_.to_beat());
    const Vec3f at = source_.to_frame(point);
    SurfaceTree::Hit hit = source_.look_around(at, place_, {});
    if (!(hit.distance2 <= enough)) hit = source_.find_nearest(at, hit, enough);
    if (!hit.slot.is_valid()) return 0.0;
    place_ = hit.slot;
    if (hit.distance2 <= enough) return 0.0;
    return std::sqrt(source_.distance2_at(point, hit.slot));
  }

  /// To where the distance is largest nearby, along the group.
  void climb(Vec3d at, const Vec3d& along, const Vec3d& away, double distance, double step) {
    for (int halving = 0; halving < kHalvings; step *= 0.5, ++halving) {
      for (bool is_higher = true; is_higher;) {
        is_higher = false;
        farthest_.take(distance);
        for (int direction = 0; direction < 8; ++direction) {
          constexpr std::array<std::array<double, 2>, 8> kAround{
              {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {0.7, 0.7}, {-0.7, 0.7}, {0.7, -0.7}, {-0.7, -0.7}}};
          const auto& [u, v] = kAround[static_cast<std::size_t>(direction)];
          Vec3d next{0.0};
          if (!find_group(at + (along * u + away * v) * step, step, next)) continue;
          const double there = distance_to_source(next);
          if (!(there > 1.001 * distance)) continue;
          distance = there;
          at = next;
          is_higher = true;
          break;
        }
      }
    }
  }

  const SurfaceTree &source_, &group_;
  Farthest farthest_;
  TreeSlot place_{0U};
};

}  // namespace

Farthest measure_closed_borders(const SurfaceTree& source, const SurfaceTree& group_tree, const GroupSurface& finer,
                                const GroupEdges& edges, std::span<const std::uint8_t> is_shared, Farthest farthest) {
  ClosedBorders closed(source, group_tree, farthest);
  for (std::uint32_t t = 0; t < finer.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!edges.is_border(t, k)) continue;
      const auto& ids = finer.triangles[t];
      const std::uint32_t a = ids[k], b = ids[(k + 1) % 3];
      if (is_shared.empty() || (is_shared[a] != 0 && is_shared[b] != 0)) continue;
      const Vec3d edge = finer.positions[b] - finer.positions[a];
      const double length = glm::length(edge);
      if (!(length > 0.0)) continue;
      const Vec3d along = edge / length;
      const Vec3d middle = finer.positions[a] + 0.5 * edge;
      Vec3d away = middle - finer.positions[ids[(k + 2) % 3]];
      away -= along * glm::dot(along, away);
      const double width = glm::length(away);
      if (!(width > 0.0)) continue;
      closed.look_beyond(middle, along, away / width, length);
    }
  }
  return closed.farthest();
}

}  // namespace meshlode::builder
