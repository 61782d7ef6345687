// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stream/error_shown.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meshlode::app {

float ErrorMeter::add_frame(const StreamScene& scene, const run::Camera& camera,
                            std::span<const run::ClusterInstance> items) {
  const double pixels = camera.height / (2.0 * std::tan(0.5 * camera.fovy));
  const double picture = static_cast<double>(camera.width) * camera.height;
  double frame_max = 0.0;
  for (const run::ClusterInstance& item : items) {
    const format::InstanceRecord& instance = scene.instances[item.instance.value];
    const format::MeshRecord& mesh = scene.meshes[instance.mesh];
    const format::ClusterRecord& cluster = scene.clusters[item.cluster.value];
    const format::CullSphere sphere = format::cull_sphere(mesh, cluster);
    Vec3d to{0.0};
    for (int row = 0; row < 3; ++row) {
      const double* m = instance.transform + 4 * row;
      to[row] = m[3] - camera.eye[row];
      for (int axis = 0; axis < 3; ++axis) to[row] += m[axis] * (mesh.origin[axis] + double{sphere.center[axis]});
    }
    const double radius = double{sphere.radius} * instance.scale;
    const double distance = std::max(glm::length(to) - radius, camera.near_distance);
    const double error =
        cluster.own_group == format::kNone ? 0.0 : double{scene.groups[cluster.own_group].error} * instance.scale;
    const double px = error * pixels / distance;
    const double across = radius * pixels / std::max({glm::length(to), radius, camera.near_distance});
    const double area = std::min(std::numbers::pi * across * across, picture);
    frame_max = std::max(frame_max, px);
    area_ += area;
    if (is_over(px, pixel_error_)) over_asked_ += area;
    if (is_over(px, 4.0 * pixel_error_)) over_fourfold_ += area;
    int octave = 0;
    const double part = std::frexp(px, &octave);  // 0.5 to 1
    const int step = static_cast<int>((part - 0.5) * 2.0 * kSteps);
    const int bin = px > 0.0 ? (octave - kFirstOctave) * kSteps + step : 0;
    area_of_bin_[static_cast<std::size_t>(std::clamp(bin, 0, kSteps * kOctaves - 1))] += area;
  }
  max_px_ = std::max(max_px_, frame_max);
  return static_cast<float>(frame_max);
}

/// The upper end of the bin up to which the share of the area lies.
double ErrorMeter::quantile(double share) const {
  double sum = 0.0;
  for (std::size_t bin = 0; bin < area_of_bin_.size(); ++bin) {
    sum += area_of_bin_[bin];
    if (sum < share * area_) continue;
    const int octave = static_cast<int>(bin) / kSteps + kFirstOctave, step = static_cast<int>(bin) % kSteps;
    return std::min(std::ldexp(0.5 + 0.5 * (step + 1) / kSteps, octave), max_px_);
  }
  return max_px_;
}

ErrorShown ErrorMeter::result() const {
  ErrorShown out;
  if (!(area_ > 0.0)) return out;
  out.max_px = max_px_;
  out.p95_px = quantile(0.95);
  out.p99_px = quantile(0.99);
  out.share_over_asked = over_asked_ / area_;
  out.share_over_fourfold = over_fourfold_ / area_;
  return out;
}

}  // namespace meshlode::app
