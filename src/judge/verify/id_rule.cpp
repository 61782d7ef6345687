// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/id_rule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/box.h"
#include "base/random.h"
#include "base/try.h"
#include "judge/pictures/source_picture.h"

namespace meshlode::judge {

namespace {

constexpr std::uint32_t kSide = 400;
constexpr std::array<double, 3> kPixelErrors = {2.0, 4.0, 8.0};
/// Of the whole scene, what a close view sees.
constexpr double kCloseView = 0.2;

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

bool has_estimates(const run::Asset& asset) {
  return std::any_of(asset.meshes().begin(), asset.meshes().end(), [](const format::MeshRecord& mesh) {
    return mesh.cluster_count > 0 && mesh.error_tier == format::ErrorTier::kQem;
  });
}

std::vector<NamedCamera> id_cameras(const run::Asset& asset, std::uint32_t count, std::uint64_t seed) {
  std::vector<NamedCamera> out;
  Targets targets(asset, seed);
  if (targets.is_empty()) return out;
  const Box3d box = world_box(asset);
  const Vec3d center = 0.5 * (box.low + box.high);
  const double size = glm::length(box.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = 2.399963229728653 * i;          // the golden angle
    const double up = 0.9 * (1.0 - (i + 0.5) / count);  // scenes stand on something: none looks from below
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

/// Triangles of the source that all cameras together may draw, some seconds of one processor.
constexpr std::uint64_t kMostTrianglesDrawn = 200'000'000;

/// Whole and close views that this leaves of `count`.
std::uint32_t limit_cameras(const run::Asset& asset, std::span<const SourceSurface> source, std::uint32_t count) {
  std::uint64_t triangles = 1;
  for (const format::InstanceRecord& instance : asset.instances()) {
    if (instance.mesh < source.size()) triangles += source[instance.mesh].surface.triangles.size();
  }
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(count, kMostTrianglesDrawn / (2 * triangles)));
}

std::string describe_finding(const IdDistance& distance, const run::Camera& camera, double pixel_error) {
  char text[400];
  std::snprintf(text, sizeof text,
                "%.3f%% of pixels show another surface than the source, up to %.1f px from it; render --size %ux%u "
                "--pixel-error %g --camera=%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.6g,%.6g",
                100.0 * distance.share(), distance.farthest_px, camera.width, camera.height, pixel_error, camera.eye.x,
                camera.eye.y, camera.eye.z, camera.target.x, camera.target.y, camera.target.z,
                camera.fovy * (180.0 / 3.14159265358979323846), camera.near_distance);
  return text;
}

}  // namespace

IdTotals check_ids(const run::Asset& asset, const scene::Scene& source, std::uint32_t count, std::uint64_t seed,
                   RuleLog& log) {
  IdTotals totals;
  const std::vector<SourceSurface> surfaces = source_surfaces(source, false);
  const draw::AlphaMasks masks = draw::load_alpha_masks(asset);
  const IdJudge judge(asset, surfaces, masks);
  for (const NamedCamera& named : id_cameras(asset, limit_cameras(asset, surfaces, count), seed)) {
    auto truth = judge.draw_source_ids(named.camera);
    if (!truth) continue;
    for (const double pixel_error : kPixelErrors) {
      const std::vector<run::ClusterInstance> cut = run::select_bvh(asset, named.camera, pixel_error);
      const auto drawn = draw::draw_cut(asset, cut, named.camera, masks);
      if (!drawn) continue;  // a page is broken, which other rules name
      const auto distance = judge.judge_cut(*truth, named.camera, cut, *drawn, pixel_error);
      if (!distance) continue;
      char name[64];
      std::snprintf(name, sizeof name, "%s at %g px", named.name.c_str(), pixel_error);
      totals.add(name, *distance);
      log.expect(
          !is_beyond_limit(*distance) || has_estimates(asset), Rule::kV211,
          [&] { return std::string("camera ") + name; },
          [&] { return describe_finding(*distance, named.camera, pixel_error); });
    }
  }
  return totals;
}

}  // namespace meshlode::judge
