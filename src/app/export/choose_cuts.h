// SPDX-License-Identifier: GPL-3.0-or-later
// One cut per mesh for a glTF, which has one mesh for all its instances. Uniform cuts are select_uniform's; here are
// the ones that a camera or a DAG level decides. All follow the one rule (I5): a set of groups that pass, closed
// towards the finer side, draws each piece of surface once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::app {

/// The cut that replaces every group below `level`: 0 is the finest, level_count - 1 or more the coarsest.
[[nodiscard]] run::UniformCut choose_level_cut(const run::Asset& asset, MeshId mesh, std::uint32_t level);

/// Per mesh the coarsest cut that is at least as fine, everywhere, as what each of its instances draws for the camera:
/// a group passes iff it passes for all of them. Meshes without a drawn instance have an empty cut.
[[nodiscard]] std::vector<run::UniformCut> choose_camera_cuts(const run::Asset& asset, const run::Camera& camera,
                                                              double pixel_error,
                                                              const run::AttributeBounds& bounds = {});

/// Uniform cuts of several meshes under one budget.
struct BudgetCuts {
  std::vector<run::UniformCut> cuts;  ///< one per mesh; empty for meshes that were left out
  double threshold = 0.0;       ///< a group passes iff its error / its mesh's unit is at most this; negative: finest
  std::uint64_t triangles = 0;  ///< of all the cuts together, each mesh once
  bool is_met = false;          ///< false: even the coarsest cuts have more triangles than the budget; they are given
};

/// The finest cuts with at most `max_triangles` together. One threshold decides for all meshes, in each mesh's own
/// `unit` (mesh units: 1 compares errors as they are, a diagonal compares relative ones); a unit that is not above 0
/// leaves its mesh out. \pre one unit per mesh
[[nodiscard]] BudgetCuts choose_budget_cuts(const run::Asset& asset, std::span<const double> units,
                                            std::uint64_t max_triangles);

}  // namespace meshlode::app
