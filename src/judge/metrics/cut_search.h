// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles at equal deviation: the fewest over all actual uniform cuts whose true figure is at most x. A mesh has as
// many uniform cuts as its groups have distinct stored errors, plus the finest.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "judge/metrics/cut_judge.h"

namespace meshlode::judge {

enum class Figure { kMax, kRms };

struct FoundCut {
  double threshold = 0.0;  ///< object units: select_uniform gives the cut
  run::UniformCut cut;
  CutFigures figures;
  std::size_t cuts_measured = 0, cuts_of_mesh = 0;
};

/// Thresholds of all uniform cuts of a mesh, ascending; the first is 0. Object units.
[[nodiscard]] std::vector<double> cut_thresholds(const run::Asset& asset, MeshId mesh, run::CutError by);

struct CutSearch {
  run::CutError by = run::CutError::kSelection;  ///< which stored number makes the cuts
  Figure figure = Figure::kMax;
  double x = 0.0;             ///< object units, above 0
  std::size_t few_cuts = 32;  ///< a mesh with no more has all of them measured
  /// What else must hold of a cut that is within x; nothing where empty. Finer cuts should pass where coarser ones do.
  std::function<bool(const run::UniformCut&, const CutFigures&)> accepts = {};
};

/// Among many cuts the search goes outward from x and bisects; then, because true figures are not quite monotone, every
/// coarser cut up to three times x (or the threshold found) is tried for the maximum, and the next six for the RMS.
/// Nothing where no cut, the finest neither, is within x.
[[nodiscard]] std::optional<FoundCut> find_fewest_triangles(CutJudge& judge, const run::Asset& asset, MeshId mesh,
                                                            const CutSearch& search);

}  // namespace meshlode::judge
