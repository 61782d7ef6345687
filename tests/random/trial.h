// SPDX-License-Identifier: GPL-3.0-or-later
// One scene put to the test by the program itself: built, validated, verified against the source, decoded to a cut.
// Every step is a process of its own (step.h), so that a crash, a hang or a flood of memory is a finding like any
// other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "step.h"

namespace meshlode::test {

/// How far a trial goes; shrinking repeats only what it needs.
enum class Depth { kBuild, kValidate, kVerifyWithoutDeviation, kAll };

struct TrialOptions {
  std::filesystem::path program;      ///< meshlode
  StartedProgram* started = nullptr;  ///< where steps are to be its forks
  std::filesystem::path folder;       ///< existing; what a trial writes there it removes
  std::vector<std::string> build_options;
  Depth depth = Depth::kAll;
  /// V211 counts. Not in needles, soups and heaps: which of their surfaces is in front is chance even in the source.
  bool judges_seen_surfaces = false;
  std::optional<std::uint64_t> samples{};  ///< verify's --samples; its own default without
  double cpu_seconds = 120.0;   ///< of processor time, each step; a hang that sleeps ends after four times that
  bool other_jobs_too = false;  ///< builds again with another number of threads: the bytes have to be the same (I10)
};

struct TrialResult {
  /// Findings by rule: ids of validate and verify, or STEP:REASON ("build:signal 11", "verify:time", "extract:exit 2").
  std::map<std::string, std::uint64_t> rules;
  std::optional<std::string> refusal;  ///< the build's one line, without the file's name: a refusal is not a failure
  std::string detail;                  ///< the first finding in words
  double build_seconds = 0.0, total_seconds = 0.0;  ///< processor time
  /// I7: cuts measured, those that deviate by more than they store, and those of which that was not found out.
  std::uint64_t cuts = 0, cuts_above = 0, cuts_undecided = 0;
  double largest_ratio = 0.0;  ///< met over stored, of all cuts

  [[nodiscard]] bool is_clean() const { return rules.empty() && !refusal; }
};

[[nodiscard]] TrialResult try_scene(const std::vector<std::uint8_t>& glb, const TrialOptions& options);

/// What a trial has to go through to see the rule again.
[[nodiscard]] Depth depth_of(const std::string& rule);

}  // namespace meshlode::test
