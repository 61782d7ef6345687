// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/stage_clock.h"

namespace meshlode::builder {

void StageClock::end(Stage stage) {
  const auto now = std::chrono::steady_clock::now();
  seconds_[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - last_).count();
  last_ = now;
}

void StageClock::add_to(std::vector<StageTime>& stages) const {
  constexpr std::array<const char*, kStageCount> kNames = {"plan",      "prepare", "dag",  "measure",
                                                           "hierarchy", "encode",  "write"};
  if (stages.empty()) {
    for (const char* name : kNames) stages.push_back({name, 0.0});
  }
  for (std::size_t s = 0; s < kStageCount; ++s) stages[s].seconds += seconds_[s];
}

void LevelClock::end(std::uint32_t level, std::uint64_t triangles) {
  const auto now = std::chrono::steady_clock::now();
  times_.push_back({mesh_, level, triangles, std::chrono::duration<double>(now - last_).count()});
  last_ = now;
}

}  // namespace meshlode::builder
