// SPDX-License-Identifier: GPL-3.0-or-later
// Sweep: what each notch of accuracy costs, for one scene. sweep.cpp is the page to read first.
//
//   the baseline is built once → knobs from what it holds → points → a plan that fits the budget
//   → round by round every planned point is built, loaded and drawn, timed; in the first also measured
//   → tables and answers
//
// Every finished measurement goes to the state file first (state.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "app/doctor/diagnosis.h"
#include "lab/sweep/answers.h"
#include "lab/sweep/draw_views.h"
#include "lab/sweep/measurement.h"
#include "lab/sweep/plan.h"
#include "lab/sweep/points.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "scene/scene.h"

namespace meshlode::lab {

struct SweepOptions {
  std::filesystem::path scene, report;  ///< a file; a folder, made where it is missing
  std::filesystem::path program;        ///< what builds: this very program
  std::string program_id;               ///< app::find_program_id()
  std::string scene_choice;             ///< glTF: --scene
  std::uint32_t jobs = 0;               ///< threads of builds and of measurements; 0: one per core
  std::uint32_t rounds = 3;
  std::uint64_t samples = 0;       ///< of deviations, each way; 0: as the budget allows (choose_fineness)
  double budget = 0.0;             ///< wall seconds; 0: none
  std::uint64_t max_decoded = 0;   ///< bytes
  std::string max_decoded_text;    ///< the same as `build` takes it; empty: its default
  std::vector<std::string> knobs;  ///< names of those that are turned; empty: all
  std::vector<Wish> wishes;        ///< empty: some usual ones
  std::string command;             ///< that makes the report again
  /// scene::ImportOptions'.
  std::vector<std::filesystem::path> allow_outside;
  /// The camera that frames an asset, for pictures of a size.
  std::function<run::Camera(const run::Asset& asset, std::uint32_t width, std::uint32_t height)> frame_scene;
  /// What in the scene costs under every setting, ranked; where it is missing, the report does not say.
  std::function<std::vector<app::Diagnosis>(const scene::Scene& scene)> diagnose_scene;
};

struct SceneSummary {
  std::string file, hash;
  std::uint64_t meshes = 0, instances = 0, triangles = 0, vertices = 0;
};

struct MachineSummary {
  std::string name, system;
  std::uint32_t threads = 0;
  std::uint64_t memory_bytes = 0;
  DeviceAnswer vulkan;
};

enum class LeftOutReason : std::uint8_t { kBudget, kInterrupted };

/// A point with all that is known of it.
struct PointResult {
  Point point;
  std::string id, label;
  bool is_chosen = false;  ///< planned; else left out
  LeftOutReason reason = LeftOutReason::kBudget;
  double estimate = 0.0;  ///< wall seconds, all rounds
  double first = 0.0;     ///< of these the first round
  bool is_done = false;   ///< measured, or failed
  std::string error;      ///< why it failed; empty: it did not
  Figures figures;
  bool is_from_state = false;
  const Measurement* asset = nullptr;  ///< of kAsset; of the state
  const Measurement* drawn = nullptr;  ///< of kDraw
};

struct Recommendation {
  Wish wish;
  Answer answer;  ///< into SweepResult::points
};

struct Frontier {
  const Metric* x = nullptr;
  const Metric* y = nullptr;
  std::vector<std::size_t> points;
};

struct SweepResult {
  SceneSummary scene;
  MachineSummary machine;
  std::vector<app::Diagnosis> diagnoses;  ///< of SweepOptions::diagnose_scene
  double spent = 0.0;                     ///< wall seconds of all measurements
  bool is_complete = false;
  Fineness fineness;  ///< as measured
  std::vector<Knob> knobs;
  std::vector<IdleKnob> idle_knobs;
  std::vector<View> views;
  std::vector<std::string> full_pictures;              ///< of the views, paths below the report's folder
  std::vector<PointResult> points;                     ///< in the order of make_points()
  std::vector<std::vector<std::size_t>> dominated_by;  ///< of each point
  std::vector<Frontier> frontiers;
  std::vector<Recommendation> recommendations;
};

/// What is under way: of which point, in which round, and how far all is by estimated time.
struct SweepProgress {
  std::string label;
  std::uint32_t round = 0, rounds = 0;
  std::size_t point = 0, points = 0;
  double fraction = 0.0;      ///< 0 to 1
  double seconds_left = 0.0;  ///< by what was measured so far; 0: not known yet
};
using SweepWatcher = std::function<void(const SweepProgress& progress)>;

/// Gets what is known after each round; what it points into lives until it returns.
using KeepResult = std::function<Status(const SweepResult& result)>;

/// Measures, or takes over what was measured. Errors: as the import of the scene and a build of the baseline; kIo for
/// the report's folder; what `keep` says. A point that cannot be built is no error: it has one.
[[nodiscard]] Status run_sweep(const SweepOptions& options, const SweepWatcher& watcher, const KeepResult& keep);

/// sweep.json (docs/schemas/sweep.schema.json) and sweep.csv: a line a point, a column a setting and a figure.
[[nodiscard]] std::string sweep_json(const SweepOptions& options, const SweepResult& result);
[[nodiscard]] std::string sweep_csv(const SweepResult& result);

/// The first point before it that has the same asset content; empty: none.
[[nodiscard]] std::string same_asset_as(const SweepResult& result, std::size_t at);
/// The command lines that build a point's asset and draw it.
[[nodiscard]] std::string build_command(const SweepOptions& options, const SweepResult& result, const Point& point);
[[nodiscard]] std::string draw_command(const SweepOptions& options, const SweepResult& result, const Point& point);
/// That which tells SweepResult::diagnoses, with all their triangles.
[[nodiscard]] std::string doctor_command(const SweepOptions& options);
/// A word as a shell takes it.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace meshlode::lab
