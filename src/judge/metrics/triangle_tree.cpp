// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace meshlode::judge {
namespace {

// Of parallel needles, of triangles that cross, and of a part that is smaller than floats of the whole tell apart,
// every box holds a point near to them, and which one is nearest takes a look at thousands. Bracketing 12 cuts of
// random scenes 1311736 and 940040 takes 3.0 and 1.9 processor seconds for more than 175 and 43; 5.9 and 3.5 with 64.
constexpr std::uint32_t kMany = 16;
// Below this sine at its sharpest corners a triangle is taken as its edges: its normal would be mostly rounding, and
// its inside is this close to an edge, relative to its length.
constexpr double kNeedleSine = 1e-8;

// Where its sharpest corner has a greater sine a triangle's normal is known to 1e-12.
constexpr double kPlaneSine = 1e-4;
/// A squared distance from a plane, or in it from an edge, that is beyond `limit2` whatever rounding says: of a point
/// that is this far from a corner.
double surely_beyond(double limit2, const Vec3d& corner) {
  return (1.0 + 1e-6) * limit2 + 1e-16 * glm::dot(corner, corner);
}

// Squared distance from the origin to the segment a-b.
double distance2_to_segment(const Vec3d& a, const Vec3d& b) {
  const Vec3d d = b - a;
  const double dd = glm::dot(d, d);
  const double t = dd > 0.0 ? std::clamp(-glm::dot(a, d) / dd, 0.0, 1.0) : 0.0;
  const Vec3d n = a + d * t;
  return glm::dot(n, n);
}

}  // namespace

double distance2_to_triangle(const Vec3d& p, const Vec3d& corner_a, const Vec3d& corner_b, const Vec3d& corner_c) {
  // Relative to the point: a far-away pair keeps the digits of its difference.
  const Vec3d a = corner_a - p, b = corner_b - p, c = corner_c - p;
  const Vec3d ab = b - a, bc = c - b, ca = a - c;
  const Vec3d n = glm::cross(ab, -ca);
  const double nn = glm::dot(n, n);
  const double longest2 = std::max(glm::dot(ab, ab), std::max(glm::dot(bc, bc), glm::dot(ca, ca)));
  if (nn > kNeedleSine * kNeedleSine * longest2 * longest2) {
    const bool is_over = glm::dot(glm::cross(ab, -a), n) >= 0.0 && glm::dot(glm::cross(bc, -b), n) >= 0.0 &&
                         glm::dot(glm::cross(ca, -c), n) >= 0.0;
    if (is_over) {
      const double h = glm::dot(a, n);
      return h * h / nn;
    }
  }
  return std::min(distance2_to_segment(a, b), std::min(distance2_to_segment(b, c), distance2_to_segment(c, a)));
}

bool is_near_triangle(const Vec3d& p, const Vec3d& corner_a, const Vec3d& corner_b, const Vec3d& corner_c,
                      double limit2) {
  const Vec3d a = corner_a - p, b = corner_b - p, c = corner_c - p;
  const Vec3d ab = b - a, bc = c - b, ca = a - c;
  const Vec3d n = glm::cross(ab, -ca);
  const double nn = glm::dot(n, n), sides2 = glm::dot(ab, ab) + glm::dot(ca, ca);
  if (nn > kPlaneSine * kPlaneSine * sides2 * sides2) {
    const double h = glm::dot(a, n), far2 = nn * surely_beyond(limit2, a);
    if (h * h > far2) return false;
    const double u = glm::dot(glm::cross(ab, a), n), v = glm::dot(glm::cross(bc, b), n),
                 w = glm::dot(glm::cross(ca, c), n);  // beside an edge where positive
    if (u <= 0.0 && v <= 0.0 && w <= 0.0) return h * h / nn <= limit2;
    if ((u > 0.0 && u * u > far2 * glm::dot(ab, ab)) || (v > 0.0 && v * v > far2 * glm::dot(bc, bc)) ||
        (w > 0.0 && w * w > far2 * glm::dot(ca, ca))) {
      return false;
    }
  }
  return distance2_to_triangle(p, corner_a, corner_b, corner_c) <= limit2;
}

namespace {

/// Whether the plane of a triangle is farther from a point than this, by more than rounding may say: then the triangle
/// is. Where large triangles cross their boxes hold every point, and nearly all that are asked are dismissed so, for
/// little of the arithmetic.
bool has_far_plane(const Vec3d& p, const Vec3d& corner_a, const Vec3d& corner_b, const Vec3d& corner_c,
                   double distance2) {
  const Vec3d a = corner_a - p, ab = corner_b - corner_a, ac = corner_c - corner_a;
  const Vec3d n = glm::cross(ab, ac);
  const double nn = glm::dot(n, n), h = glm::dot(a, n);
  const double sides2 = glm::dot(ab, ab) + glm::dot(ac, ac);  // at least half the square of the longest
  return nn > kPlaneSine * kPlaneSine * sides2 * sides2 && h * h > nn * surely_beyond(distance2, a);
}

}  // namespace

inline double TriangleTree::distance2_to_box(const Box& box, const Vec3d& p) {
  const double x = std::max(std::max(double{box.low[0]} - p.x, p.x - double{box.high[0]}), 0.0);
  const double y = std::max(std::max(double{box.low[1]} - p.y, p.y - double{box.high[1]}), 0.0);
  const double z = std::max(std::max(double{box.low[2]} - p.z, p.z - double{box.high[2]}), 0.0);
  return x * x + y * y + z * z;
}

inline double TriangleTree::distance2_at(const Vec3d& point, std::uint32_t place, double limit) const {
  const auto& t = corners_at(place);
  const Vec3d &a = positions_[t[0]], &b = positions_[t[1]], &c = positions_[t[2]];
  if (has_far_plane(point, a, b, c, limit)) return std::numeric_limits<double>::infinity();
  return distance2_to_triangle(point, a, b, c);
}

NearestPoint TriangleTree::search(const Vec3d& point, std::uint32_t hint, NearestPoint best, double enough,
                                  double at_last) const {
  if (nodes_.empty()) return best;
  const Vec3d at = to_frame(point);
  const double scale2 = scale_ * scale_;
  double limit = best.distance2 * scale2;  // in the frame
  const auto try_triangle = [&](std::uint32_t i) {
    const double d = distance2_at(point, i, best.distance2);
    if (!(d < best.distance2)) return;
    best = {d, triangle_[i], true};
    limit = d * scale2;
  };
  if (hint < place_.size()) try_triangle(place_[hint]);
  struct Entry {
    std::uint32_t node;
    double distance2;
  };
  std::array<Entry, 64> stack;  // median splits: the depth is below 32
  std::size_t size = 0;
  std::uint32_t tried = 0;
  stack[size++] = {0, distance2_to_box(nodes_[0].box, at)};
  while (size > 0) {
    if (best.triangle != kNoId && best.distance2 <= enough) {
      best.is_nearest = best.distance2 == 0.0;
      return best;
    }
    const Entry entry = stack[--size];
    if (entry.distance2 >= limit) continue;
    const Node& node = nodes_[entry.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) try_triangle(i);
      tried += node.count;
      if (tried >= kMany) enough = std::max(enough, at_last);
      continue;
    }
    Entry near{node.first, distance2_to_box(nodes_[node.first].box, at)};
    Entry far{node.first + 1, distance2_to_box(nodes_[node.first + 1].box, at)};
    if (far.distance2 < near.distance2) std::swap(near, far);
    if (far.distance2 < limit) stack[size++] = far;
    if (near.distance2 < limit) stack[size++] = near;
  }
  return best;
}

template <class Visit>
void TriangleTree::visit_near(const Vec3d& point, double distance2, const Visit& visit) const {
  if (nodes_.empty()) return;
  const Vec3d at = to_frame(point);
  const double limit = distance2 * (scale_ * scale_);
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    if (distance2_to_box(node.box, at) > limit) continue;
    if (node.count == 0) {
      stack[size++] = node.first;
      stack[size++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      if (visit(i)) return;
    }
  }
}

std::uint32_t TriangleTree::find_covering(const std::array<Vec3d, 3>& corners, double distance2) const {
  std::uint32_t found = kNoId;
  const Vec3d middle = (corners[0] + corners[1] + corners[2]) / 3.0;
  visit_near(middle, distance2, [&](std::uint32_t i) {
    const auto& t = corners_at(i);
    const Vec3d &a = positions_[t[0]], &b = positions_[t[1]], &c = positions_[t[2]];
    const auto is_near = [&](const Vec3d& p) { return is_near_triangle(p, a, b, c, distance2); };
    const bool covers = is_near(middle) && is_near(corners[0]) && is_near(corners[1]) && is_near(corners[2]);
    if (covers) found = triangle_[i];
    return covers;
  });
  return found;
}

void TriangleTree::find_within(const Vec3d& point, double distance2, std::vector<NearestPoint>& found) const {
  const auto first_found = static_cast<std::ptrdiff_t>(found.size());
  visit_near(point, distance2, [&](std::uint32_t i) {
    const double d = distance2_at(point, i, distance2);
    if (d <= distance2) found.push_back({d, triangle_[i]});
    return false;
  });
  if (triangle_.size() == place_.size()) return;  // else a triangle was met in several pieces
  const auto begin = found.begin() + first_found;
  std::sort(begin, found.end(), [](const NearestPoint& a, const NearestPoint& b) { return a.triangle < b.triangle; });
  const auto end = std::unique(begin, found.end(),
                               [](const NearestPoint& a, const NearestPoint& b) { return a.triangle == b.triangle; });
  found.erase(end, found.end());
}

}  // namespace meshlode::judge
