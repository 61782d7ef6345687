// SPDX-License-Identifier: GPL-3.0-or-later
// Wall seconds of the build's stages, and of the levels of its longest one.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

#include "builder/progress.h"

namespace meshlode::builder {

enum class Stage : std::uint8_t { kPlan, kPrepare, kDag, kMeasure, kHierarchy, kEncode, kWrite };
constexpr std::size_t kStageCount = 7;

/// Runs from when it is made.
class StageClock {
 public:
  StageClock() : last_(std::chrono::steady_clock::now()) {}

  /// The time since the stage before ended is this one's.
  void end(Stage stage);

  /// Adds to the sums over meshes, which may run side by side; makes them where there are none yet.
  void add_to(std::vector<StageTime>& stages) const;

 private:
  std::chrono::steady_clock::time_point last_;
  std::array<double, kStageCount> seconds_{};
};

/// Times the levels of one mesh's DAG; runs from when it is made.
class LevelClock {
 public:
  explicit LevelClock(std::size_t mesh)
      : mesh_(static_cast<std::uint32_t>(mesh)), last_(std::chrono::steady_clock::now()) {}

  void end(std::uint32_t level, std::uint64_t triangles);
  [[nodiscard]] const std::vector<LevelTime>& times() const { return times_; }

 private:
  std::uint32_t mesh_;
  std::chrono::steady_clock::time_point last_;
  std::vector<LevelTime> times_;
};

}  // namespace meshlode::builder
