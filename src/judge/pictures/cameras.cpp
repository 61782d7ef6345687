// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/pictures/cameras.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace meshlode::judge {

Vec3d transform_point(const format::InstanceRecord& instance, const Vec3d& p) {
  Vec3d out(0.0);
  for (int row = 0; row < 3; ++row) {
    const double* m = instance.transform + 4 * row;
    out[row] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
  }
  return out;
}

Box3d world_box(const run::Asset& asset) {
  Box3d box;
  for (const format::InstanceRecord& instance : asset.instances()) {
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    if ((instance.flags & format::kInstanceSingular) != 0 || mesh.cluster_count == 0) continue;
    const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
    Box3d of_mesh;
    for (int axis = 0; axis < 3; ++axis) {
      of_mesh.low[axis] = mesh.origin[axis] + step * mesh.bounds_min[axis];
      of_mesh.high[axis] = mesh.origin[axis] + step * mesh.bounds_max[axis];
    }
    for (const Vec3d& corner : of_mesh.corners()) box.add(transform_point(instance, corner));
  }
  return box.is_empty() ? Box3d{Vec3d(0.0), Vec3d(0.0)} : box;
}

std::vector<NamedCamera> adversarial_cameras(const run::Asset& asset, std::uint32_t width, std::uint32_t height) {
  const Box3d box = world_box(asset);
  const Vec3d center = 0.5 * (box.low + box.high);
  const double size = glm::length(box.size());
  const auto make = [&](const char* name, const Vec3d& eye, const Vec3d& target) {
    NamedCamera out{name, {}};
    out.camera.eye = eye;
    out.camera.target = target;
    out.camera.width = width;
    out.camera.height = height;
    out.camera.near_distance = 1e-3 * size;
    return out;
  };
  std::vector<NamedCamera> out;
  out.push_back(make("orbit", center + size * Vec3d(0.5, 0.4, 0.9), center));
  out.push_back(make("behind", center + size * Vec3d(-0.6, 0.1, -0.7), center));
  out.push_back(make("inside", center + size * Vec3d(0.02, 0.01, 0.03), center + size * Vec3d(1.0, 0.2, 0.4)));
  out.push_back(
      make("grazing", Vec3d(center.x, box.high.y - 0.05 * size, center.z), center + size * Vec3d(0.7, 0.0, 0.2)));
  out.push_back(make("far", center + 60.0 * size * Vec3d(0.5, 0.4, 0.9), center));
  out.push_back(make("near plane", center + size * Vec3d(0.3, 0.2, 0.3), center));
  out.back().camera.near_distance = 0.42 * size;
  out.push_back(make("keyhole", center + 20.0 * size * Vec3d(0.3, 0.5, 0.8), center));
  out.back().camera.fovy = 0.02;
  out.push_back(make("wide", center + 0.4 * size * Vec3d(-0.4, 0.5, 0.8), center));
  out.back().camera.fovy = 2.8;
  out.push_back(make("down", center + size * Vec3d(0.0, 1.1, 0.0), center));
  out.push_back(make("orthographic", center + size * Vec3d(0.5, 0.4, 0.9), center));
  out.back().camera.is_orthographic = true;
  out.back().camera.ortho_height = 0.6 * size;
  return out;
}

std::vector<NamedCamera> orbit_cameras(const run::Asset& asset, std::uint32_t count, std::uint32_t width,
                                       std::uint32_t height) {
  const Box3d box = world_box(asset);
  const Vec3d center = 0.5 * (box.low + box.high);
  const double size = glm::length(box.size());
  std::vector<NamedCamera> out;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / (count - 1) : 0.5;
    const double turn = 2.399963229728653 * i;  // the golden angle: no two cameras look alike
    const double height_share = 0.9 * std::sin(3.7 * i);
    const double ring = std::sqrt(1.0 - height_share * height_share);
    const Vec3d direction(ring * std::cos(turn), height_share, ring * std::sin(turn));
    NamedCamera named{"orbit " + std::to_string(i), {}};
    named.camera.eye = center + size * (0.55 + 6.0 * share * share) * direction;
    named.camera.target = center;
    named.camera.width = width;
    named.camera.height = height;
    named.camera.near_distance = std::max(1e-3 * size, 1e-90);
    out.push_back(named);
  }
  return out;
}

Result<std::vector<NamedCamera>> parse_camera_path(std::string_view text, const run::Camera& base) {
  std::vector<NamedCamera> out;
  std::size_t line_number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    ++line_number;
    const auto wrong = [&](const char* why) {
      return Error{ErrorCode::kInvalid, "line " + std::to_string(line_number), why};
    };
    line = line.substr(0, line.find('#'));
    std::vector<double> n;
    while (true) {
      const std::size_t first = line.find_first_not_of(" \t\r,");
      if (first == std::string_view::npos) break;
      line = line.substr(first);
      double value = 0.0;
      const auto [stop, error] = std::from_chars(line.data(), line.data() + line.size(), value);
      if (error != std::errc{} || !std::isfinite(value)) return wrong("not a number");
      n.push_back(value);
      line = line.substr(static_cast<std::size_t>(stop - line.data()));
    }
    if (n.empty()) continue;
    if (n.size() < 6 || n.size() > 8) return wrong("give ex ey ez tx ty tz [fovy_degrees [near]]");
    NamedCamera named{"frame " + std::to_string(out.size()), base};
    named.camera.eye = {n[0], n[1], n[2]};
    named.camera.target = {n[3], n[4], n[5]};
    if (named.camera.eye == named.camera.target) return wrong("eye and target are the same point");
    if (n.size() > 6) {
      if (!(n[6] > 0.0 && n[6] < 180.0)) return wrong("the field of view is between 0 and 180 degrees");
      named.camera.fovy = n[6] * 3.14159265358979323846 / 180.0;
    }
    if (n.size() > 7) {
      if (!(n[7] > 0.0)) return wrong("the near distance is above 0");
      named.camera.near_distance = n[7];
    }
    out.push_back(named);
  }
  if (out.empty()) return Error{ErrorCode::kInvalid, {}, "a camera path without a camera"};
  return out;
}

}  // namespace meshlode::judge
