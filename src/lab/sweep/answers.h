// SPDX-License-Identifier: GPL-3.0-or-later
// What the figures of all points say: which are dominated, which lie on a frontier, which keeps a wish. No claim is
// made inside the spread of what was measured: figures whose ranges touch are equal (range_of). A time without a spread
// is not compared, so it makes nobody equal either.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/budget/conditions.h"
#include "lab/sweep/metrics.h"

namespace meshlode::lab {

/// A measured point as far as answers look at it.
struct Candidate {
  const Figures* figures = nullptr;
  std::size_t changes = 0;       ///< knobs that differ from the baseline
  std::string asset;             ///< what it is known by: points that draw one asset in several ways share it
  bool is_experimental = false;  ///< never recommended
};

/// For each candidate those that are no worse in any of build_user_seconds, file_bytes, deviation and triangles_at_max
/// and clearly better in one. Nobody is dominated by, or dominates, who lacks one of these or cannot be compared in it.
[[nodiscard]] std::vector<std::vector<std::size_t>> find_dominators(std::span<const Candidate> candidates);

/// Those that no other is clearly better than in one metric and no worse in the other, by ascending x. Whoever cannot
/// be compared in both is left out.
[[nodiscard]] std::vector<std::size_t> find_frontier(std::span<const Candidate> candidates, const Metric& x,
                                                     const Metric& y);

/// "deviation<=1e-4, bytes min": bounds between commas, and what is then made least or most.
struct Wish {
  struct Bound {
    const Metric* metric = nullptr;
    app::Relation relation = app::Relation::kLessEqual;  ///< ordered
    double value = 0.0;
  };
  std::string text;
  std::vector<Bound> bounds;
  const Metric* goal = nullptr;
};
/// The text is hostile. Errors: kUsage with what was expected; a goal whose better side is the other one.
[[nodiscard]] Result<Wish> parse_wish(std::string_view text);

struct Answer {
  std::optional<std::size_t> point;
  std::vector<std::size_t> as_good;       ///< other assets within the spread of the goal: no claim is made between them
  std::vector<std::size_t> not_compared;  ///< keep all bounds, as far as is known; their goal was timed once
  std::string why;
};
/// A bound is kept where every measurement keeps it. Of those as good as the best the one that changes least, then the
/// first.
[[nodiscard]] Answer answer_wish(std::span<const Candidate> candidates, const Wish& wish);

}  // namespace meshlode::lab
