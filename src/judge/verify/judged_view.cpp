// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/judged_view.h"

#include <algorithm>
#include <cmath>

#include "judge/pictures/cameras.h"

namespace meshlode::judge {

namespace {

Vec3d turn(const format::InstanceRecord& instance, const Vec3d& p) {
  const double* m = instance.transform;
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z, m[4] * p.x + m[5] * p.y + m[6] * p.z,
          m[8] * p.x + m[9] * p.y + m[10] * p.z};
}

Vec3d translation_of(const format::InstanceRecord& instance) {
  return {instance.transform[3], instance.transform[7], instance.transform[11]};
}

/// Of the products that make turn(): their magnitudes, all rows together.
double sum_of_magnitudes(const format::InstanceRecord& instance, const Vec3d& p) {
  double sum = 0.0;
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) sum += std::fabs(instance.transform[4 * row + k] * p[k]);
  }
  return sum;
}

Vec3d random_direction(SplitMix64& random) {
  for (;;) {
    const Vec3d v(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    const double length2 = glm::dot(v, v);
    if (length2 > 1e-4 && length2 <= 1.0) return v / std::sqrt(length2);
  }
}

/// What the runtime's and the judge's translation may be off by together, of the products that make it.
constexpr double kCancelled = 0x1p-49;

constexpr WeighedGroup kUnknownWeight{Answer::kTooClose, 0.0, HUGE_VAL};

}  // namespace

bool is_drawable(const run::Asset& asset, const format::InstanceRecord& instance) {
  return (instance.flags & format::kInstanceSingular) == 0 && asset.meshes()[instance.mesh].cluster_count > 0;
}

JudgedView random_view(const run::Asset& asset, std::span<const std::uint32_t> instances, std::uint32_t index,
                       SplitMix64& random) {
  const format::InstanceRecord& instance = asset.instances()[instances[random.below(instances.size())]];
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  const format::ClusterRecord& cluster = asset.clusters()[mesh.first_cluster + random.below(mesh.cluster_count)];
  const Vec3d origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
  const format::CullSphere sphere = format::cull_sphere(mesh, cluster);
  const Vec3d center = transform_point(instance, origin + Vec3d(sphere.center[0], sphere.center[1], sphere.center[2]));
  const double size = std::max(mesh.diagonal * instance.scale, 1e-300);
  JudgedView view;
  double distance = 0.0;
  switch (index % 5) {
    case 0:
      view.kind = "inside";
      distance = random.between(0.0, 1.0) * double{sphere.radius} * instance.scale;
      break;
    case 1:
      view.kind = "near";
      distance = size * random.log_between(1e-2, 1.0);
      break;
    case 2:
      view.kind = "mid";
      distance = size * random.log_between(1.0, 20.0);
      break;
    case 3:
      view.kind = "far";
      distance = size * random.log_between(20.0, 1e5);
      break;
    default:
      view.kind = "orthographic";
      distance = size * random.log_between(0.5, 5.0);
      view.camera.is_orthographic = true;
      break;
  }
  view.camera.eye = center + random_direction(random) * distance;
  view.camera.target = center;
  if (distance <= 0.0) view.camera.target += Vec3d(size, 0.0, 0.0);
  view.camera.fovy = random.between(0.2, 2.2);
  view.camera.ortho_height = size * random.log_between(1e-2, 1e2);
  view.camera.near_distance = size * random.log_between(1e-6, 1e-1);
  view.camera.width = static_cast<std::uint32_t>(64 + random.below(3000));
  view.camera.height = static_cast<std::uint32_t>(64 + random.below(2100));
  view.pixel_error = random.log_between(0.02, 100.0);
  return view;
}

WeighedGroup weigh(const JudgedView& view, const format::InstanceRecord& instance, const format::MeshRecord& mesh,
                   const format::GroupRecord& group) {
  if (group.error >= format::kInfiniteError) return {Answer::kFails, HUGE_VAL, HUGE_VAL};
  const run::Camera& camera = view.camera;
  const double sigma = instance.scale;
  const double k = camera.is_orthographic ? camera.height / camera.ortho_height
                                          : camera.height / (2.0 * std::tan(0.5 * camera.fovy));
  const double left = group.error * sigma * k;
  double right = view.pixel_error;
  double slack = 0.0;
  double cancelled = 0.0;
  if (!camera.is_orthographic) {
    const Vec3d c(group.center[0], group.center[1], group.center[2]);
    const Vec3d origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
    // The eye is taken from the translation before anything is added that their size would swallow: a mesh of 1e-20
    // at 30 lies where it lies, and not at 30.
    const Vec3d moved = translation_of(instance) - camera.eye;
    const Vec3d away = turn(instance, origin + c) + moved;
    const Vec3d translation = turn(instance, origin) + moved;
    // Where squares overflow the runtime draws what is finest (docs/explanation/numerics.md); where they vanish it does
    // not care.
    if (!std::isfinite(glm::dot(away, away) + glm::dot(translation, translation))) return kUnknownWeight;
    const double distance = std::hypot(away.x, away.y, away.z);
    const double reach = sigma * (std::sqrt(glm::dot(c, c)) + group.radius);
    right *= std::max(distance - group.radius * sigma, camera.near_distance);
    // Single precision relative to everything that was added or subtracted on the way.
    slack = view.pixel_error * (distance + reach + std::hypot(translation.x, translation.y, translation.z));
    // And double precision relative to what cancelled before: docs/explanation/numerics.md, "Where translations
    // cancel".
    cancelled = view.pixel_error * kCancelled * sum_of_magnitudes(instance, origin);
  }
  slack = (slack + left + right) * 4e-6 + cancelled;
  if (!std::isfinite(left) || !std::isfinite(right)) return kUnknownWeight;
  const double magnified = view.pixel_error * left;
  WeighedGroup out{Answer::kTooClose, magnified / (right + slack),
                   right > slack ? magnified / (right - slack) : HUGE_VAL};
  if (std::fabs(left - right) > slack) out.answer = left <= right ? Answer::kPasses : Answer::kFails;
  return out;
}

}  // namespace meshlode::judge
