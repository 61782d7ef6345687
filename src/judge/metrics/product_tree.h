// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest points on triangles of the product space (product_distance.h), in doubles: its triangles are flat, in as many
// coordinates as there are. Internal to the room.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"

namespace meshlode::judge {

/// Which coordinates are what: position, two for each UV set, three for the normal.
struct ProductLayout {
  std::uint32_t uv_sets = 0;  ///< that count
  bool has_normal = false;
  [[nodiscard]] std::uint32_t normal_at() const { return 3 + 2 * uv_sets; }
  [[nodiscard]] std::uint32_t size() const { return normal_at() + (has_normal ? 3 : 0); }
  [[nodiscard]] std::uint32_t all_known() const { return (1U << (uv_sets + 1)) - 1; }
};

/// Coordinates from ProductLayout::size() on are 0, as are those that are not known. Bit k of `known` is set where UV
/// set k is, bit uv_sets for the normal.
template <std::size_t N>
struct ProductPoint {
  std::array<double, N> x{};
  std::uint32_t known = 0;
  [[nodiscard]] Vec3d position() const { return {x[0], x[1], x[2]}; }
};

namespace product {

constexpr std::uint32_t kLeafSize = 4;  // triangles

template <std::size_t N>
using Row = std::array<double, N>;

template <std::size_t N>
double dot(const Row<N>& a, const Row<N>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < N; ++k) sum += a[k] * b[k];
  return sum;
}

template <std::size_t N>
Row<N> minus(const Row<N>& a, const Row<N>& b) {
  Row<N> out;
  for (std::size_t k = 0; k < N; ++k) out[k] = a[k] - b[k];
  return out;
}

template <std::size_t N>
using Corners = std::array<Row<N>, 3>;

/// Of a flat triangle: along the longest edge and across it, which is well conditioned for needles too.
template <std::size_t N>
struct Frame {
  Row<N> along{}, across{};  ///< from the edge's first corner to its second; from the foot of the third to the third
  double along2, across2;    ///< their squared lengths
  double foot = 0.0;         ///< of the third corner, in lengths of the edge
  std::uint32_t first = 0;   ///< the corner where the edge begins; the others follow

  [[nodiscard]] bool is_point() const { return !(along2 > 0.0); }
  [[nodiscard]] bool is_line() const { return !(across2 > 1e-28 * along2); }
};

template <std::size_t N>
Frame<N> frame_of(const Corners<N>& corners) {
  Frame<N> frame;
  frame.along2 = -1.0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Row<N> edge = minus(corners[(k + 1) % 3], corners[k]);
    const double length2 = dot(edge, edge);
    if (length2 > frame.along2) {
      frame.along2 = length2;
      frame.along = edge;
      frame.first = k;
    }
  }
  frame.across = minus(corners[(frame.first + 2) % 3], corners[frame.first]);
  if (!frame.is_point()) {
    frame.foot = dot(frame.across, frame.along) / frame.along2;
    for (std::size_t k = 0; k < N; ++k) frame.across[k] -= frame.foot * frame.along[k];
  }
  frame.across2 = dot(frame.across, frame.across);
  return frame;
}

/// The nearest point of a flat triangle, which may be a needle, a segment or a point.
struct FlatNearest {
  double distance2 = 0.0;
  std::array<double, 3> weight{};  ///< of the corners
};

/// `v`: from the corner where the frame begins. `enough`: what is not nearer than that, squared, may be found to be
/// infinitely far.
template <std::size_t N>
FlatNearest nearest_on_flat(const Row<N>& v, const Frame<N>& frame,
                            double enough = std::numeric_limits<double>::infinity()) {
  const std::size_t first = frame.first, second = (first + 1) % 3, third = (first + 2) % 3;
  FlatNearest out;
  if (frame.is_point()) {
    out.weight[first] = 1.0;
    out.distance2 = dot(v, v);
    return out;
  }
  const double foot = frame.foot;
  const double t = dot(v, frame.along) / frame.along2;
  // What is left of v without its part along the edge, not v itself: `across` is rounded by the edge's length, and a
  // needle's height is small beside that.
  Row<N> rest = v;
  for (std::size_t k = 0; k < N; ++k) rest[k] -= t * frame.along[k];
  const double h = !frame.is_line() ? dot(rest, frame.across) / frame.across2 : 0.0;
  for (std::size_t k = 0; k < N; ++k) rest[k] -= h * frame.across[k];
  const double residual2 = dot(rest, rest);
  if (residual2 >= enough) {
    out.distance2 = std::numeric_limits<double>::infinity();
    return out;
  }
  // In the plane: corners at (0, 0), (1, 0) and (foot, 1), lengths `along` and `across`.
  const double w2 = h, w1 = t - h * foot;
  if (!frame.is_line() && w1 >= 0.0 && w2 >= 0.0 && w1 + w2 <= 1.0) {
    out.weight[first] = 1.0 - w1 - w2;
    out.weight[second] = w1;
    out.weight[third] = w2;
    out.distance2 = residual2;
    return out;
  }
  const double length = std::sqrt(frame.along2), height = std::sqrt(frame.across2);
  const double px = t * length, py = h * height;
  const std::array<double, 3> corner_x{0.0, length, foot * length}, corner_y{0.0, 0.0, height};
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const double ex = corner_x[next] - corner_x[k], ey = corner_y[next] - corner_y[k];
    const double e2 = ex * ex + ey * ey;
    const double s = e2 > 0.0 ? std::clamp(((px - corner_x[k]) * ex + (py - corner_y[k]) * ey) / e2, 0.0, 1.0) : 0.0;
    const double dx = px - corner_x[k] - s * ex, dy = py - corner_y[k] - s * ey;
    const double distance2 = dx * dx + dy * dy;
    if (distance2 >= best) continue;
    best = distance2;
    out.weight = {};
    out.weight[(first + k) % 3] = 1.0 - s;
    out.weight[(first + next) % 3] = s;
  }
  out.distance2 = residual2 + best;
  return out;
}

template <std::size_t N>
FlatNearest nearest_on_flat(const Row<N>& x, const Corners<N>& corners,
                            double enough = std::numeric_limits<double>::infinity()) {
  const Frame<N> frame = frame_of<N>(corners);
  return nearest_on_flat<N>(minus(x, corners[frame.first]), frame, enough);
}

template <std::size_t N>
Vec3d normal_of(const Row<N>& row, std::uint32_t at) {
  return {row[at], row[at + 1], row[at + 2]};
}

template <std::size_t N>
void put_normal(Row<N>& row, std::uint32_t at, const Vec3d& n) {
  for (int k = 0; k < 3; ++k) row[at + static_cast<std::uint32_t>(k)] = n[k];
}

}  // namespace product

/// A bounding volume hierarchy over boxes of all coordinates, of a fixed shape (median splits along the longest axis of
/// the centres).
template <std::size_t N>
class ProductTree {
 public:
  using Row = product::Row<N>;
  using Corners = product::Corners<N>;
  struct Nearest {
    double distance2 = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = kNoId;
  };

  /// Of more triangles frames are made whenever they are looked at: the same distances. They take 160 bytes each and
  /// more.
  static constexpr std::uint32_t kMostFrames = 1U << 17U;

  ProductTree(std::vector<ProductPoint<N>> vertices, const std::vector<std::array<std::uint32_t, 3>>& triangles,
              const ProductLayout& layout, std::uint32_t most_frames = kMostFrames)
      : layout_(layout) {
    vertices_ = std::move(vertices);
    const auto count = static_cast<std::uint32_t>(triangles.size());
    if (count == 0) return;
    std::vector<Box> boxes(count);
    order_.resize(count);
    known_.resize(count);
    corners_ = triangles;
    for (std::uint32_t i = 0; i < count; ++i) {
      order_[i] = i;
      known_[i] = layout_.all_known();
      for (const std::uint32_t v : corners_[i]) known_[i] &= vertices_[v].known;
      boxes[i] = box_of(corners_of(i, known_[i]), known_[i]);
    }
    if (count <= most_frames) {
      frames_.reserve(count);
      for (std::uint32_t i = 0; i < count; ++i) {
        frames_.push_back(product::frame_of<N>(corners_of(i, known_[i])));
      }
    }
    nodes_.reserve(count + 1);
    nodes_.emplace_back();
    split(0, boxes, 0, count);
    for (std::size_t n = nodes_.size(); n-- > 0;) {  // children lie behind their node
      Node& node = nodes_[n];
      if (node.count == 0) {
        node.box = nodes_[node.first].box;
        grow(node.box, nodes_[node.first + 1].box);
        continue;
      }
      node.box = boxes[order_[node.first]];
      for (std::uint32_t i = node.first + 1; i < node.first + node.count; ++i) grow(node.box, boxes[order_[i]]);
    }
  }

  /// The nearest triangle. Safe from several threads, as is what follows.
  [[nodiscard]] Nearest nearest(const ProductPoint<N>& point) const { return search(point, Nearest()); }
  /// Some triangle that is nearer than a squared distance, or kNoId and that distance. `hint` names one that probably
  /// is; it may be kNoId.
  [[nodiscard]] Nearest any_within(double distance2, const ProductPoint<N>& point, std::uint32_t hint) const {
    return search(point, {distance2, kNoId}, true, hint);
  }

  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  /// Triangles that are near each other one after another.
  [[nodiscard]] const std::vector<std::uint32_t>& triangles_in_order() const { return order_; }

 private:
  struct Box {
    Row low, high;
  };
  struct Node {
    Box box;
    std::uint32_t first = 0, count = 0;  ///< as of TriangleTree
  };

  /// The nearest triangle that is nearer than `best`, or any.
  [[nodiscard]] Nearest search(const ProductPoint<N>& point, Nearest best, bool is_any_enough = false,
                               std::uint32_t hint = kNoId) const {
    if (nodes_.empty()) return best;
    const bool knows_all = point.known == layout_.all_known();
    const auto try_triangle = [&](std::uint32_t i) {
      const std::uint32_t known = known_[i] & point.known;
      double distance2 = 0.0;
      if (known == known_[i] && !frames_.empty()) {
        const product::Frame<N>& frame = frames_[i];
        Row v = product::minus<N>(point.x, vertices_[corners_[i][frame.first]].x);
        if (known != layout_.all_known()) forget(v, known);
        distance2 = product::nearest_on_flat<N>(v, frame, best.distance2).distance2;
      } else {
        Row x = point.x;
        forget(x, known);
        distance2 = product::nearest_on_flat<N>(x, corners_of(i, known), best.distance2).distance2;
      }
      if (distance2 < best.distance2) best = {distance2, i};
    };
    if (hint < corners_.size()) try_triangle(hint);
    struct Entry {
      std::uint32_t node;
      double distance2;
    };
    std::array<Entry, 64> stack;  // median splits: the depth is below 32
    std::size_t size = 0;
    const auto distance2_of = [&](std::uint32_t node) {
      return knows_all ? distance2_to_box(nodes_[node].box, point.x)
                       : distance2_to_box(nodes_[node].box, point.x, point.known);
    };
    stack[size++] = {0, distance2_of(0)};
    while (size > 0) {
      if (is_any_enough && best.triangle != kNoId) return best;
      const Entry entry = stack[--size];
      if (entry.distance2 >= best.distance2) continue;
      const Node& node = nodes_[entry.node];
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) try_triangle(order_[i]);
        continue;
      }
      Entry near{node.first, distance2_of(node.first)};
      Entry far{node.first + 1, distance2_of(node.first + 1)};
      if (far.distance2 < near.distance2) std::swap(near, far);
      if (far.distance2 < best.distance2) stack[size++] = far;
      if (near.distance2 < best.distance2) stack[size++] = near;
    }
    return best;
  }

  [[nodiscard]] bool knows_normal(std::uint32_t known) const {
    return layout_.has_normal && (known >> layout_.uv_sets & 1U) != 0;
  }

  /// Coordinates that are not known become 0 in place.
  void forget(Row& row, std::uint32_t known) const {
    for (std::uint32_t k = 0; k < layout_.uv_sets; ++k) {
      if ((known >> k & 1U) == 0) row[3 + 2 * k] = row[4 + 2 * k] = 0.0;
    }
    if (layout_.has_normal && !knows_normal(known)) product::put_normal<N>(row, layout_.normal_at(), Vec3d(0.0));
  }

  [[nodiscard]] Corners corners_of(std::uint32_t triangle, std::uint32_t known) const {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = vertices_[corners_[triangle][k]].x;
      forget(corners[k], known);
    }
    return corners;
  }

  /// Unbounded in what is not known.
  [[nodiscard]] Box box_of(const Corners& corners, std::uint32_t known) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Box box{corners[0], corners[0]};
    for (std::size_t c = 1; c < 3; ++c) {
      for (std::size_t k = 0; k < N; ++k) {
        box.low[k] = std::min(box.low[k], corners[c][k]);
        box.high[k] = std::max(box.high[k], corners[c][k]);
      }
    }
    for (std::uint32_t k = 0; k < layout_.uv_sets; ++k) {
      if ((known >> k & 1U) != 0) continue;
      box.low[3 + 2 * k] = box.low[4 + 2 * k] = -kInfinity;
      box.high[3 + 2 * k] = box.high[4 + 2 * k] = kInfinity;
    }
    if (!layout_.has_normal || knows_normal(known)) return box;
    for (std::uint32_t k = layout_.normal_at(); k < layout_.size(); ++k) {
      box.low[k] = -kInfinity;
      box.high[k] = kInfinity;
    }
    return box;
  }

  static void grow(Box& box, const Box& other) {
    for (std::size_t k = 0; k < N; ++k) {
      box.low[k] = std::min(box.low[k], other.low[k]);
      box.high[k] = std::max(box.high[k], other.high[k]);
    }
  }

  static double distance2_to_box(const Box& box, const Row& x) {
    double sum = 0.0;
    for (std::size_t k = 0; k < N; ++k) {
      const double d = std::max(std::max(box.low[k] - x[k], x[k] - box.high[k]), 0.0);
      sum += d * d;
    }
    return sum;
  }

  double distance2_to_box(const Box& box, const Row& x, std::uint32_t known) const {
    const auto along = [&](std::uint32_t k) {
      const double d = std::max(std::max(box.low[k] - x[k], x[k] - box.high[k]), 0.0);
      return d * d;
    };
    double sum = along(0) + along(1) + along(2);
    for (std::uint32_t k = 0; k < layout_.uv_sets; ++k) {
      if ((known >> k & 1U) != 0) sum += along(3 + 2 * k) + along(4 + 2 * k);
    }
    if (knows_normal(known)) {
      for (std::uint32_t k = layout_.normal_at(); k < layout_.size(); ++k) sum += along(k);
    }
    return sum;
  }

  void split(std::uint32_t node, const std::vector<Box>& boxes, std::uint32_t first, std::uint32_t count) {
    if (count <= product::kLeafSize) {
      nodes_[node].first = first;
      nodes_[node].count = count;
      return;
    }
    const auto center = [&](std::uint32_t triangle, std::size_t k) {
      const Box& box = boxes[triangle];
      return std::isfinite(box.low[k]) ? 0.5 * box.low[k] + 0.5 * box.high[k] : 0.0;
    };
    Row low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (std::uint32_t i = first; i < first + count; ++i) {
      for (std::size_t k = 0; k < N; ++k) {
        const double at = center(order_[i], k);
        low[k] = std::min(low[k], at);
        high[k] = std::max(high[k], at);
      }
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < N; ++k) {
      if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    }
    const std::uint32_t half = count / 2;
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
      const double x = center(a, axis), y = center(b, axis);
      return x != y ? x < y : a < b;
    });
    const auto left = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node].first = left;
    nodes_.resize(nodes_.size() + 2);
    split(left, boxes, first, half);  // depth: log2 of the number of triangles
    split(left + 1, boxes, first + half, count - half);
  }

  ProductLayout layout_;
  std::vector<ProductPoint<N>> vertices_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<product::Frame<N>> frames_;  ///< of triangles, in what they know; none where they are many
  std::vector<std::uint32_t> known_;       ///< of a triangle: what all corners know
  std::vector<std::uint32_t> order_;       ///< leaf order -> triangle
  std::vector<Node> nodes_;
};

}  // namespace meshlode::judge
