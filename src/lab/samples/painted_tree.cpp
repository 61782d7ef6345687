// SPDX-License-Identifier: GPL-3.0-or-later
// A tree of trunk, limbs and leaves: bark whose texture runs along the wood with a seam, and cards that show one
// picture each. What it is for is drift of textures and normals, which shapes without a picture do not show.
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "lab/samples/facets.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::lab {

using namespace scene;

namespace {

struct Limb {
  Vec3d from{0.0}, to{0.0}, bend{0.0};  ///< of its axis; `bend` is added in the middle
  double radius_from = 0.0, radius_to = 0.0;
  [[nodiscard]] Vec3d at(double t) const { return from + (to - from) * t + bend * (4.0 * t * (1.0 - t)); }
};

/// The trunk first.
std::vector<Limb> make_limbs(std::uint64_t seed) {
  SplitMix64 random(seed);
  std::vector<Limb> limbs{{Vec3d(0.0), Vec3d(0.1, 2.4, -0.05), Vec3d(0.08, 0.0, 0.05), 0.2, 0.07}};
  constexpr int kLimbs = 9;
  for (int k = 0; k < kLimbs; ++k) {
    const double t = 0.45 + 0.5 * k / (kLimbs - 1), turn = 0.382 * k + random.between(-0.05, 0.05);
    const double length = random.between(0.7, 1.1) * (1.2 - 0.6 * t);
    const Vec3d out(cos_turns(turn), random.between(0.35, 0.7), sin_turns(turn));
    const Vec3d from = limbs[0].at(t);
    const double bend_up = random.between(0.02, 0.1);
    limbs.push_back({from, from + unit(out) * length, Vec3d(0.0, bend_up, 0.0), 0.055 * (1.3 - t) + 0.015, 0.012});
  }
  return limbs;
}

double bark_relief(const Limb& limb, double turn, double t, std::uint64_t seed) {
  const double length = std::sqrt(glm::dot(limb.to - limb.from, limb.to - limb.from));
  const Vec3d at(1.2 * cos_turns(turn), 1.2 * sin_turns(turn), 2.5 * length * t);
  const double furrow = sin_turns(9.0 * turn + 0.6 * value_noise(at, seed + 1));
  return 1.0 + 0.05 * furrow + 0.1 * fractal_noise(at, 3, seed + 2);
}

void add_limb(const Limb& limb, std::uint32_t around, std::uint64_t seed, Primitive& out) {
  const Vec3d d = unit(limb.to - limb.from);
  const Vec3d side = unit(glm::cross(d, d.y > 0.9 ? Vec3d(0.0, 0.0, 1.0) : Vec3d(0.0, 1.0, 0.0)));
  const Vec3d front = glm::cross(d, side);
  const double length = std::sqrt(glm::dot(limb.to - limb.from, limb.to - limb.from));
  const double mean_radius = 0.5 * (limb.radius_from + limb.radius_to);
  const double cell = 6.283185307179586 * mean_radius / around;  // about square
  const auto along = static_cast<std::uint32_t>(std::floor(length / cell)) + 1;
  const auto point = [&](double turn, double t) {
    const double radius =
        (limb.radius_from + (limb.radius_to - limb.radius_from) * t) * bark_relief(limb, turn, t, seed);
    return limb.at(t) + (side * cos_turns(turn) + front * sin_turns(turn)) * radius;
  };
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  // The picture goes once around the middle of the limb, and as far along it: its texels are square there.
  const double pictures = length / (6.283185307179586 * mean_radius);
  for (std::uint32_t i = 0; i <= along; ++i) {
    for (std::uint32_t j = 0; j <= around; ++j) {
      const double t = static_cast<double>(i) / along, turn = static_cast<double>(j % around) / around;
      const double e = 1e-3;
      const Vec3d across = point(turn + e, t) - point(turn - e, t);
      const Vec3d up = point(turn, t + e) - point(turn, t - e);
      out.positions.push_back(point(turn, t));
      out.normals.emplace_back(unit(glm::cross(across, up)));
      out.uvs[0].emplace_back(static_cast<float>(static_cast<double>(j) / around), static_cast<float>(pictures * t));
    }
  }
  for (std::uint32_t i = 0; i < along; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = first + i * (around + 1) + j;
      add_quad(out.indices, a, a + 1, a + around + 2, a + around + 1);
    }
  }
}

}  // namespace

Primitive make_tree_wood(std::uint32_t around, std::uint64_t seed) {
  assert(around >= 6);
  Primitive out;
  const std::vector<Limb> limbs = make_limbs(seed);
  for (std::size_t k = 0; k < limbs.size(); ++k) add_limb(limbs[k], k == 0 ? around : around / 2, seed + 10 * k, out);
  return out;
}

Primitive make_tree_leaves(std::uint32_t count, std::uint64_t seed) {
  Primitive out;
  const std::vector<Limb> limbs = make_limbs(seed);
  SplitMix64 random(seed + 1000);
  for (std::uint32_t k = 0; k < count; ++k) {
    const Limb& limb = limbs[1 + k % (limbs.size() - 1)];
    const double t = random.between(0.35, 1.05);
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0), z = random.between(-1.0, 1.0);
    const Vec3d away = unit(Vec3d(x, y, z) + Vec3d(0.0, 1e-6, 0.0));
    const Vec3d base = limb.at(t) + away * random.between(0.02, 0.16);
    const Vec3d up = unit(away + Vec3d(0.0, random.between(-0.3, 0.6), 0.0));
    const double turn = random.unit(), size = random.between(0.07, 0.12);
    const Vec3d other(cos_turns(turn), random.between(-0.5, 0.5), sin_turns(turn));
    const Vec3d side = unit(glm::cross(up, other) + up * 1e-9);
    add_card(out, base, side * (0.5 * size), up * size, Vec3f(unit(glm::cross(side, up))));
  }
  return out;
}

}  // namespace meshlode::lab
