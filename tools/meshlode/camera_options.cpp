// SPDX-License-Identifier: GPL-3.0-or-later
#include "camera_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

#include "base/printable.h"

namespace meshlode::cli {

namespace {

constexpr std::uint32_t kMaxSize = 16384;  ///< pixels a side: larger pictures do not fit the rasterizer's fixed point

struct WorldSphere {
  Vec3d center{0.0};
  double radius = 0.0;
};

Vec3d to_world(const format::InstanceRecord& instance, const Vec3d& p) {
  Vec3d world{0.0};
  for (int row = 0; row < 3; ++row) {
    const double* m = instance.transform + 4 * row;
    world[row] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
  }
  return world;
}

bool is_finite(const Vec3d& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Corners of the boxes of everything that can be drawn.
std::vector<WorldSphere> world_corners(const run::Asset& asset) {
  std::vector<WorldSphere> corners;
  for (const format::InstanceRecord& instance : asset.instances()) {
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    if ((instance.flags & format::kInstanceSingular) != 0 || mesh.cluster_count == 0) continue;
    const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
    for (int corner = 0; corner < 8; ++corner) {
      Vec3d p{0.0};
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] =
            mesh.origin[axis] + step * (((corner >> axis) & 1) != 0 ? mesh.bounds_max[axis] : mesh.bounds_min[axis]);
      }
      if (const Vec3d world = to_world(instance, p); is_finite(world)) corners.push_back({world, 0.0});
    }
  }
  return corners;
}

/// Spheres of the level-0 clusters of everything that can be drawn; empty where there are very many.
std::vector<WorldSphere> world_spheres(const run::Asset& asset) {
  constexpr std::uint64_t kMaxSpheres = 4'000'000;
  std::uint64_t count = 0;
  for (const format::InstanceRecord& instance : asset.instances()) count += asset.meshes()[instance.mesh].cluster_count;
  std::vector<WorldSphere> spheres;
  if (count > kMaxSpheres) return spheres;
  for (const format::InstanceRecord& instance : asset.instances()) {
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    if ((instance.flags & format::kInstanceSingular) != 0) continue;
    for (const format::ClusterRecord& c : asset.clusters().subspan(mesh.first_cluster, mesh.cluster_count)) {
      if (c.level != 0) continue;
      const format::CullSphere sphere = format::cull_sphere(mesh, c);
      const Vec3d p = Vec3d(mesh.origin[0], mesh.origin[1], mesh.origin[2]) +
                      Vec3d(sphere.center[0], sphere.center[1], sphere.center[2]);
      const double radius = double{sphere.radius} * instance.scale;
      if (const Vec3d world = to_world(instance, p); is_finite(world) && std::isfinite(radius)) {
        spheres.push_back({world, radius});
      }
    }
  }
  return spheres;
}

/// An orthonormal frame at the middle of the scene, looking at it against `back`.
struct ViewFrame {
  Vec3d center{0.0}, back{0.0}, right{0.0}, up{0.0};
  double tan_x = 1.0, tan_y = 1.0;  ///< of half the field of view
};

struct Fit {
  double distance = 0.0;     ///< of the eye, perspective
  double half_height = 0.0;  ///< of the picture, orthographic
};

/// How far away the eye must be, and how high the picture, for each sphere to be inside. A sphere at height y and depth
/// z is below a plane through the eye at the angle a where y cos a + r <= z sin a.
Fit fit_spheres(const std::vector<WorldSphere>& spheres, const ViewFrame& view) {
  Fit fit;
  const double secant_x = std::sqrt(1.0 + view.tan_x * view.tan_x), secant_y = std::sqrt(1.0 + view.tan_y * view.tan_y);
  for (const WorldSphere& sphere : spheres) {
    const Vec3d d = sphere.center - view.center;
    const double x = std::abs(glm::dot(d, view.right)), y = std::abs(glm::dot(d, view.up)), r = sphere.radius;
    const double depth = std::max((x + r * secant_x) / view.tan_x, (y + r * secant_y) / view.tan_y);
    fit.distance = std::max(fit.distance, depth + glm::dot(d, view.back));
    fit.half_height = std::max({fit.half_height, y + r, (x + r) * view.tan_y / view.tan_x});
  }
  return fit;
}

}  // namespace

bool parse_size(std::string_view text, std::uint32_t& width, std::uint32_t& height) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) return false;
  const auto parse = [](std::string_view part, std::uint32_t& out) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), out);
    return error == std::errc{} && end == part.data() + part.size() && out >= 1 && out <= kMaxSize;
  };
  return parse(text.substr(0, x), width) && parse(text.substr(x + 1), height);
}

void add_camera_options(OptionParser& parser, CameraOptions& options) {
  add_camera_options(parser, options, [&](const char* name, const std::string& help) {
    parser.add_value(name, options.camera, help.c_str());
  });
}

void add_camera_options(OptionParser& parser, CameraOptions& options,
                        const std::function<void(const char* name, const std::string& help)>& add_camera) {
  add_camera("--camera EX,EY,EZ,TX,TY,TZ[,FOVY[,NEAR]]",
             "eye, target, vertical field of view in degrees, near distance; world units (default: a view that "
             "frames the scene)");
  parser.add_value("--ortho HEIGHT", options.ortho_height,
                   "orthographic camera; HEIGHT of the picture in world units (default: perspective)");
  parser.add_value("--size WxH", options.size, "size of the picture in pixels, each 1 to 16384");
  add_pixel_error_option(parser, options.pixel_error);
}

run::Camera frame_scene(const run::Asset& asset, std::uint32_t width, std::uint32_t height) {
  run::Camera camera;
  camera.width = width;
  camera.height = height;
  const std::vector<WorldSphere> corners = world_corners(asset);
  Vec3d low{0.0}, high{0.0};
  if (!corners.empty()) low = high = corners.front().center;
  for (const WorldSphere& corner : corners) {
    low = {std::min(low.x, corner.center.x), std::min(low.y, corner.center.y), std::min(low.z, corner.center.z)};
    high = {std::max(high.x, corner.center.x), std::max(high.y, corner.center.y), std::max(high.z, corner.center.z)};
  }
  double radius = 0.5 * glm::length(high - low);
  if (!(radius > 0.0) || !std::isfinite(radius)) radius = 1.0;

  ViewFrame view;
  view.center = 0.5 * (low + high);
  view.back = glm::normalize(Vec3d(0.55, 0.40, 1.0));
  view.right = glm::normalize(glm::cross(Vec3d(0.0, 1.0, 0.0), view.back));
  view.up = glm::cross(view.back, view.right);
  view.tan_y = std::tan(0.5 * camera.fovy);
  view.tan_x = view.tan_y * width / height;
  // Boxes are closer to what is flat and square, clusters to what is round; both hold everything.
  Fit fit = fit_spheres(corners, view);
  if (const std::vector<WorldSphere> spheres = world_spheres(asset); !spheres.empty()) {
    const Fit closer = fit_spheres(spheres, view);
    fit.distance = std::min(fit.distance, closer.distance);
    fit.half_height = std::min(fit.half_height, closer.half_height);
  }
  constexpr double kMargin = 1.05;
  const double distance = kMargin * std::max(fit.distance, 1e-2 * radius);
  camera.target = view.center;
  camera.eye = view.center + view.back * distance;
  camera.ortho_height = 2.0 * kMargin * std::max(fit.half_height, 1e-2 * radius);
  camera.near_distance = std::max(1e-3 * radius, std::numeric_limits<double>::min());
  return camera;
}

Result<run::Camera> make_camera(const CameraOptions& options, const run::Asset& asset) {
  const auto usage = [](const char* option, const char* detail) { return Error{ErrorCode::kUsage, option, detail}; };
  std::uint32_t width = 0, height = 0;
  if (!parse_size(options.size, width, height))
    return Error{ErrorCode::kUsage, "--size", "give WIDTHxHEIGHT, each 1 to 16384" + got_text(options.size)};
  if (!(options.pixel_error >= 0.0) || !std::isfinite(options.pixel_error)) {
    return usage("--pixel-error", "give a number of pixels, 0 or more");
  }
  run::Camera camera = frame_scene(asset, width, height);
  if (options.camera) {
    const auto numbers = parse_numbers(*options.camera);
    if (!numbers || numbers->size() < 6 || numbers->size() > 8) {
      return Error{ErrorCode::kUsage, "--camera",
                   "give ex,ey,ez,tx,ty,tz[,fovy_deg[,near]]" + got_text(*options.camera)};
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
