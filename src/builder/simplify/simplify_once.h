// SPDX-License-Identifier: GPL-3.0-or-later
// One run of the simplifier over a group, with the care and for the number of attributes that are asked.
#pragma once

#include <cstddef>
#include <functional>

#include "builder/simplify/border_rule.h"
#include "builder/simplify/group_simplifier.h"
#include "builder/simplify/simplify.h"
#include "scene/scene.h"

namespace meshlode::builder {

inline constexpr std::size_t kMostAttributes = 3 + 2 * scene::kMaxUvSets + 4;

struct SimplifyAttempt {
  SimplifyResult result;
  bool keeps_border = false;
};

template <class Numbers, std::size_t Capacity>
[[nodiscard]] SimplifyAttempt simplify_once_with(const SimplifyInput& input, const SimplifyOptions& options) {
  GroupSimplifier<Numbers, Capacity> simplifier(input, options);
  simplifier.run();
  SimplifyAttempt attempt{simplifier.result()};
  attempt.keeps_border = (!simplifier.has_free_border() || keeps_border(input, attempt.result)) &&
                         keeps_locked_border(input, attempt.result);
  return attempt;
}

/// simplify_group() by runs of `once`: again with more held where a run does not keep the border.
[[nodiscard]] SimplifyResult simplify_and_keep_border(
    const SimplifyInput& input, const SimplifyOptions& options,
    const std::function<SimplifyAttempt(const SimplifyInput&, const SimplifyOptions&)>& once);

}  // namespace meshlode::builder
