// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/simplify.h"

#include <utility>

#include "builder/simplify/border_rule.h"
#include "builder/simplify/group_simplifier.h"

namespace meshlode::builder {

namespace {

struct Attempt {
  SimplifyResult result;
  bool keeps_border = false;
};

template <class Real, std::size_t Capacity>
Attempt simplify_with(const SimplifyInput& input, const SimplifyOptions& options) {
  GroupSimplifier<Real, Capacity> simplifier(input, options);
  simplifier.run();
  Attempt attempt{simplifier.result()};
  attempt.keeps_border = (!simplifier.has_free_border() || keeps_border(input, attempt.result)) &&
                         keeps_locked_border(input, attempt.result);
  return attempt;
}

template <class Real>
Attempt simplify_in(const SimplifyInput& input, const SimplifyOptions& options) {
  // Quadrics of few attributes are small, and copying them is most of the work.
  const std::uint32_t attributes = input.layout.stride();
  if (attributes <= 3) return simplify_with<Real, 3>(input, options);
  if (attributes <= 5) return simplify_with<Real, 5>(input, options);
  return simplify_with<Real, 3 + 2 * scene::kMaxUvSets + 4>(input, options);
}

Attempt simplify_once(const SimplifyInput& input, const SimplifyOptions& options) {
  return options.double_quadrics ? simplify_in<double>(input, options) : simplify_in<float>(input, options);
}

}  // namespace

SimplifyResult simplify_group(const SimplifyInput& input, const SimplifyOptions& options) {
  Attempt attempt = simplify_once(input, options);
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
