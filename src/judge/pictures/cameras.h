// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras that judge: around a scene, where formulas are weakest, and along a path from a file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "base/box.h"
#include "base/vec.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::judge {

/// The box of everything that can be drawn, world units; of nothing, the origin.
[[nodiscard]] Box3d world_box(const run::Asset& asset);

/// A point of an instance's mesh, world units.
[[nodiscard]] Vec3d transform_point(const format::InstanceRecord& instance, const Vec3d& p);

struct NamedCamera {
  std::string name;
  run::Camera camera;
};

/// Around, inside, on the near plane, far away, through a keyhole, wide, straight down, orthographic.
[[nodiscard]] std::vector<NamedCamera> adversarial_cameras(const run::Asset& asset, std::uint32_t width,
                                                           std::uint32_t height);

/// `count` cameras on a spiral around the scene, from close to far.
[[nodiscard]] std::vector<NamedCamera> orbit_cameras(const run::Asset& asset, std::uint32_t count, std::uint32_t width,
                                                     std::uint32_t height);

/// A fly-through: a line a frame, "ex ey ez tx ty tz [fovy_degrees [near]]"; empty lines and lines after # are skipped.
/// Errors: kInvalid with the line.
[[nodiscard]] Result<std::vector<NamedCamera>> parse_camera_path(std::string_view text, const run::Camera& base);

}  // namespace meshlode::judge
