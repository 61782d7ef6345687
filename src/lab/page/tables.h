// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of a sweep's report that stand without a plot.
#pragma once

#include <string>
#include <vector>

#include "lab/page/report_data.h"
#include "lab/page/table.h"

namespace meshlode::lab::page {

/// What each value of a knob costs against the baseline, all else equal; a table for each knob that was turned. A
/// change of a timed figure whose spread overlaps the baseline's is none: "≈".
[[nodiscard]] std::vector<Table> tabulate_knobs(const ReportData& data);

/// Every figure of every point.
[[nodiscard]] Table tabulate_points(const ReportData& data);

/// The commands that build the points and draw them.
[[nodiscard]] Table tabulate_commands(const ReportData& data);

/// What each metric is and how it was measured.
[[nodiscard]] Table tabulate_metrics(const ReportData& data);

[[nodiscard]] Table tabulate_left_out(const ReportData& data);

}  // namespace meshlode::lab::page
