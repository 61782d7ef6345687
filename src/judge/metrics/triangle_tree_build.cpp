// SPDX-License-Identifier: GPL-3.0-or-later
// How the tree is made: triangles that fill little of their boxes are cut, then halves are split until leaves are left.
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
  constexpr std::uint32_t kWorthATask = 8192;
  if (count >= kWorthATask) {
    parallel_all(left, right);
  } else {
    left();  // depth: log2 of the number of pieces
    right();
  }
}

}  // namespace meshlode::judge
