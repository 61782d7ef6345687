// SPDX-License-Identifier: GPL-3.0-or-later
// Aggregates against the truth: a uniform cut covers as much of a picture as level 0 does, at the pixel size that it
// was chosen by (V208). Internal to the judge.
#pragma once

#include <cstdint>

#include "judge/metrics/coverage.h"
#include "judge/validate/rules.h"
#include "run/read/asset.h"

namespace meshlode::judge {

// What a cut may be off by. A group's error promises 20% of noise in the builder's directions; these are others.
constexpr double kMostCoverageRms = 0.22, kMostCoverageMean = 0.02, kMostCoverageContrast = 1.25;

struct CoverageTotals {
  std::uint64_t cuts = 0;                                               ///< measured
  double rms = 0.0, mean = 0.0, contrast = 0.0, worst_direction = 0.0;  ///< the largest of any cut
};

/// V208 for every mesh that has an aggregate, at so many pixel sizes.
CoverageTotals check_coverage(const run::Asset& asset, std::uint32_t sizes, RuleLog& log);

}  // namespace meshlode::judge
