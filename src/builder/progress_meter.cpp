// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/progress_meter.h"

#include <algorithm>

#include "builder/needs.h"

namespace meshlode::builder {

ProgressMeter::ProgressMeter(const scene::Scene& scene, const ProgressCallback& callback)
    : scene_(scene), callback_(callback) {
  for (const scene::SourceMesh& mesh : scene.meshes) {
    remaining_.push_back(count_mesh(mesh).triangles);
    total_ += remaining_.back();
  }
}

bool ProgressMeter::report(std::size_t mesh, std::uint32_t level, std::uint64_t triangles) {
  const std::lock_guard lock(mutex_);
  if (is_cancelled_) return false;
  remaining_[mesh] = std::min(remaining_[mesh], triangles);
  if (!callback_) return true;
  std::uint64_t left = 0;
  for (const std::uint64_t r : remaining_) left += r;
  ProgressEvent event;
  event.mesh = static_cast<std::uint32_t>(mesh);
  event.mesh_count = static_cast<std::uint32_t>(scene_.meshes.size());
  event.mesh_name = scene_.meshes[mesh].name;
  event.level = level;
  event.triangles = triangles;
  event.fraction = total_ == 0 ? 1.0 : 1.0 - static_cast<double>(left) / static_cast<double>(total_);
  is_cancelled_ = !callback_(event);
  return !is_cancelled_;
}

}  // namespace meshlode::builder
