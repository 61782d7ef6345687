// SPDX-License-Identifier: GPL-3.0-or-later
// I7: stored errors against the truth, by measuring whole cuts (V206). Internal to the judge.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "judge/metrics/metrics.h"
#include "judge/validate/rules.h"
#include "run/decode/decode.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// How far a `measured` error may fall short of the true deviation.
constexpr double kMeasuredShortfall = 0.05;

/// Errors to cut at: 0 where a group says that, and from the smallest positive to the largest finite one, evenly in the
/// logarithm. One alone is in the middle; 0 only where there is no other.
[[nodiscard]] std::vector<double> spread_thresholds(std::span<const format::GroupRecord> groups, std::uint32_t count);

/// What decoded positions may be off by: the last bits of doubles as large as they are, and of what is worked out from
/// them. A flat cut deviates by that and stores 0.
[[nodiscard]] double position_rounding(const format::MeshRecord& mesh);

/// A uniform cut with what it stores and what it was found to deviate by. Object units.
struct CutDeviation {
  double threshold = 0.0, stored = 0.0;
  LargestDeviation truth;  ///< a: the source, b: the cut
  double rounding = 0.0;   ///< of the positions that were measured
  [[nodiscard]] bool is_above(double limit) const { return truth.max > limit * stored + rounding; }
  /// True over stored; 0 where the true deviation is nothing but rounding.
  [[nodiscard]] double ratio() const {
    if (truth.max <= rounding) return 0.0;
    return stored > 0.0 ? truth.max / stored : HUGE_VAL;
  }
};

/// Up to `cuts` uniform cuts of a mesh, evenly in the logarithm of the error, and before them the cut at 0 where a
/// group says that it does not deviate; each another one. A single one is in the middle of the errors. `samples` are
/// area-uniform samples each way. Clusters are decoded cut by cut. Errors: as run::load_page().
[[nodiscard]] Result<std::vector<CutDeviation>> measure_cuts(const run::Asset& asset, MeshId mesh,
                                                             const scene::SourceMesh& source, std::uint32_t cuts,
                                                             std::uint64_t samples);

struct DeviationTotals {
  std::uint64_t cuts = 0;      ///< measured
  std::uint64_t exceeded = 0;  ///< true deviation above the stored error, by however little
  double worst = 0.0;          ///< largest true / stored
  double median = 0.0;         ///< of true / stored
};

/// Largest and median; neither changes where there is none.
void summarize(std::vector<double> ratios, DeviationTotals& totals);

/// measure_cuts() of every mesh whose tier promises something; of one with an aggregate the other part, against its
/// level 0. A `measured` cut fails above 1 + kMeasuredShortfall, a
/// `certified` one above 1.
DeviationTotals check_deviations(const run::Asset& asset, const scene::Scene& source, std::uint32_t cuts,
                                 std::uint64_t samples, RuleLog& log);

}  // namespace meshlode::judge
