// SPDX-License-Identifier: GPL-3.0-or-later
// A simulation as text and as JSON (docs/schemas/stream.schema.json).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "app/stream/camera_path.h"
#include "app/stream/page_layout.h"
#include "app/stream/scene.h"
#include "app/stream/simulate.h"

namespace meshlode::app {

/// The same path with the groups in other pages.
struct TriedLayout {
  PageLayout layout;
  std::uint64_t pages = 0;
  Demand demand;
  RunResult run;  ///< as the first spec says
};

struct StreamReport {
  std::vector<std::string> assets;  ///< files
  std::string path;                 ///< a file, or the name of a builtin
  const StreamScene& scene;
  std::span<const PathFrame> frames;
  StreamView view;
  std::span<const RunSpec> specs;
  const Simulation& simulation;
  bool is_checked = false;
  bool has_log = false;  ///< JSON: frames, requests and sizes of pages too
  std::span<const TriedLayout> layouts = {};
};

/// Lines of at most 80 characters, but for names.
[[nodiscard]] std::string stream_text(const StreamReport& report);
[[nodiscard]] std::string stream_json(const StreamReport& report);

/// "12 findings" and the like; all findings, those of runs with the run's number.
[[nodiscard]] std::uint64_t count_findings(const Simulation& simulation);

}  // namespace meshlode::app
