// SPDX-License-Identifier: GPL-3.0-or-later
// A hard case: one idea, a generator, and a parameter that sweeps from easy to absurd, so that the suite says where
// something ends and not only that one point of it holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "builder/builder.h"
#include "run/select/select.h"
#include "scene/scene.h"

namespace meshlode::test::hard {

/// A camera that the laws of views are tried with, and the pixels that it allows.
struct HardView {
  run::Camera camera;
  double pixel_error = 1.0;
};

/// One case at one parameter.
struct Sample {
  scene::Scene scene;
  builder::PipelineOptions options;
  /// The smallest detail that the case is about, object units; 0: it has none. Where the stored positions are off by
  /// more than half of it the detail is lost, by no more than the asset says.
  double feature = 0.0;
  /// How far the input's own format has moved a vertex already, before anything of ours saw it. Object units.
  double input_loss = 0.0;
  std::vector<HardView> views;
  bool draws_pictures = false;  ///< each view is also drawn
  /// Triangles that cross each other everywhere: there samples have missed a maximum, which the tier allows for by its
  /// own words; the deviation of cuts (V206) is not asked.
  bool crosses_itself = false;
};

struct HardCase {
  const char* room;           ///< what the case is about, the heading of its rows
  const char* name;           ///< one word, for the command line
  const char* parameter;      ///< what is swept, with its unit
  std::vector<double> sweep;  ///< from easy to absurd
  bool is_whole = false;      ///< the parameter is a count: what lies between two of them is a whole number
  bool is_quick = false;      ///< part of the normal run: the first parameter and every law at it
  Result<Sample> (*make)(double parameter) = nullptr;
};

/// In the order of the table.
[[nodiscard]] std::span<const HardCase> hard_cases();

// The cases, a file each (cases/).
[[nodiscard]] std::vector<HardCase> placement_cases();
[[nodiscard]] std::vector<HardCase> scale_cases();
[[nodiscard]] std::vector<HardCase> sliver_cases();
[[nodiscard]] std::vector<HardCase> topology_cases();
[[nodiscard]] std::vector<HardCase> crossing_cases();
[[nodiscard]] std::vector<HardCase> flat_cases();
[[nodiscard]] std::vector<HardCase> value_cases();
[[nodiscard]] std::vector<HardCase> size_cases();
[[nodiscard]] std::vector<HardCase> attribute_cases();
[[nodiscard]] std::vector<HardCase> instance_cases();
[[nodiscard]] std::vector<HardCase> view_cases();

/// A sample of one mesh with one instance and the default material.
[[nodiscard]] Sample sample_of(scene::Primitive shape);

}  // namespace meshlode::test::hard
