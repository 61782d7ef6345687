// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/experiment/careless.h"

#include "builder/simplify/simplify_once.h"

namespace meshlode::lab {

namespace {

template <class RealOfQuadrics, bool has_fallback>
struct CarelessNumbers {
  using Real = RealOfQuadrics;
  static constexpr bool kHasFallback = has_fallback;
};

// For the largest number of attributes alone: nobody waits for a study.
template <class Real, bool has_fallback>
builder::SimplifyResult simplify_with(const builder::SimplifyInput& input, const builder::SimplifyOptions& options) {
  return builder::simplify_and_keep_border(
      input, options, builder::simplify_once_with<CarelessNumbers<Real, has_fallback>, builder::kMostAttributes>);
}

}  // namespace

builder::SimplifyGroup simplify_carelessly(const Care& care) {
  if (care.double_quadrics) return care.fallback ? builder::simplify_group : simplify_with<double, false>;
  return care.fallback ? simplify_with<float, true> : simplify_with<float, false>;
}

}  // namespace meshlode::lab
