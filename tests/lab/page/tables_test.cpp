// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/tables.h"

#include <string>

#include <gtest/gtest.h>

#include "lab/page/charts.h"
#include "lab/page/well_formed.h"

namespace meshlode::lab::page {
namespace {

/// A baseline and one value of a knob.
ReportData two_points() {
  ReportData data;
  data.baseline = "a";
  data.knobs = {{"codec", "codec", "--codec", "", "zstd", {"zstd", "none"}}};
  data.metrics = {{"build_user_seconds", "build", "seconds", "build", "", true, true},
                  {"file_bytes", "file", "bytes", "size", "", true, false},
                  {"deviation", "deviation", "share", "accuracy", "", true, false}};
  Point base, other;
  base.id = "a";
  base.label = "baseline";
  base.settings["codec"] = "zstd";
  base.figures["build_user_seconds"] = {2.0, 1.9, 2.2, 3, Figure::Range{1.9, 2.2}};
  base.figures["file_bytes"] = {1000.0, 1000.0, 1000.0, 1, {}};
  other = base;
  other.id = "b";
  other.label = "codec none";
  other.changed = {"codec"};
  other.settings["codec"] = "none";
  other.figures["build_user_seconds"] = {2.3, 2.1, 2.4, 3, Figure::Range{2.1, 2.4}};
  other.figures["file_bytes"] = {1250.0, 1250.0, 1250.0, 1, {}};
  data.points = {base, other};
  return data;
}

TEST(Tables, ClaimNothingInsideTheSpread) {
  const ReportData data = two_points();
  const auto tables = tabulate_knobs(data);
  ASSERT_EQ(tables.size(), 1U);
  ASSERT_EQ(tables[0].rows.size(), 2U);
  const std::vector<Cell>& cells = tables[0].rows[1].cells;
  EXPECT_EQ(cells[0].text, "none");
  EXPECT_EQ(cells[1].note, "≈") << "2.1 to 2.4 s overlaps 1.9 to 2.2 s";
  EXPECT_EQ(cells[2].note, "+25%") << "bytes are exact";
  EXPECT_EQ(cells[3].text, "-") << "not measured";
}

TEST(Tables, SayAChangeBeyondTheSpread) {
  ReportData data = two_points();
  data.points[1].figures["build_user_seconds"] = {4.0, 3.9, 4.1, 3, Figure::Range{3.9, 4.1}};
  EXPECT_EQ(tabulate_knobs(data)[0].rows[1].cells[1].note, "×2");
}

TEST(Tables, OneMeasurementIsComparedByTheRangeThatTheSweepGivesItOrNotAtAll) {
  ReportData data = two_points();
  data.points[1].figures["build_user_seconds"] = {9.0, 9.0, 9.0, 1, Figure::Range{6.7, 11.3}};
  EXPECT_EQ(tabulate_knobs(data)[0].rows[1].cells[1].note, "×4.5");
  data.points[1].figures["build_user_seconds"] = {2.5, 2.5, 2.5, 1, Figure::Range{1.8, 3.2}};
  EXPECT_EQ(tabulate_knobs(data)[0].rows[1].cells[1].note, "≈");
  data.points[1].figures["build_user_seconds"] = {9.0, 9.0, 9.0, 1, {}};
  EXPECT_EQ(tabulate_knobs(data)[0].rows[1].cells[1].note, "not compared");
}

TEST(Tables, AKnobThatWasNotTurnedHasNone) {
  ReportData data = two_points();
  data.points.pop_back();
  EXPECT_TRUE(tabulate_knobs(data).empty());
}

TEST(Tables, FailedPointsSayWhy) {
  ReportData data = two_points();
  data.points[1].error = "out of memory";
  EXPECT_EQ(tabulate_points(data).rows[1].cells[0].note, "failed: out of memory");
  EXPECT_TRUE(tabulate_knobs(data).empty());
}

TEST(Tables, NotablePointsAreThoseThatMatterAndNoAssetTwice) {
  ReportData data = two_points();
  data.points.push_back(data.points[1]);
  data.points[2].id = "c";
  data.points[0].content_hash = "x";
  data.points[1].content_hash = data.points[2].content_hash = "y";
  data.recommendations.push_back({"", "", "", "c", {}, {}, {}});
  data.frontiers.push_back({"file_bytes", "deviation", {"b", "a", "nowhere"}});
  const auto points = notable_points(data, 9);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0]->id, "a");
  EXPECT_EQ(points[1]->id, "c");
  EXPECT_EQ(notable_points(data, 1).size(), 1U);
}

TEST(Tables, WrittenHaveWhatTheScriptSortsBy) {
  Markup html;
  write_table(html,
              {"<caption>", {{"name"}, {"n", true}}, {{{{"<b>", {}, {}}, {"1.2 kB", 1234.5, "2 times"}}, "id\""}}});
  EXPECT_EQ(find_fault(html.str()), "");
  EXPECT_NE(html.str().find("<td class=\"number\" data-sort=\"1234.5\"><bdi>1.2 kB</bdi>"), std::string::npos)
      << html.str();
  EXPECT_NE(html.str().find("<th scope=\"row\" data-sort=\"\"><bdi>&lt;b&gt;</bdi>"), std::string::npos) << html.str();
  EXPECT_NE(html.str().find("data-point=\"id&quot;\""), std::string::npos);
}

TEST(Charts, AFrontierHasALineAndEveryPointItsKnob) {
  ReportData data = two_points();
  data.points[0].figures["deviation"] = {1e-4, 1e-4, 1e-4, 1};
  data.points[1].figures["deviation"] = {0.0, 0.0, 0.0, 1};
  data.frontiers.push_back({"file_bytes", "deviation", {"a", "b"}});
  const auto charts = chart_frontiers(data);
  ASSERT_EQ(charts.size(), 1U);
  ASSERT_EQ(charts[0].plot.series.size(), 3U);
  EXPECT_EQ(charts[0].plot.series[0].name, "baseline") << "on top";
  EXPECT_EQ(charts[0].plot.series[1].name, "codec");
  EXPECT_EQ(charts[0].plot.series[2].name, "frontier");
  EXPECT_EQ(charts[0].plot.series[2].points.size(), 2U);
  EXPECT_EQ(charts[0].table.rows.size(), 2U);
}

TEST(Charts, WithoutFrontiersShowAccuracyAgainstTimeAndBytes) {
  const auto charts = chart_frontiers(two_points());
  ASSERT_EQ(charts.size(), 2U);
  EXPECT_EQ(charts[0].plot.title, "Deviation against build");
  EXPECT_EQ(charts[1].plot.title, "Deviation against file");
}

TEST(Charts, ErrorDistributionsReachAHundredPercentOfTheirTier) {
  ReportData data = two_points();
  data.points[0].settings["error"] = "measured";
  data.points[1].settings["error"] = "qem";
  for (int i = 1; i <= 4; ++i) {
    data.points[0].cuts.push_back({0.0, 1.0, 0.25 * i, 0.0, 10});
    data.points[1].cuts.push_back({0.0, 1.0, 0.75 * i, 0.0, 10});
  }
  const Chart chart = chart_error_distribution(data);
  ASSERT_EQ(chart.plot.series.size(), 2U);
  EXPECT_EQ(chart.plot.series[0].name, "measured");
  EXPECT_EQ(chart.plot.series[0].points.back().x, 1.0);
  EXPECT_EQ(chart.plot.series[0].points.back().y, 100.0);
  EXPECT_EQ(chart.table.rows[0].cells[5].number, 0.0) << "none above what is stored";
  EXPECT_EQ(chart.table.rows[1].cells[5].number, 3.0) << "1.5, 2.25 and 3 of 0.75, 1.5, 2.25, 3";
}

}  // namespace
}  // namespace meshlode::lab::page
