// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/id_rule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/random.h"
#include "judge/pictures/source_picture.h"

namespace meshlode::judge {

namespace {

constexpr std::uint32_t kSide = 400;
constexpr std::array<double, 3> kPixelErrors = {2.0, 4.0, 8.0};
/// Of the whole scene, what a close view sees.
constexpr double kCloseView = 0.2;

Vec3d transform_point(const format::InstanceRecord& instance, const Vec3d& p) {
  Vec3d out(0.0);
  for (int row = 0; row < 3; ++row) {
    const double* m = instance.transform + 4 * row;
    out[row] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
  }
  return out;
}

/// Middles of clusters at random: there are more where there is more to see.
class Targets {
 public:
  Targets(const run::Asset& asset, std::uint64_t seed) : asset_(asset), random_(seed) {
    for (const format::InstanceRecord& instance : asset.instances()) {
      if ((instance.flags & format::kInstanceSingular) == 0 && asset.meshes()[instance.mesh].cluster_count > 0) {
        drawable_.push_back(&instance);
      }
    }
  }
  [[nodiscard]] bool is_empty() const { return drawable_.empty(); }
  Vec3d next() {
    const format::InstanceRecord& instance = *drawable_[random_.below(drawable_.size())];
    const format::MeshRecord& mesh = asset_.meshes()[instance.mesh];
    const auto cluster = static_cast<std::uint32_t>(mesh.first_cluster + random_.below(mesh.cluster_count));
    const format::CullSphere sphere = format::cull_sphere(mesh, asset_.clusters()[cluster]);
    const Vec3d origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
    return transform_point(instance, origin + Vec3d(sphere.center[0], sphere.center[1], sphere.center[2]));
  }

 private:
  const run::Asset& asset_;
  SplitMix64 random_;
  std::vector<const format::InstanceRecord*> drawable_;
};

}  // namespace

std::vector<NamedCamera> id_cameras(const run::Asset& asset, std::uint32_t count, std::uint64_t seed) {
  std::vector<NamedCamera> out;
  Targets targets(asset, seed);
  if (targets.is_empty()) return out;
  const WorldBox box = world_box(asset);
  const Vec3d center = 0.5 * (box.low + box.high);
  const double size = glm::length(box.high - box.low);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = 2.399963229728653 * i;  // the golden angle
    const double up = 0.9 * (1.0 - (2.0 * i + 1.0) / count);
    const double ring = std::sqrt(1.0 - up * up);
    NamedCamera whole{"whole " + std::to_string(i), {}};
    run::Camera& camera = whole.camera;
    camera.width = camera.height = kSide;
    camera.target = center;
    // As near as a ball around the box fits, and so that everything is beyond the near plane.
    const double distance = 0.5 * size / std::sin(0.5 * camera.fovy);
    camera.eye = center + distance * Vec3d(ring * std::cos(turn), up, ring * std::sin(turn));
    camera.near_distance = 0.5 * (distance - 0.5 * size);
    out.push_back(whole);
    NamedCamera close = whole;
    close.name = "close " + std::to_string(i);
    close.camera.target = targets.next();
    close.camera.fovy = 2.0 * std::atan(0.5 * kCloseView * size / distance);
    out.push_back(close);
  }
  return out;
}

namespace {

std::string describe(const JudgedIds& judged, const run::Camera& camera) {
  char text[400];
  std::snprintf(text, sizeof text,
                "%.3f%% of pixels show a surface that the other picture has not within what is allowed, %.1f px from "
                "it at most; render --camera=%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.6g --pixel-error %g shows it",
                100.0 * judged.distance.share(), judged.distance.farthest_px, camera.eye.x, camera.eye.y, camera.eye.z,
                camera.target.x, camera.target.y, camera.target.z, camera.fovy * (180.0 / 3.14159265358979323846),
                judged.pixel_error);
  return text;
}

/// Nothing where the camera cannot be drawn from, or a page is broken: other rules name that.
std::optional<IdDistance> judge_cut(const run::Asset& asset, std::span<const SourceSurface> surfaces,
                                    const draw::VisibilityBuffer& truth, const draw::Projection& projection,
                                    const run::Camera& camera, double pixel_error) {
  const std::vector<run::ClusterInstance> cut = run::select_bvh(asset, camera, pixel_error);
  const auto drawn = draw::draw_cut(asset, cut, camera);
  if (!drawn) return std::nullopt;
  const IdPainter painter(asset, projection, pixel_error);
  const auto picture = painter.of_cut(cut, *drawn);
  if (!picture) return std::nullopt;
  return measure_ids(painter.of_source(surfaces, truth), *picture);
}

}  // namespace

std::vector<JudgedIds> check_ids(const run::Asset& asset, const scene::Scene& source, std::uint32_t count,
                                 std::uint64_t seed, RuleLog& log) {
  std::vector<JudgedIds> out;
  log.check(Rule::kV211);
  const std::vector<SourceSurface> surfaces = source_surfaces(source, false);
  for (const NamedCamera& named : id_cameras(asset, count, seed)) {
    auto projection = draw::make_projection(named.camera);
    if (!projection) continue;
    projection->far_distance = draw::scene_depth(asset, *projection);
    const draw::VisibilityBuffer truth = draw_source(asset, surfaces, *projection);
    for (const double pixel_error : kPixelErrors) {
      const auto distance = judge_cut(asset, surfaces, truth, *projection, named.camera, pixel_error);
      if (!distance) continue;
      out.push_back({named.name, pixel_error, *distance});
      if (distance->share() <= kMostAstray) continue;
      log.add(Rule::kV211, "camera " + named.name, describe(out.back(), named.camera));
    }
  }
  return out;
}

}  // namespace meshlode::judge
