// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of a sweep's report, each with the table behind it.
#pragma once

#include <string>
#include <vector>

#include "lab/page/plot.h"
#include "lab/page/report_data.h"
#include "lab/page/table.h"
#include "lab/page/treemap.h"

namespace meshlode::lab::page {

/// A plot, how to read it, and its numbers.
struct Chart {
  Plot plot;
  std::string reading;
  Table table;
};

/// One for each frontier of the data: accuracy against time, bytes against accuracy and what else it has. Where it has
/// none, the first figure of building and of size against the first of accuracy.
[[nodiscard]] std::vector<Chart> chart_frontiers(const ReportData& data);

/// Fewest triangles against true deviation, for the points that matter (notable_points). No points where nothing was
/// measured.
[[nodiscard]] Chart chart_triangles(const ReportData& data);

/// Each cut's true deviation against the error that the asset stores for it.
[[nodiscard]] Chart chart_stored_errors(const ReportData& data);

/// How the ratios of true to stored error are distributed, for each error tier that was swept.
[[nodiscard]] Chart chart_error_distribution(const ReportData& data);

struct ByteChart {
  Treemap map;
  Table table;
  std::string command;
};

/// Where the bytes of the file are: of the baseline and of what is recommended.
[[nodiscard]] std::vector<ByteChart> chart_bytes(const ReportData& data);

/// The baseline, then what is recommended, then points of frontiers, each asset once; at most `most`.
[[nodiscard]] std::vector<const Point*> notable_points(const ReportData& data, std::size_t most);

/// "1.23 s" with its note "1.2 s to 1.3 s, 3 times"; "-" where there is none.
[[nodiscard]] Cell figure_cell(const Figure* figure, const Metric& metric);

[[nodiscard]] const Figure* find_figure(const Point& point, const std::string& key);

}  // namespace meshlode::lab::page
