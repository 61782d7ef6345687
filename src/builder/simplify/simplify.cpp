// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/simplify.h"

#include <utility>

#include "builder/simplify/border_rule.h"
#include "builder/simplify/simplify_once.h"

namespace meshlode::builder {

namespace {

SimplifyAttempt simplify_once(const SimplifyInput& input, const SimplifyOptions& options) {
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
  return simplify_and_keep_border(input, options, simplify_once);
}

SimplifyResult simplify_and_keep_border(
    const SimplifyInput& input, const SimplifyOptions& options,
    const std::function<SimplifyAttempt(const SimplifyInput&, const SimplifyOptions&)>& once) {
  SimplifyAttempt attempt = once(input, options);
  if (attempt.keeps_border) return std::move(attempt.result);
  // Where the link condition was broken, or vertices came to lie on each other, the border can be another one. Under
  // the condition it seldom is; where its vertices do not move, never.
  SimplifyOptions careful = options;
  careful.may_relax_topology = false;
  if (!options.keep_topology) attempt = once(input, careful);  // else it was careful before
  if (attempt.keeps_border) return std::move(attempt.result);
  SimplifyResult result = once(with_locked_border(input), careful).result;
  if (keeps_locked_border(input, result)) return result;
  // Vertices of a locked border that the grid left no border edge at, and that nothing held.
  result.triangles.clear();
  result.reason = StuckReason::kBorder;
  return result;
}

}  // namespace meshlode::builder
