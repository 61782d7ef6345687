// SPDX-License-Identifier: GPL-3.0-or-later
// What an asset promises besides positions against the truth, by measuring whole cuts in the product space of
// positions, UVs and normals (V209). Internal to the judge.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <meshlode/format.h>

#include "judge/metrics/product_distance.h"
#include "judge/validate/rules.h"
#include "judge/verify/deviations.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// A uniform cut with what it stores and what it was found to deviate by, by samples.
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

/// Level 0, and up to `cuts` uniform cuts by its errors. Object units of the product
/// space. Errors: as run::load_page(). \pre the asset has the promise
[[nodiscard]] Result<std::vector<CutDeviation>> measure_promised_cuts(const run::Asset& asset, MeshId mesh,
                                                                      const scene::SourceMesh& source,
                                                                      format::Promise promise, std::uint32_t cuts,
                                                                      std::uint64_t samples);

struct DeviationTotals {
  std::uint64_t cuts = 0;      ///< measured
  std::uint64_t exceeded = 0;  ///< true deviation above the stored error, by however little
  double worst = 0.0;          ///< largest true / stored
  double median = 0.0;         ///< of true / stored
};

/// V209 for one promise: every mesh that is no aggregate, in every tier: where positions are estimated, promises are
/// measured. A cut fails above 1 + kMeasuredShortfall times what it stores, a `certified` one above 1.
/// \pre the asset has the promise
DeviationTotals check_promise(const run::Asset& asset, const scene::Scene& source, format::Promise promise,
                              std::uint32_t cuts, std::uint64_t samples, RuleLog& log);

/// V210: what UVs and normals count as is what the source's surface, its textures and its diagonal say. A UV set is not
/// judged where an image's size is not known. \pre the asset has promises
void check_promise_units(const run::Asset& asset, const scene::Scene& source, RuleLog& log);

}  // namespace meshlode::judge
