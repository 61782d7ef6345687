// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader of a sweep sees first: accuracy against time, and the smallest, the fastest and the most accurate point
// with the command of each.
#pragma once

#include <string>
#include <vector>

#include "lab/page/markup.h"
#include "lab/page/report_data.h"

namespace meshlode::lab::page {

struct Card {
  std::string title;  ///< "Smallest file"
  const Metric* metric = nullptr;
  const Point* point = nullptr;
  std::vector<std::string> as_good;  ///< labels of points that the measurements do not distinguish from it
};

/// Of the points that were measured and that settings of a build alone make, experiments left out. Where ranges of a
/// timed figure overlap, or figures differ by less than a thousandth, the point that changes fewest settings is taken.
/// Empty where nothing was measured.
[[nodiscard]] std::vector<Card> choose_cards(const ReportData& data);

/// The first chart of accuracy and the cards.
void write_summary(Markup& html, const ReportData& data);

}  // namespace meshlode::lab::page
