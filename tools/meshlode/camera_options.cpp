// SPDX-License-Identifier: GPL-3.0-or-later
#include "camera_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

namespace meshlode::cli {

namespace {

constexpr std::uint32_t kMaxSize = 16384;  ///< pixels a side: larger pictures do not fit the rasterizer's fixed point

/// Numbers apart by commas; nothing where one of them is not a finite number.
std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    double value = 0.0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || end != part.data() + part.size() || !std::isfinite(value)) return std::nullopt;
    numbers.push_back(value);
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

bool parse_size(std::string_view text, std::uint32_t& width, std::uint32_t& height) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) return false;
  const auto parse = [](std::string_view part, std::uint32_t& out) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), out);
    return error == std::errc{} && end == part.data() + part.size() && out >= 1 && out <= kMaxSize;
  };
  return parse(text.substr(0, x), width) && parse(text.substr(x + 1), height);
}

struct Box {
  Vec3d low{std::numeric_limits<double>::infinity()};
  Vec3d high{-std::numeric_limits<double>::infinity()};
};

Box world_bounds(const Asset& asset) {
  Box box;
  for (const format::InstanceRecord& instance : asset.instances()) {
    if ((instance.flags & format::kInstanceSingular) != 0) continue;
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    if (mesh.cluster_count == 0) continue;
    const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
    for (int corner = 0; corner < 8; ++corner) {
      double p[3];
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t q = ((corner >> axis) & 1) != 0 ? mesh.bounds_max[axis] : mesh.bounds_min[axis];
        p[axis] = mesh.origin[axis] + step * q;
      }
      for (int row = 0; row < 3; ++row) {
        const double* m = instance.transform + 4 * row;
        const double w = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
        if (!std::isfinite(w)) continue;
        box.low[row] = std::min(box.low[row], w);
        box.high[row] = std::max(box.high[row], w);
      }
    }
  }
  return box;
}

}  // namespace

void add_camera_options(OptionParser& parser, CameraOptions& options) {
  parser.add_value("--camera", options.camera,
                   "ex,ey,ez,tx,ty,tz[,fovy_deg[,near]]: eye, target, field of view, near distance in world units; "
                   "not given: a view that frames the scene");
  parser.add_value("--ortho", options.ortho_height, "orthographic: world units that the picture's height spans");
  parser.add_value("--size", options.size, "picture size in pixels, WxH (1280x720)");
  parser.add_value("--pixel-error", options.pixel_error, "allowed displacement in pixels (1)");
}

Camera frame_scene(const Asset& asset, std::uint32_t width, std::uint32_t height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  const Box box = world_bounds(asset);
  Vec3d center{0.0};
  double radius = 1.0;
  if (box.low.x <= box.high.x && box.low.y <= box.high.y && box.low.z <= box.high.z) {
    center = 0.5 * (box.low + box.high);
    radius = 0.5 * glm::length(box.high - box.low);
    if (!(radius > 0.0) || !std::isfinite(radius)) radius = 1.0;
  }
  // The sphere has to fit the narrower side of the picture.
  const double tangent = std::tan(0.5 * camera.fovy);
  const double narrow = std::min(1.0, static_cast<double>(width) / height) * tangent;
  const double distance = radius * std::sqrt(1.0 + narrow * narrow) / narrow;
  camera.target = center;
  camera.eye = center + glm::normalize(Vec3d(0.55, 0.40, 1.0)) * distance;
  camera.ortho_height = 2.0 * radius / std::min(1.0, static_cast<double>(width) / height);
  camera.near_distance = std::max(1e-3 * radius, std::numeric_limits<double>::min());
  return camera;
}

Result<Camera> make_camera(const CameraOptions& options, const Asset& asset) {
  const auto usage = [](const char* option, const char* detail) { return Error{ErrorCode::kUsage, option, detail}; };
  std::uint32_t width = 0, height = 0;
  if (!parse_size(options.size, width, height)) return usage("--size", "give WIDTHxHEIGHT, each 1 to 16384");
  if (!(options.pixel_error >= 0.0) || !std::isfinite(options.pixel_error)) {
    return usage("--pixel-error", "give a number of pixels, 0 or more");
  }
  Camera camera = frame_scene(asset, width, height);
  if (options.camera) {
    const auto numbers = parse_numbers(*options.camera);
    if (!numbers || numbers->size() < 6 || numbers->size() > 8) {
      return usage("--camera", "give ex,ey,ez,tx,ty,tz[,fovy_deg[,near]]");
    }
    const std::vector<double>& n = *numbers;
    camera.eye = {n[0], n[1], n[2]};
    camera.target = {n[3], n[4], n[5]};
    if (camera.eye == camera.target) return usage("--camera", "eye and target are the same point");
    if (n.size() > 6) {
      if (!(n[6] > 0.0 && n[6] < 180.0)) return usage("--camera", "the field of view is between 0 and 180 degrees");
      camera.fovy = n[6] * std::numbers::pi / 180.0;
    }
    if (n.size() > 7) {
      if (!(n[7] > 0.0)) return usage("--camera", "the near distance is above 0");
      camera.near_distance = n[7];
    }
  }
  if (options.ortho_height) {
    if (!(*options.ortho_height > 0.0) || !std::isfinite(*options.ortho_height)) {
      return usage("--ortho", "give a height above 0");
    }
    camera.is_orthographic = true;
    camera.ortho_height = *options.ortho_height;
  }
  return camera;
}

}  // namespace meshlode::cli
