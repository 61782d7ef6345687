// SPDX-License-Identifier: GPL-3.0-or-later
// I7: stored errors against the truth, by measuring whole cuts (V206). Internal to the judge.
#pragma once

#include <cstdint>
#include <span>

#include "decode/decode.h"
#include "mesh/scene.h"
#include "validate/rules.h"

namespace meshlode {

/// How far a `measured` error may fall short of the true deviation.
constexpr double kMeasuredShortfall = 0.05;

struct DeviationTotals {
  std::uint64_t cuts = 0;      ///< measured
  std::uint64_t exceeded = 0;  ///< true deviation above the stored error, by however little
  double worst = 0.0;          ///< largest true / stored
  double median = 0.0;         ///< of true / stored
};

/// `cuts` uniform cuts of every mesh whose tier promises something, evenly in the logarithm of the error. A `measured`
/// cut fails above 1 + kMeasuredShortfall, a `certified` one above 1. `samples` are area-uniform samples each way.
DeviationTotals check_deviations(const Asset& asset, const Scene& source, std::span<const DecodedCluster> clusters,
                                 std::uint32_t cuts, std::uint64_t samples, RuleLog& log);

}  // namespace meshlode
