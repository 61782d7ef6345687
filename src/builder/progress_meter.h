// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of all meshes together, weighted by triangles: one level of a DAG halves what is left to do.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "builder/progress.h"
#include "scene/scene.h"

namespace meshlode::builder {

class ProgressMeter {
 public:
  /// Scene and callback must outlive it.
  ProgressMeter(const scene::Scene& scene, const ProgressCallback& callback);

  /// A level of a mesh is done and has so many triangles. False: the caller asked to stop, here or before. From any
  /// thread.
  [[nodiscard]] bool report(std::size_t mesh, std::uint32_t level, std::uint64_t triangles);

 private:
  const scene::Scene& scene_;
  const ProgressCallback& callback_;
  std::mutex mutex_;
  std::vector<std::uint64_t> remaining_;  ///< triangles, per mesh
  std::uint64_t total_ = 0;
  bool is_cancelled_ = false;
};

}  // namespace meshlode::builder
