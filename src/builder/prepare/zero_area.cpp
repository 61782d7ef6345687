// SPDX-License-Identifier: GPL-3.0-or-later
// Collinearity by a filter in doubles and, where that cannot tell, in whole numbers of any length
// (Boost.Multiprecision; the one file of this room that sees Boost).
#include "builder/prepare/zero_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

#include <boost/multiprecision/cpp_int.hpp>

#include "base/ids.h"
#include "base/parallel.h"

namespace meshlode::builder {

namespace {

using boost::multiprecision::cpp_int;

/// Each component of the cross product is a difference of two products of differences: four roundings of 2^-53 of what
/// is added, at most, as long as nothing underflows. Twice that and more.
constexpr double kFilter = 1e-15;
constexpr double kSmallestProduct = 1e-280;

bool is_clearly_apart(double left, double right) {
  const double size = std::fabs(left) + std::fabs(right);
  return size > kSmallestProduct && std::fabs(left - right) > kFilter * size;
}

/// x · 2^-exponent. \pre its 53 bits end at 2^exponent or above
cpp_int whole(double x, int exponent) {
  if (x == 0.0) return 0;
  int e = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &e), 53));
  return cpp_int(mantissa) << (e - 53 - exponent);
}

bool are_exactly_collinear(const std::array<Vec3d, 3>& corners) {
  int exponent = std::numeric_limits<int>::max();
  for (const Vec3d& p : corners) {
    for (int axis = 0; axis < 3; ++axis) {
      int e = 0;
      (void)std::frexp(p[axis], &e);
      if (p[axis] != 0.0) exponent = std::min(exponent, e - 53);
    }
  }
  std::array<cpp_int, 3> u, v;
  for (int axis = 0; axis < 3; ++axis) {
    const cpp_int from = whole(corners[0][axis], exponent);
    u[static_cast<std::size_t>(axis)] = whole(corners[1][axis], exponent) - from;
    v[static_cast<std::size_t>(axis)] = whole(corners[2][axis], exponent) - from;
  }
  return u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0];
}

auto tuple_of(const Vec3d& p) {
  return std::tuple(p.x, p.y, p.z);
}

/// Triangles on a line, by the numbers of their corners. Numbers ascend by x, y, z, and so along every line: the middle
/// number is the middle corner, and the two others end the longest edge.
class Lines {
 public:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  Lines(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles,
        const std::vector<std::uint32_t>& on_line)
      : positions_(positions), triangles_(triangles) {
    for (const std::uint32_t t : on_line) {
      for (std::size_t k = 0; k < 3; ++k) points_.push_back(positions[triangles[3 * std::size_t{t} + k]]);
    }
    const auto before = [](const Vec3d& a, const Vec3d& b) { return tuple_of(a) < tuple_of(b); };
    std::sort(points_.begin(), points_.end(), before);
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    for (const std::uint32_t t : on_line) {
      std::array<std::uint32_t, 3> corner{};
      for (std::size_t k = 0; k < 3; ++k) corner[k] = number_of(triangles[3 * std::size_t{t} + k]);
      std::sort(corner.begin(), corner.end());
      lines_.push_back({Edge{corner[0], corner[1]}, Edge{corner[1], corner[2]}, Edge{corner[0], corner[2]}});
      for (const Edge& edge : lines_.back()) edges_.push_back(edge);
    }
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    is_covered_.assign(edges_.size(), 0);
    for (std::uint32_t i = 0; i < lines_.size(); ++i) {
      for (const Edge& edge : lines_[i]) users_.emplace_back(id_of(edge), i);
    }
    std::sort(users_.begin(), users_.end());
  }

  /// A triangle with area.
  void cover_edges_of(std::uint32_t triangle) {
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) corner[k] = number_of(triangles_[3 * std::size_t{triangle} + k]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge edge = std::minmax({corner[k], corner[(k + 1) % 3]});
      if (edge.second == kNoId) continue;
      const std::uint32_t id = id_of(edge);
      if (id != kNoId) cover(id);
    }
  }

  void spread() {
    while (!to_visit_.empty()) {
      const std::uint32_t edge = to_visit_.back();
      to_visit_.pop_back();
      const auto first = std::lower_bound(users_.begin(), users_.end(), std::pair(edge, 0U));
      for (auto user = first; user != users_.end() && user->first == edge; ++user) {
        const auto& line = lines_[user->second];
        const std::array<std::uint32_t, 3> id{id_of(line[0]), id_of(line[1]), id_of(line[2])};
        if (is_covered_[id[2]] != 0) {
          cover(id[0]);
          cover(id[1]);
        } else if (is_covered_[id[0]] != 0 && is_covered_[id[1]] != 0) {
          cover(id[2]);
        }
      }
    }
  }

  /// Of the i-th triangle on a line.
  [[nodiscard]] bool is_covered(std::size_t i) const { return is_covered_[id_of(lines_[i][2])] != 0; }

 private:
  void cover(std::uint32_t id) {
    if (is_covered_[id] != 0) return;
    is_covered_[id] = 1;
    to_visit_.push_back(id);
  }
  [[nodiscard]] std::uint32_t number_of(std::uint32_t vertex) const {
    const Vec3d& p = positions_[vertex];
    const auto found = std::lower_bound(points_.begin(), points_.end(), p,
                                        [](const Vec3d& a, const Vec3d& b) { return tuple_of(a) < tuple_of(b); });
    return found != points_.end() && *found == p ? static_cast<std::uint32_t>(found - points_.begin()) : kNoId;
  }
  [[nodiscard]] std::uint32_t id_of(const Edge& edge) const {
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge);
    return found != edges_.end() && *found == edge ? static_cast<std::uint32_t>(found - edges_.begin()) : kNoId;
  }

  std::span<const Vec3d> positions_;
  std::span<const std::uint32_t> triangles_;
  std::vector<Vec3d> points_;               ///< corners of the triangles on a line, ascending
  std::vector<std::array<Edge, 3>> lines_;  ///< per triangle on a line: two short edges, the long one
  std::vector<Edge> edges_;                 ///< of them, ascending
  std::vector<std::pair<std::uint32_t, std::uint32_t>> users_;  ///< edge, triangle on a line
  std::vector<std::uint8_t> is_covered_;                        ///< per edge
  std::vector<std::uint32_t> to_visit_;                         ///< edges covered since
};

enum class Shape : std::uint8_t { kArea, kLine, kRepeatedCorner };

}  // namespace

bool are_collinear(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a;
  if (is_clearly_apart(ab.y * ac.z, ab.z * ac.y) || is_clearly_apart(ab.z * ac.x, ab.x * ac.z) ||
      is_clearly_apart(ab.x * ac.y, ab.y * ac.x)) {
    return false;
  }
  return are_exactly_collinear({a, b, c});
}

std::vector<std::uint8_t> find_undrawn(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles) {
  const std::size_t count = triangles.size() / 3;
  std::vector<Shape> shapes(count);
  parallel_for_each_index(count, 4096, [&](std::size_t t) {
    const Vec3d& a = positions[triangles[3 * t]];
    const Vec3d& b = positions[triangles[3 * t + 1]];
    const Vec3d& c = positions[triangles[3 * t + 2]];
    shapes[t] = a == b || b == c || c == a ? Shape::kRepeatedCorner
                : are_collinear(a, b, c)   ? Shape::kLine
                                           : Shape::kArea;
  });
  std::vector<std::uint8_t> is_undrawn(count);
  std::vector<std::uint32_t> on_line;
  for (std::uint32_t t = 0; t < count; ++t) {
    is_undrawn[t] = shapes[t] == Shape::kRepeatedCorner ? 1 : 0;
    if (shapes[t] == Shape::kLine) on_line.push_back(t);
  }
  if (on_line.empty()) return is_undrawn;
  Lines lines(positions, triangles, on_line);
  for (std::uint32_t t = 0; t < count; ++t) {
    if (shapes[t] == Shape::kArea) lines.cover_edges_of(t);
  }
  lines.spread();
  for (std::size_t i = 0; i < on_line.size(); ++i) is_undrawn[on_line[i]] = lines.is_covered(i) ? 0 : 1;
  return is_undrawn;
}

}  // namespace meshlode::builder
