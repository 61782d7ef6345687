// SPDX-License-Identifier: GPL-3.0-or-later
// A quarter turn and a mirror. Level 0 turns with the source: rounding to a lattice through zero commutes with both,
// but for coordinates in the middle between two points (floor(x + 1/2) rounds those up, whichever way the axis points).
// Nothing above level 0 does: clusters follow from METIS, which is given triangles in the Z-order of their grid points,
// and that order is another one in a turned frame. What is left there is another draw of the same kind, as by another
// seed; the invariants hold for it, and no closer bound is to be had.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "laws/outcomes.h"
#include "run/decode/decode.h"
#include "run/select/select.h"

namespace meshlode::test::hard {

namespace {

using Point = std::array<std::int64_t, 3>;
using Triangle = std::array<Point, 3>;

/// A coordinate's whole steps from zero: the lattice goes through it.
constexpr double kMostSteps = 0x1p50;

/// Level 0 as triangles over the lattice, each rotated to begin with its smallest corner, sorted. Nothing where the
/// mesh is too far away for whole steps.
std::optional<std::vector<Triangle>> level0_of(const run::Asset& asset, const std::function<Point(const Point&)>& map,
                                               bool is_turned_over) {
  const auto decoded = run::decode_all(asset);
  if (!decoded) return {};
  const format::MeshRecord& mesh = asset.meshes()[0];
  const double step = std::ldexp(mesh.grid.mantissa, mesh.grid.log2);
  Point origin{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double steps = mesh.origin[axis] / step;
    if (!(std::abs(steps) < kMostSteps)) return {};
    origin[axis] = static_cast<std::int64_t>(steps);
  }
  std::vector<Triangle> triangles;
  for (const ClusterId id : run::select_uniform(asset, MeshId(0U), -1.0).clusters) {
    const run::DecodedCluster& cluster = (*decoded)[id.value];
    for (const auto& corners : cluster.triangles) {
      Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3i q = cluster.position(corners[k]);
        triangle[k] = map({origin[0] + q.x, origin[1] + q.y, origin[2] + q.z});
      }
      if (is_turned_over) std::swap(triangle[1], triangle[2]);
      std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
      triangles.push_back(triangle);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

/// Why rounding to the lattice may be another one in another frame: a coordinate lies within rounding of the middle
/// between two points, or a vertex was moved on to keep a needle. Empty: it is the same in all.
std::string frame_dependence(const Built& base, const std::vector<Triangle>& level0) {
  const format::MeshRecord& mesh = base.asset->meshes()[0];
  const double step = std::ldexp(mesh.grid.mantissa, mesh.grid.log2);
  std::vector<Point> rounded;
  for (const scene::Primitive& primitive : base.sample.scene.meshes[0].primitives) {
    for (const std::uint32_t v : primitive.indices) {
      Point point{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double steps = primitive.positions[v][static_cast<int>(axis)] / step;
        if (!(std::abs(steps) < kMostSteps)) return "too far away for whole steps";
        const double beyond = std::abs(steps) - std::floor(std::abs(steps));
        if (!(std::abs(beyond - 0.5) > 1e-9 * std::max(1.0, std::abs(steps) * 0x1p-20))) {
          return "a coordinate is in the middle between two grid points";
        }
        point[axis] = static_cast<std::int64_t>(std::floor(steps + 0.5));
      }
      rounded.push_back(point);
    }
  }
  std::sort(rounded.begin(), rounded.end());
  for (const Triangle& triangle : level0) {
    for (const Point& corner : triangle) {
      if (!std::binary_search(rounded.begin(), rounded.end(), corner)) return "a needle was kept by moving its corner";
    }
  }
  return {};
}

/// Largest error that is not infinite.
double coarsest_error(const run::Asset& asset) {
  float largest = 0.0F;
  for (const format::GroupRecord& group : asset.groups()) {
    if (group.error < format::kInfiniteError) largest = std::max(largest, group.error);
  }
  return double{largest};
}

LawResult compare_turned(const Built& base, const std::function<Vec3d(const Vec3d&)>& turn,
                         const std::function<Point(const Point&)>& turn_steps, bool is_turned_over) {
  if (base.asset->meshes().size() != 1 || base.asset->meshes()[0].cluster_count == 0) return not_asked("not one mesh");
  const auto same = [](const Point& p) { return p; };
  const auto own = level0_of(*base.asset, same, false);
  if (!own) return not_asked("too far away for whole steps");
  if (std::string why = frame_dependence(base, *own); !why.empty()) return not_asked(std::move(why));
  Sample sample = base.sample;
  for (scene::Primitive& primitive : sample.scene.meshes[0].primitives) {
    for (Vec3d& p : primitive.positions) p = turn(p);
    for (Vec3f& n : primitive.normals) n = Vec3f(turn(Vec3d(n)));
    for (std::size_t t = 0; is_turned_over && t + 2 < primitive.indices.size(); t += 3) {
      std::swap(primitive.indices[t + 1], primitive.indices[t + 2]);
    }
  }
  const Result<Built> other = build_sample(std::move(sample));
  if (!other) return broken("refused: " + other.error().message());
  const auto expected = level0_of(*base.asset, turn_steps, is_turned_over);
  const auto found = level0_of(*other->asset, same, false);
  if (!expected || !found) return not_asked("too far away for whole steps");
  if (base.asset->meshes()[0].grid.log2 != other->asset->meshes()[0].grid.log2) return broken("another grid");
  if (*expected != *found) {
    std::vector<Triangle> missing;
    std::set_difference(expected->begin(), expected->end(), found->begin(), found->end(), std::back_inserter(missing));
    return broken("level 0 differs in " + std::to_string(missing.size()) + " of " + std::to_string(expected->size()) +
                  " triangles");
  }
  LawResult result = kept();
  const double before = coarsest_error(*base.asset), after = coarsest_error(*other->asset);
  if (before > 0.0 && after > 0.0 && before != after) {
    char text[80];
    std::snprintf(text, sizeof text, "level 0 exact; the coarsest error is %.2f times", after / before);
    result.detail = text;
  }
  return result;
}

}  // namespace

LawResult check_quarter_turn(const Built& base) {
  return compare_turned(
      base, [](const Vec3d& p) { return Vec3d(-p.y, p.x, p.z); },
      [](const Point& p) {
        return Point{-p[1], p[0], p[2]};
      },
      false);
}

LawResult check_mirrored(const Built& base) {
  return compare_turned(
      base, [](const Vec3d& p) { return Vec3d(-p.x, p.y, p.z); },
      [](const Point& p) {
        return Point{-p[0], p[1], p[2]};
      },
      true);
}

}  // namespace meshlode::test::hard
