// SPDX-License-Identifier: GPL-3.0-or-later
// The whole build, scene in and file bytes out. src/pipeline/build.cpp is the page to read first.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "mesh/scene.h"
#include "plan/plan.h"

namespace meshlode {


struct PipelineOptions {
  format::ErrorTier error_tier = format::ErrorTier::kMeasured;
  AttributeChoice attributes = AttributeChoice::kAuto;
  double grid_step = 0.0;  ///< 0: chosen from the budget; else this step in mesh units
  format::Codec codec = format::Codec::kNone;
  bool repair = false;     ///< the scene was imported with repair: recorded, because it changes the bytes
  std::uint32_t max_cluster_triangles = 128;  ///< I2; at most format::kMaxClusterTriangles
  std::uint32_t max_cluster_vertices = 256;   ///< I2; at most format::kMaxClusterVertices
  std::uint32_t normal_bits = 11;  ///< per octahedral axis
  std::uint32_t uv_bits = 16;      ///< steps across a mesh's UV range, as a power of two
};

/// Called from one thread at a time, in no promised order between meshes. Return false to cancel.
struct ProgressEvent {
  std::uint32_t mesh = 0, mesh_count = 0;
  std::string mesh_name;
  std::uint32_t level = 0;
  std::uint64_t triangles = 0;         ///< of the level just finished
  double fraction = 0.0;               ///< of the whole build, 0 … 1
};
using ProgressCallback = std::function<bool(const ProgressEvent&)>;

/// Wall seconds and counts per stage; never part of the file.
struct StageTime {
  std::string stage;
  double seconds = 0.0;
};
struct PipelineReport {
  std::vector<StageTime> stages;
};

/// Thread count is the caller's: run inside a tbb::task_arena or under tbb::global_control.
[[nodiscard]] Result<std::vector<std::uint8_t>> build_lode(const Scene& scene, const PipelineOptions& options,
                                                           const ProgressCallback& progress, PipelineReport& report);

}  // namespace meshlode
