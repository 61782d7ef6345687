// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes that are seen as a whole and not piece by piece: a crown of leaves, a field of grass, a cloud of crumbs.
#include <cmath>

#include "base/random.h"
#include "lab/samples/facets.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::lab {

using namespace scene;

namespace {

/// Evenly from all directions.
Vec3d random_direction(SplitMix64& random) {
  const double height = random.between(-1.0, 1.0), turn = random.unit();
  const double out = std::sqrt(1.0 - height * height);
  return {out * cos_turns(turn), height, out * sin_turns(turn)};
}

void add_card(const Vec3d& low, const Vec3d& side, const Vec3d& up, Primitive& out) {
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  const Vec3f normal(unit(glm::cross(side, up)));
  const Vec3d corners[4] = {low - side, low + side, low + side + up, low - side + up};
  for (int c = 0; c < 4; ++c) {
    out.positions.push_back(corners[c]);
    out.normals.push_back(normal);
    out.uvs[0].emplace_back(c == 1 || c == 2 ? 1.0F : 0.0F, c < 2 ? 1.0F : 0.0F);
  }
  add_quad(out.indices, first, first + 1, first + 2, first + 3);
}

}  // namespace

Primitive make_crown(std::uint32_t count, std::uint64_t seed) {
  // Leaves in forty balls of twigs, denser towards each ball's surface, as light makes them grow.
  constexpr std::uint32_t kBalls = 40;
  Primitive out;
  SplitMix64 random(seed);
  std::vector<Vec3d> centers;
  for (std::uint32_t b = 0; b < kBalls; ++b) {
    const Vec3d d = random_direction(random) * std::sqrt(random.unit());
    centers.emplace_back(0.75 * d.x, 1.0 + 0.6 * d.y, 0.75 * d.z);
  }
  for (std::uint32_t k = 0; k < count; ++k) {
    const Vec3d& center = centers[static_cast<std::size_t>(random.unit() * kBalls)];
    const double radius = 0.3 * std::sqrt(std::sqrt(random.unit()));
    const Vec3d at = center + random_direction(random) * radius;
    const Vec3d up = unit(random_direction(random) + Vec3d(0.0, 0.4, 0.0));
    const Vec3d other = random_direction(random);
    const Vec3d side = unit(glm::cross(up, other) + up * 1e-9 + Vec3d(1e-9, 0.0, 0.0));
    const double size = random.between(0.012, 0.024);
    add_card(at, side * (0.5 * size), glm::cross(glm::cross(side, up), side) * size, out);
  }
  return out;
}

Primitive make_grass(std::uint32_t blades, std::uint64_t seed) {
  Primitive out;
  SplitMix64 random(seed);
  for (std::uint32_t k = 0; k < blades; ++k) {
    const double x = random.between(-1.0, 1.0), z = random.between(-1.0, 1.0), turn = random.unit();
    const Vec3d side(cos_turns(turn), 0.0, sin_turns(turn));
    const Vec3d up = unit(Vec3d(random.between(-0.4, 0.4), 1.0, random.between(-0.4, 0.4)));
    add_card({x, 0.0, z}, side * random.between(0.002, 0.004), up * random.between(0.04, 0.1), out);
  }
  out.normals.clear();
  out.uvs[0].clear();
  return out;
}

std::vector<std::string> aggregate_kinds() {
  return {"hedge", "ivy", "pads", "clumps", "conifer", "blades", "splinters", "fence"};
}

Primitive make_aggregate_kind(const std::string& kind, std::uint32_t count, std::uint64_t seed) {
  Primitive out;
  SplitMix64 random(seed);
  Vec3d clump(0.0);
  const auto add_square = [&](const Vec3d& center, const Vec3d& normal, double half_width, double half_height) {
    const Vec3d side = unit(glm::cross(normal, random_direction(random)) + Vec3d(1e-9, 0.0, 0.0));
    const Vec3d up = glm::cross(normal, side) * half_height;
    add_card(center - up, side * half_width, 2.0 * up, out);
  };
  const auto add_triangle = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    out.positions.insert(out.positions.end(), {a, b, c});
    out.indices.insert(out.indices.end(), {first, first + 1, first + 2});
  };
  for (std::uint32_t k = 0; k < count; ++k) {
    // One number after the other: arguments of a call are worked out in any order.
    const Vec3d at{random.signed_unit(), random.signed_unit(), random.signed_unit()};
    const Vec3d one = random_direction(random), other = random_direction(random);
    const Vec3d around = unit(one * Vec3d(1.0, 0.0, 1.0) + Vec3d(1e-6, 0.0, 0.0));
    if (kind == "hedge") {
      add_square(at * Vec3d(5.0, 0.5, 0.4), one, 0.06, 0.06);
    } else if (kind == "ivy") {
      add_square(at * Vec3d(2.0, 2.0, 0.05), unit(0.4 * one + Vec3d(0.0, 0.2, 1.0)), 0.05, 0.05);
    } else if (kind == "pads") {
      add_square(at * Vec3d(3.0, 0.04, 3.0), unit(0.1 * one + Vec3d(0.0, 1.0, 0.0)), 0.05, 0.05);
    } else if (kind == "clumps") {
      if (k % 100 == 0) clump = other;
      add_square(clump + 0.15 * at, one, 0.02, 0.02);
    } else if (kind == "conifer") {
      const double height = 0.5 + 0.5 * at.y;
      add_square(around * (0.6 * (1.0 - height) * std::fabs(at.x)) + Vec3d(0.0, 2.0 * height, 0.0), other, 0.05, 0.006);
    } else if (kind == "blades") {
      const Vec3d foot = at * Vec3d(2.0, 0.0, 2.0), side = 0.01 * around;
      add_triangle(foot - side, foot + side, foot + Vec3d(0.0, 0.2 + 0.1 * at.y, 0.0) + 2.0 * side);
    } else if (kind == "splinters") {
      add_triangle(at, at + 0.05 * one, at + 0.05 * other);
    } else {  // fence
      add_square(at * Vec3d(3.0, 0.0, 3.0), around, 0.05, 0.2);
    }
  }
  out.normals.clear();
  out.uvs[0].clear();
  return out;
}

}  // namespace meshlode::lab
