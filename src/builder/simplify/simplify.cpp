// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/simplify.h"

#include <utility>

#include "builder/simplify/border_rule.h"
#include "builder/simplify/careless.h"
#include "builder/simplify/openmesh_decimater.h"
#include "builder/simplify/simplify_once.h"

namespace meshlode::builder {

namespace {

SimplifyAttempt simplify_once(const SimplifyInput& input, const SimplifyOptions& options) {
  const Care& care = options.experiment.care;
  if (!care.double_quadrics || !care.fallback) return simplify_carelessly(input, options);
  // Quadrics of few attributes are small, and copying them is most of the work.
  const std::uint32_t attributes = input.layout.stride();
  if (attributes == 0) return simplify_once_with<CarefulNumbers, 0>(input, options);
  if (attributes == 2) return simplify_once_with<CarefulNumbers, 2>(input, options);
  if (attributes == 3) return simplify_once_with<CarefulNumbers, 3>(input, options);
  if (attributes <= 5) return simplify_once_with<CarefulNumbers, 5>(input, options);
  return simplify_once_with<CarefulNumbers, kMostAttributes>(input, options);
}

}  // namespace

SimplifyResult simplify_group(const SimplifyInput& input, const SimplifyOptions& options) {
  if (options.experiment.simplifier == Simplifier::kOpenMesh) return simplify_group_by_openmesh(input, options);
  SimplifyAttempt attempt = simplify_once(input, options);
  if (attempt.keeps_border) return std::move(attempt.result);
  // Where the link condition was broken, or vertices came to lie on each other, the border can be another one. Under
  // the condition it seldom is; where its vertices do not move, never.
  SimplifyOptions careful = options;
  careful.may_relax_topology = false;
  if (!options.keep_topology) attempt = simplify_once(input, careful);  // else it was careful before
  if (attempt.keeps_border) return std::move(attempt.result);
  SimplifyResult result = simplify_once(with_locked_border(input), careful).result;
  if (keeps_locked_border(input, result)) return result;
  // Vertices of a locked border that the grid left no border edge at, and that nothing held.
  result.triangles.clear();
  result.reason = StuckReason::kBorder;
  return result;
}

}  // namespace meshlode::builder
