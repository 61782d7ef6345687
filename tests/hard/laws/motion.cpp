// SPDX-License-Identifier: GPL-3.0-or-later
// Translation and scale. The grid's lattice goes through zero and its step is a power of two, so that a source moved by
// whole steps or scaled by a power of two comes to the same integers (docs/explanation/numerics.md), as long as the
// source's own coordinates can be moved without rounding.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "laws/outcomes.h"
#include "laws/same_mesh.h"
#include "run/decode/decode.h"

namespace meshlode::test::hard {

namespace {

/// How many bits a coordinate may have from the largest one's first on, so that sums and triples stay exact.
constexpr int kBits = 44;

bool has_one_mesh(const Built& base) {
  return base.asset->meshes().size() == 1 && base.asset->meshes()[0].cluster_count > 0;
}

double largest_coordinate(const Sample& sample) {
  double largest = 0.0;
  for (const scene::Primitive& primitive : sample.scene.meshes[0].primitives) {
    for (const Vec3d& p : primitive.positions) {
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  return largest;
}

/// Every coordinate to a multiple of 2^exponent.
void snap(Sample& sample, int exponent) {
  const double unit = std::ldexp(1.0, exponent);
  for (scene::Primitive& primitive : sample.scene.meshes[0].primitives) {
    for (Vec3d& p : primitive.positions) {
      for (int axis = 0; axis < 3; ++axis) p[axis] = std::floor(p[axis] / unit + 0.5) * unit;
    }
  }
}

void map_positions(Sample& sample, auto&& map) {
  for (scene::Primitive& primitive : sample.scene.meshes[0].primitives) {
    for (Vec3d& p : primitive.positions) p = map(p);
  }
}

/// The base with coordinates that can be moved exactly by less than 2^10 times the largest one, built; or why not.
Result<Built> snapped(const Built& base, double further) {
  const format::Grid grid = base.asset->meshes()[0].grid;
  int exponent = 0;
  std::frexp(largest_coordinate(base.sample) + further, &exponent);
  if (exponent - kBits > grid.log2 - 1) {
    return Error{ErrorCode::kUnsupported, "", "the source's coordinates are coarser than the grid"};
  }
  if (exponent - kBits < -1000 || exponent > 900) return Error{ErrorCode::kUnsupported, "", "too near to the limits"};
  Sample sample = base.sample;
  snap(sample, exponent - kBits);
  return build_sample(std::move(sample));
}

LawResult compare(const Built& first, Sample changed, const Change& change) {
  const Result<Built> other = build_sample(std::move(changed));
  if (!other) return broken("refused: " + other.error().message());
  const Comparison compared = compare_meshes(*first.asset, MeshId(0U), *other->asset, MeshId(0U), change);
  if (!compared.difference.empty()) {
    LawResult result = broken(compared.difference);
    result.share = compared.share;
    return result;
  }
  return kept(compared.share);
}

/// By how much a distance to a surface is too large at most where floats choose the triangle
/// (docs/explanation/numerics.md): for a distance d it is `absolute` + `relative` · d.
struct Missed {
  double absolute = 0.0;  ///< object units
  double relative = 0.0;
};

/// Of the triangles of source and asset: u (16 D + 48 (l + d) / s), l the longest edge and s twice the area over l², at
/// least the 1e-4 from which on a triangle's normal is trusted (src/builder/deviation/surface_tree.cpp).
std::optional<Missed> missed_by_choice(const Built& built) {
  constexpr double kLeastSine = 1e-4;
  double longest_over_sine = 0.0, least_sine = 1.0;
  const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d ab = b - a, ac = c - a, bc = c - b;
    const double longest2 = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
    if (!(longest2 > 0.0)) return;
    const double sine = std::max(glm::length(glm::cross(ab, ac)) / longest2, kLeastSine);
    least_sine = std::min(least_sine, sine);
    longest_over_sine = std::max(longest_over_sine, std::sqrt(longest2) / sine);
  };
  for (const scene::Primitive& primitive : built.sample.scene.meshes[0].primitives) {
    const auto at = [&](std::size_t i) { return primitive.positions[primitive.indices[i]]; };
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) add(at(i), at(i + 1), at(i + 2));
  }
  const auto decoded = run::decode_all(*built.asset);
  if (!decoded) return {};
  const format::MeshRecord& mesh = built.asset->meshes()[0];
  const double step = std::ldexp(mesh.grid.mantissa, mesh.grid.log2);
  for (const run::DecodedCluster& cluster : *decoded) {
    for (const auto& t : cluster.triangles) {
      add(Vec3d(cluster.position(t[0])) * step, Vec3d(cluster.position(t[1])) * step,
          Vec3d(cluster.position(t[2])) * step);
    }
  }
  constexpr double kUnit = 0x1p-24;
  return Missed{kUnit * (16.0 * mesh.diagonal + 48.0 * longest_over_sine), kUnit * 48.0 / least_sine};
}

}  // namespace

LawResult check_translated(const Built& base) {
  if (!has_one_mesh(base)) return not_asked("not one mesh");
  const format::Grid grid = base.asset->meshes()[0].grid;
  const double step = std::ldexp(grid.mantissa, grid.log2);
  const Vec3d shift = Vec3d(1000.0, -357.0, 42.0) * step;
  const Result<Built> first = snapped(base, 1000.0 * step);
  if (!first) return not_asked(first.error().detail);
  if (first->asset->meshes()[0].grid.log2 != grid.log2) return not_asked("snapping changed the grid");
  Sample moved = first->sample;
  map_positions(moved, [&](const Vec3d& p) { return p + shift; });
  Change change;
  change.shift = shift;
  return compare(*first, std::move(moved), change);
}

LawResult check_doubled(const Built& base) {
  if (!has_one_mesh(base)) return not_asked("not one mesh");
  constexpr int kLog2 = 7;
  const format::MeshRecord& mesh = base.asset->meshes()[0];
  // Where nothing is clamped: no error at its least, no grid or sphere at its limits.
  if (mesh.grid.log2 < -100 || mesh.grid.log2 + kLog2 > 90) return not_asked("too near to the limits of floats");
  Sample scaled = base.sample;
  map_positions(scaled, [&](const Vec3d& p) { return p * std::ldexp(1.0, kLog2); });
  Change change;
  change.log2 = kLog2;
  return compare(base, std::move(scaled), change);
}

LawResult check_tripled(const Built& base) {
  if (!has_one_mesh(base)) return not_asked("not one mesh");
  const format::MeshRecord& mesh = base.asset->meshes()[0];
  if (mesh.grid.log2 < -100 || mesh.grid.log2 > 90) return not_asked("too near to the limits of floats");
  // Three times the step is a step that is spelt exactly; the integers are those of the base on its own step then.
  Built on_step;
  {
    const Result<Built> first = snapped(base, 0.0);
    if (!first) return not_asked(first.error().detail);
    Sample sample = first->sample;
    sample.options.grid_step = std::ldexp(mesh.grid.mantissa, mesh.grid.log2);
    Result<Built> built = build_sample(std::move(sample));
    if (!built) return not_asked(built.error().detail);
    on_step = std::move(*built);
  }
  Sample tripled = on_step.sample;
  tripled.options.grid_step *= 3.0;
  map_positions(tripled, [](const Vec3d& p) { return p * 3.0; });
  Change change;
  change.factor = 3.0;
  // Each level rounds its error up to a float once (u = 2^-24, an ulp is 2u). Distances are those to a triangle that
  // floats have chosen: in both assets they are too large by at most what such a choice misses, and none is too small.
  const std::optional<Missed> missed = missed_by_choice(on_step);
  if (!missed) return broken("the base does not decode");
  change.tolerance = 2.0 * (on_step.asset->meshes()[0].level_count + 2.0) * 0x1p-23 + missed->relative;
  change.absolute = 3.0 * missed->absolute;
  return compare(on_step, std::move(tripled), change);
}

}  // namespace meshlode::test::hard
