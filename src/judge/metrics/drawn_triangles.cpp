// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/drawn_triangles.h"

#include <algorithm>
#include <compare>
#include <cstddef>
#include <deque>
#include <map>

#include "base/parallel.h"
#include "judge/metrics/triangle_area.h"

namespace meshlode::judge {

namespace {

/// A point, ordered by x, y, z: along any line that is the line's own order, one way or the other.
struct Point {
  double x, y, z;
  auto operator<=>(const Point&) const = default;
};

Point as_point(const Vec3d& p) {
  return {p.x + 0.0, p.y + 0.0, p.z + 0.0};
}

struct Segment {
  Point low, high;
  auto operator<=>(const Segment&) const = default;
};

/// A triangle on a line: the whole of it, and its two parts.
struct Strand {
  std::size_t triangle;
  Segment whole, lower, upper;
};

Strand make_strand(std::size_t triangle, const std::array<Vec3d, 3>& corners) {
  std::array<Point, 3> p{as_point(corners[0]), as_point(corners[1]), as_point(corners[2])};
  std::sort(p.begin(), p.end(), [](const Point& a, const Point& b) { return (a <=> b) < 0; });
  return {triangle, {p[0], p[2]}, {p[0], p[1]}, {p[1], p[2]}};
}

struct SegmentUse {
  bool is_covered = false;
  std::vector<std::size_t> strands;
};

struct SegmentOrder {
  bool operator()(const Segment& a, const Segment& b) const { return (a <=> b) < 0; }
};

}  // namespace

std::vector<std::uint8_t> find_drawn(const TriangleCorners& triangles) {
  std::vector<std::uint8_t> is_drawn(triangles.size());
  parallel_for_each_index(triangles.size(), 4096, [&](std::size_t t) {
    const auto [a, b, c] = triangles[t];
    is_drawn[t] = has_area(a, b, c) ? 1 : 0;
  });
  std::vector<Strand> strands;
  std::map<Segment, SegmentUse, SegmentOrder> uses;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = triangles[t];
    if (is_drawn[t] != 0 || a == b || b == c || c == a) continue;
    strands.push_back(make_strand(t, triangles[t]));
    for (const Segment& s : {strands.back().whole, strands.back().lower, strands.back().upper}) {
      uses[s].strands.push_back(strands.size() - 1);
    }
  }
  if (strands.empty()) return is_drawn;

  std::deque<const SegmentUse*> covered;
  const auto cover = [&](const Segment& segment) {
    const auto found = uses.find(segment);
    if (found == uses.end() || found->second.is_covered) return;
    found->second.is_covered = true;
    covered.push_back(&found->second);
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (is_drawn[t] == 0) continue;
    const TriangleCorners::Corners corners = triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Point from = as_point(corners[k]), to = as_point(corners[(k + 1) % 3]);
      cover(from < to ? Segment{from, to} : Segment{to, from});
    }
  }
  for (; !covered.empty(); covered.pop_front()) {
    for (const std::size_t i : covered.front()->strands) {
      const Strand& strand = strands[i];
      if (uses.at(strand.whole).is_covered) {
        cover(strand.lower);
        cover(strand.upper);
      } else if (uses.at(strand.lower).is_covered && uses.at(strand.upper).is_covered) {
        cover(strand.whole);
      }
    }
  }
  for (const Strand& strand : strands) is_drawn[strand.triangle] = uses.at(strand.whole).is_covered ? 1 : 0;
  return is_drawn;
}

}  // namespace meshlode::judge
