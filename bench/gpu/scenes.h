// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes made of one asset, many times.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::bench {

struct BenchScene {
  std::vector<format::InstanceRecord> instances;
  Vec3d center{0.0};
  double radius = 1.0;     ///< of everything
  double diagonal = 1.0;   ///< of one instance
  bool is_ground = false;  ///< spread over a plane, seen from above its edge
};

/// `count` instances of mesh 0: a cube of them two diameters apart, or a square on the ground with pseudorandom turns.
[[nodiscard]] BenchScene make_grid(const run::Asset& asset, std::uint32_t x, std::uint32_t y, std::uint32_t z);
[[nodiscard]] BenchScene make_ground(const run::Asset& asset, std::uint32_t side);

/// Frame `t` in [0, 1) of a way around (or across) the scene.
[[nodiscard]] run::Camera bench_camera(const BenchScene& scene, double t, std::uint32_t width, std::uint32_t height);

}  // namespace meshlode::bench
