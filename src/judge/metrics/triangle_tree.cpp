// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/box.h"
#include "base/parallel.h"
#include "base/release.h"

namespace meshlode::judge {
namespace {

constexpr std::uint32_t kLeafSize = 4;
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

// A box may have this many times the area of its triangle before it is cut; an equilateral triangle has up to 3.5.
constexpr double kMaxWaste = 16.0;
constexpr double kMostPieces = 8.0;  // of one triangle
// In all: twice the triangles, or this many where the triangles are few.
constexpr double kPieceBudget = 262144.0;

Box3d box_of(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
}

/// Into how many pieces a triangle would best be cut.
double wanted_pieces(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Box3d box = box_of(a, b, c);
  const Vec3d size = box.size();
  const Vec3d cross = glm::cross(b - a, c - a);
  const double area = 0.5 * std::sqrt(glm::dot(cross, cross));
  const double of_box = size.x * size.y + size.y * size.z + size.z * size.x;
  // No more than long in widths either way; nothing that is not a number asks for anything.
  return of_box > kMaxWaste * area ? std::min(kMostPieces, std::ceil(of_box / std::max(kMaxWaste * area, of_box / 1e9)))
                                   : 1.0;
}

/// The box of what lies between two planes across an axis, a little too large rather than too small.
Box3d box_between(const std::array<Vec3d, 3>& corners, int axis, double from, double to) {
  Box3d box;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d& p = corners[k];
    const Vec3d& q = corners[(k + 1) % 3];
    if (p[axis] >= from && p[axis] <= to) box.add(p);
    for (const double plane : {from, to}) {
      if ((p[axis] < plane) == (q[axis] < plane)) continue;
      box.add(p + (q - p) * std::clamp((plane - p[axis]) / (q[axis] - p[axis]), 0.0, 1.0));
    }
  }
  const Box3d whole = box_of(corners[0], corners[1], corners[2]);
  const Vec3d size = whole.size(), far = glm::max(glm::abs(whole.low), glm::abs(whole.high));
  const double rounding = 1e-12 * std::max({size.x, size.y, size.z}) + 1e-15 * std::max({far.x, far.y, far.z});
  return {box.low - rounding, box.high + rounding};
}

/// How many nodes there are below one with so many items, and below one with one more.
std::array<std::uint32_t, 2> nodes_below_two(std::uint32_t count) {
  if (count < kLeafSize) return {0, 0};
  const auto [half, more] = nodes_below_two(count / 2);
  const std::uint32_t even = 2 + 2 * half, odd = 2 + half + more;
  if (count == kLeafSize) return {0, 2};
  return count % 2 == 0 ? std::array{even, odd} : std::array{odd, 2 + 2 * more};
}
std::uint32_t nodes_below(std::uint32_t count) {
  return nodes_below_two(count)[0];
}

template <class Box>
std::array<float, 3> center_of(const Box& box) {
  std::array<float, 3> center;
  for (std::size_t k = 0; k < 3; ++k) center[k] = 0.5F * box.low[k] + 0.5F * box.high[k];
  return center;
}

}  // namespace

void TriangleTree::set_frame(const Surface& surface) {
  Box3d box;
  for (const auto& t : surface.triangles) {
    for (const std::uint32_t v : t) box.add(surface.positions[v]);
  }
  const auto& [low, high] = box;
  origin_ = 0.5 * low + 0.5 * high;
  const Vec3d half = 0.5 * high - 0.5 * low;
  int exponent = 0;
  (void)std::frexp(std::max({half.x, half.y, half.z}), &exponent);
  scale_ = std::ldexp(1.0, std::clamp(-exponent, -500, 500));  // its square is a double too
  const Vec3d far = glm::max(glm::abs(low), glm::abs(high));
  rounding_ = 0x1p-51 * scale_ * std::max({far.x, far.y, far.z});
}

TriangleTree::Box TriangleTree::to_frame(const Vec3d& low, const Vec3d& high) const {
  const Vec3d from = to_frame(low) - rounding_, to = to_frame(high) + rounding_;
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    box.low[k] = std::nextafter(static_cast<float>(from[axis]), -std::numeric_limits<float>::infinity());
    box.high[k] = std::nextafter(static_cast<float>(to[axis]), std::numeric_limits<float>::infinity());
  }
  return box;
}

TriangleTree::Items TriangleTree::cut_to_pieces(const Surface& surface) const {
  const std::size_t count = surface.triangles.size();
  const auto corners_of = [&](std::size_t i) {
    const auto& t = surface.triangles[i];
    return std::array<Vec3d, 3>{surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]};
  };
  double most = kMostPieces;
  const double budget = std::max(2.0 * static_cast<double>(count), kPieceBudget);
  std::vector<float> wanted(count);
  parallel_for_each_index(count, kLoopGrain, [&](std::size_t i) {
    const auto [a, b, c] = corners_of(i);
    wanted[i] = static_cast<float>(wanted_pieces(a, b, c));  // small whole numbers
  });
  for (; most > 1.0; most *= 0.5) {
    double sum = 0.0;
    for (const float pieces : wanted) sum += std::min(double{pieces}, most);
    if (sum <= budget) break;
  }
  Items out{surface, {}, {}};
  std::size_t item_count = 0, piece_count = 0;  // room for all of them: growing would hold twice as much for a moment
  for (const float pieces : wanted) {
    const auto parts = static_cast<std::size_t>(std::min(double{pieces}, most));
    item_count += std::max<std::size_t>(1, parts);
    piece_count += parts > 1 ? parts : 0;
  }
  out.items.reserve(item_count);
  out.pieces.reserve(piece_count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Vec3d, 3> corners = corners_of(i);
    const Box3d box = box_of(corners[0], corners[1], corners[2]);
    const auto triangle = static_cast<std::uint32_t>(i);
    const auto parts = static_cast<std::uint32_t>(std::min(double{wanted[i]}, most));
    if (parts <= 1) {
      out.items.push_back({center_of(to_frame(box.low, box.high)), triangle});
      continue;
    }
    const Vec3d size = box.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    double from = box.low[axis];
    for (std::uint32_t part = 1; part <= parts; ++part) {
      const double to = part == parts ? box.high[axis] : box.low[axis] + size[axis] * part / parts;
      const Box3d piece = box_between(corners, axis, from, to);
      out.pieces.push_back({to_frame(piece.low, piece.high), triangle});
      out.items.push_back(
          {center_of(out.pieces.back().box), static_cast<std::uint32_t>(count + out.pieces.size() - 1)});
      from = to;
    }
  }
  return out;
}

TriangleTree::Box TriangleTree::box_of_item(const Items& items, const Item& item) const {
  const Surface& surface = items.surface;
  if (item.id >= surface.triangles.size()) return items.pieces[item.id - surface.triangles.size()].box;
  const auto& t = surface.triangles[item.id];
  const Box3d box = box_of(surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]);
  return to_frame(box.low, box.high);
}

TriangleTree::TriangleTree(const Surface& surface, Positions positions) {
  if (surface.triangles.empty()) return;
  set_frame(surface);
  Items items = cut_to_pieces(surface);
  const auto count = static_cast<std::uint32_t>(items.items.size());
  nodes_.resize(1 + nodes_below(count));
  split({0, 1}, items, 0, count);
  const auto grow = [](Box& box, const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], other.low[k]);
      box.high[k] = std::max(box.high[k], other.high[k]);
    }
  };
  parallel_for_each_index(nodes_.size(), kLoopGrain, [&](std::size_t n) {
    Node& node = nodes_[n];
    if (node.count == 0) return;
    node.box = box_of_item(items, items.items[node.first]);
    for (std::uint32_t i = node.first + 1; i < node.first + node.count; ++i) {
      grow(node.box, box_of_item(items, items.items[i]));
    }
  });
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children lie behind their node
    Node& node = nodes_[n];
    if (node.count != 0) continue;
    node.box = nodes_[node.first].box;
    grow(node.box, nodes_[node.first + 1].box);
  }
  triangle_.resize(count);
  for (std::size_t i = 0; i < count; ++i) triangle_[i] = items.triangle_of(items.items[i]);
  release(items.items, items.pieces);
  place_.resize(surface.triangles.size());
  for (std::uint32_t i = 0; i < count; ++i) place_[triangle_[i]] = i;
  positions_ = surface.positions;
  shared_ = surface.triangles;
  if (positions == Positions::kCopied) copy(surface);
}

void TriangleTree::copy(const Surface& surface) {
  corners_.reserve(triangle_.size());
  for (const std::uint32_t triangle : triangle_) corners_.push_back(surface.triangles[triangle]);
  constexpr std::uint32_t kUnused = 0xFFFFFFFFU;
  std::vector<std::uint32_t> renamed(surface.positions.size(), kUnused);
  std::uint32_t used = 0;
  for (auto& corners : corners_) {
    for (std::uint32_t& corner : corners) {
      std::uint32_t& name = renamed[corner];
      if (name == kUnused) name = used++;
      corner = name;
    }
  }
  copied_.resize(used);
  for (std::size_t v = 0; v < renamed.size(); ++v) {
    if (renamed[v] != kUnused) copied_[renamed[v]] = surface.positions[v];
  }
  positions_ = copied_;
  shared_ = {};
}

void TriangleTree::split(const Place& place, Items& items, std::uint32_t first, std::uint32_t count) {
  Node& node = nodes_[place.node];
  if (count <= kLeafSize) {
    node.first = first;
    node.count = count;
    return;
  }
  std::array<float, 3> low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[static_cast<std::size_t>(axis)] = std::numeric_limits<float>::infinity();
    high[static_cast<std::size_t>(axis)] = -std::numeric_limits<float>::infinity();
  }
  for (std::uint32_t i = first; i < first + count; ++i) {
    const std::array<float, 3>& center = items.items[i].center;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], center[axis]);
      high[axis] = std::max(high[axis], center[axis]);
    }
  }
  const Vec3f extent(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  const auto begin = items.items.begin() + first;
  // Pieces of one triangle whose centres agree are alike in all that matters.
  std::nth_element(begin, begin + half, begin + count, [&](const Item& a, const Item& b) {
    return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis]
                                            : items.triangle_of(a) < items.triangle_of(b);
  });
  node.first = place.below;  // the two children, then what is below the left one, then what is below the right one
  const auto left = [&] { split({place.below, place.below + 2}, items, first, half); };
  const auto right = [&] {
    split({place.below + 1, place.below + 2 + nodes_below(half)}, items, first + half, count - half);
  };
  constexpr std::uint32_t kMany = 8192;  // items: worth a task
  if (count >= kMany) {
    parallel_all(left, right);
  } else {
    left();  // depth: log2 of the number of pieces
    right();
  }
}

inline double TriangleTree::distance2_to_box(const Box& box, const Vec3d& p) {
  const double x = std::max(std::max(double{box.low[0]} - p.x, p.x - double{box.high[0]}), 0.0);
  const double y = std::max(std::max(double{box.low[1]} - p.y, p.y - double{box.high[1]}), 0.0);
  const double z = std::max(std::max(double{box.low[2]} - p.z, p.z - double{box.high[2]}), 0.0);
  return x * x + y * y + z * z;
}

inline double TriangleTree::distance2_at(const Vec3d& point, std::uint32_t place, double limit) const {
  const auto& t = shared_.empty() ? corners_[place] : shared_[triangle_[place]];
  const Vec3d &a = positions_[t[0]], &b = positions_[t[1]], &c = positions_[t[2]];
  if (has_far_plane(point, a, b, c, limit)) return std::numeric_limits<double>::infinity();
  return distance2_to_triangle(point, a, b, c);
}

NearestPoint TriangleTree::search(const Vec3d& point, std::uint32_t hint, NearestPoint best, double enough) const {
  if (nodes_.empty()) return best;
  const Vec3d at = to_frame(point);
  const double scale2 = scale_ * scale_;
  double limit = best.distance2 * scale2;  // in the frame
  const auto try_triangle = [&](std::uint32_t i) {
    const double d = distance2_at(point, i, best.distance2);
    if (!(d < best.distance2)) return;
    best = {d, triangle_[i]};
    limit = d * scale2;
  };
  if (hint < place_.size()) try_triangle(place_[hint]);
  struct Entry {
    std::uint32_t node;
    double distance2;
  };
  std::array<Entry, 64> stack;  // median splits: the depth is below 32
  std::size_t size = 0;
  stack[size++] = {0, distance2_to_box(nodes_[0].box, at)};
  while (size > 0) {
    if (best.triangle != kNoId && best.distance2 <= enough) return best;
    const Entry entry = stack[--size];
    if (entry.distance2 >= limit) continue;
    const Node& node = nodes_[entry.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) try_triangle(i);
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

void TriangleTree::find_within(const Vec3d& point, double distance2, std::vector<NearestPoint>& found) const {
  if (nodes_.empty()) return;
  const Vec3d at = to_frame(point);
  const double limit = distance2 * (scale_ * scale_);
  const auto first_found = static_cast<std::ptrdiff_t>(found.size());
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
      const double d = distance2_at(point, i, distance2);
      if (d <= distance2) found.push_back({d, triangle_[i]});
    }
  }
  if (triangle_.size() == place_.size()) return;  // else a triangle was met in several pieces
  const auto begin = found.begin() + first_found;
  std::sort(begin, found.end(), [](const NearestPoint& a, const NearestPoint& b) { return a.triangle < b.triangle; });
  const auto end = std::unique(begin, found.end(),
                               [](const NearestPoint& a, const NearestPoint& b) { return a.triangle == b.triangle; });
  found.erase(end, found.end());
}

}  // namespace meshlode::judge
