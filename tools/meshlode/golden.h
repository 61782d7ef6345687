// SPDX-License-Identifier: GPL-3.0-or-later
// `compare --golden DIR`: assets against pictures that were stored of them, for pipelines that keep no older assets.
#pragma once

#include <string>
#include <vector>

#include <meshlode/result.h>

#include "app/budget/judge_budget.h"
#include "bulk.h"
#include "compare_folder.h"
#include "draw_views.h"

namespace meshlode::cli {

struct GoldenOptions {
  std::string folder;       ///< of the stored pictures, PLACE.CAMERA.png
  bool is_updated = false;  ///< they are written, not compared
};

/// Without --fail-if: pictures are equal.
constexpr const char* kGoldenBudget = "any(pictures).differing_pixels>0";

struct GoldenCommand {
  GoldenOptions golden;
  std::vector<app::Condition> budget;
  ViewOptions views;
  OutputOptions output;
};

/// One asset. A picture that is not there or has another size is a check that failed.
[[nodiscard]] FileOutcome compare_with_golden(const BulkInput& input, const GoldenCommand& command,
                                              CompareFolder& folder);

/// Adds to the files of whole folders the stored pictures, PLACE.CAMERA.png, that none of them has: with an empty
/// `path`, and the picture as `source`. Error: kIo.
[[nodiscard]] Status add_orphans(const GoldenCommand& command, std::vector<BulkInput>& files);

}  // namespace meshlode::cli
