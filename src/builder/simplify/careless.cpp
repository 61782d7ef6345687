// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/careless.h"

namespace meshlode::builder {

namespace {

template <class RealOfQuadrics, bool has_fallback>
struct CarelessNumbers {
  using Real = RealOfQuadrics;
  static constexpr bool kHasFallback = has_fallback;
};

}  // namespace

// For the largest number of attributes alone: nobody waits for a study.
SimplifyAttempt simplify_carelessly(const SimplifyInput& input, const SimplifyOptions& options) {
  const Care& care = options.experiment.care;
  if (care.double_quadrics) return simplify_once_with<CarelessNumbers<double, false>, kMostAttributes>(input, options);
  if (care.fallback) return simplify_once_with<CarelessNumbers<float, true>, kMostAttributes>(input, options);
  return simplify_once_with<CarelessNumbers<float, false>, kMostAttributes>(input, options);
}

}  // namespace meshlode::builder
