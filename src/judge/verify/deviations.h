// SPDX-License-Identifier: GPL-3.0-or-later
// I7: stored errors against the truth: how far whole cuts deviate, from both sides (V206). Internal to the judge.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "judge/validate/rules.h"
#include "run/decode/decode.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// How far a `measured` error may fall short of the true deviation.
constexpr double kMeasuredShortfall = 0.05;

/// Every cut that there is.
constexpr std::uint32_t kAllCuts = 0xFFFFFFFFU;

/// Errors to cut at: 0 where a group says that, and from the smallest positive to the largest finite one, evenly in the
/// logarithm. One alone is in the middle; 0 only where there is no other. kAllCuts: each error that there is.
[[nodiscard]] std::vector<double> spread_thresholds(std::span<const format::GroupRecord> groups, std::uint32_t count);

/// What decoded positions may be off by: the last bits of doubles as large as they are, and of what is worked out from
/// them. A flat cut deviates by that and stores 0.
[[nodiscard]] double position_rounding(const format::MeshRecord& mesh);

/// Splits of pieces for each triangle of the source and of a cut, in all. The dragon's cuts take up to six, and every
/// one of them is decided.
constexpr std::uint32_t kDeviationBudget = 16;
/// For a quick look: a cut in the middle of the dragon's errors takes four, and four seconds.
constexpr std::uint32_t kQuickDeviationBudget = 1;

/// A share of what is stored that nobody sees. A surface that is as far away as it says would never be done with.
constexpr double kNothing = 1e-6;

/// A uniform cut with what it stores, and between what its deviation lies. Object units.
struct CutBracket {
  MeshId mesh;
  double threshold = 0.0, stored = 0.0;
  double rounding = 0.0;        ///< of the positions that were measured
  double lower = 0.0;           ///< a distance that was met; 0: none but small ones
  double upper = 0.0;           ///< nothing is farther
  Vec3d worst{0.0};             ///< where `lower` was met
  bool is_of_source = true;     ///< `worst` is a point of the source, and else of the cut
  std::uint64_t undecided = 0;  ///< pieces that may be farther than `lower` and than what is stored
  [[nodiscard]] bool is_above(double limit) const { return lower > limit * stored + rounding; }
  /// Whether it is above what is stored was not found out.
  [[nodiscard]] bool is_undecided() const {
    return !is_above(1.0) && upper > stored * (1.0 + 2.0 * kNothing) + rounding;
  }
  /// A deviation over what is stored; 0 where it is nothing but rounding.
  [[nodiscard]] double ratio_of(double deviation) const {
    if (deviation <= rounding) return 0.0;
    return stored > 0.0 ? deviation / stored : HUGE_VAL;
  }
};

/// Up to `cuts` uniform cuts of a mesh, evenly in the logarithm of the error, and before them the cut at 0 where a
/// group says that it does not deviate; each another one. A single one is in the middle of the errors. kAllCuts: each
/// that there is. Clusters are decoded cut by cut. Errors: as run::load_page().
[[nodiscard]] Result<std::vector<CutBracket>> bracket_cuts(const run::Asset& asset, MeshId mesh,
                                                           const scene::SourceMesh& source, std::uint32_t cuts,
                                                           std::uint32_t budget);

/// bracket_cuts() of every mesh whose tier promises something; of one with an aggregate what is none. A `measured` cut
/// fails where more than 1 + kMeasuredShortfall is met, a `certified` one above 1.
[[nodiscard]] std::vector<CutBracket> check_deviations(const run::Asset& asset, const scene::Scene& source,
                                                       std::uint32_t cuts, std::uint32_t budget, RuleLog& log);

}  // namespace meshlode::judge
