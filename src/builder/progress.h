// SPDX-License-Identifier: GPL-3.0-or-later
// What a build says while it runs, and how long its stages took.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace meshlode::builder {

/// Called from one thread at a time, in no promised order between meshes. Return false to cancel.
struct ProgressEvent {
  std::uint32_t mesh = 0, mesh_count = 0;
  std::string mesh_name;
  std::uint32_t level = 0;
  std::uint64_t triangles = 0;  ///< of the level just finished
  double fraction = 0.0;        ///< of the whole build, 0 … 1
};
using ProgressCallback = std::function<bool(const ProgressEvent&)>;

/// Wall seconds and counts per stage; never part of the file.
struct StageTime {
  std::string stage;
  double seconds = 0.0;
};
/// When a mesh's DAG had one more level; `seconds` run from the level before it, or from where the DAG began.
struct LevelTime {
  std::uint32_t mesh = 0, level = 0;
  std::uint64_t triangles = 0;  ///< of the level
  double seconds = 0.0;         ///< wall time
};

}  // namespace meshlode::builder
