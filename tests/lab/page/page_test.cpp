// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/page.h"

#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "app/page/text_forms.h"
#include "lab/page/palette.h"
#include "lab/page/pictures.h"
#include "lab/page/read_sweep.h"
#include "lab/page/sample_sweep.h"
#include "lab/page/summary.h"
#include "lab/page/well_formed.h"

namespace meshlode::lab::page {
namespace {

ReportData made_up() {
  auto data = read_sweep(made_up_sweep());
  EXPECT_TRUE(data);
  data->pictures = made_up_pictures();
  return std::move(*data);
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

TEST(Page, IsWellFormed) {
  EXPECT_EQ(find_fault(write_page(made_up())), "");
  EXPECT_EQ(find_fault(write_page(ReportData{})), "") << "of nothing";
}

TEST(Page, AsksNothingOfANetwork) {
  const std::string page = write_page(made_up());
  for (const char* way :
       {"http:", "https:", "src=\"//", "@import", "url(\"", "<link", "<iframe", "fetch(", "XMLHttp"}) {
    EXPECT_EQ(page.find(way), std::string::npos) << way;
  }
  EXPECT_EQ(count_of(page, "src=\""), count_of(page, "src=\"data:image/png;base64,"));
  for (const PlotFile& file : write_plots(made_up())) {
    EXPECT_EQ(count_of(file.svg, "http"), 1U) << file.name << ": the namespace";
    EXPECT_NE(file.svg.find("xmlns=\"http://www.w3.org/2000/svg\""), std::string::npos);
  }
}

TEST(Page, IsTheSameForTheSameData) {
  EXPECT_EQ(write_page(made_up()), write_page(made_up()));
}

TEST(Page, NoNameGetsOutOfItsPlace) {
  const std::string name = "</script></style></title>\"'><img src=x onerror=alert(1)>&\x01\xFF\xE2\x80\xAE";
  ReportData data = made_up();
  for (std::string* text : {&data.scene_file, &data.command, &data.machine, &data.system, &data.program_id,
                            &data.scene_hash, &data.vulkan_reason, &data.views[0].name, &data.recommendations[0].want,
                            &data.recommendations[0].why, &data.left_out[0].label, &data.knobs[1].title,
                            &data.metrics[0].title, &data.metrics[0].description, &data.metrics[4].title}) {
    *text = name;
  }
  app::Diagnosis& fault = data.scene_faults->ranked[0];
  for (std::string* text :
       {&fault.id, &fault.title, &fault.remedy, &fault.hard_case, &fault.places[0].where, &fault.places[0].detail,
        &fault.places[0].costs[0].kind, &fault.places[0].costs[0].unit, &data.scene_faults->command}) {
    *text = name;
  }
  for (Point& point : data.points) {
    point.label = name;
    point.command = name;
    point.draw_command = name;
    for (ByteShare& section : point.sections) section.name = name;
    for (CutPicture& picture : point.pictures) picture.view = name;
  }
  const std::string page = write_page(data);
  EXPECT_EQ(find_fault(page), "");
  EXPECT_EQ(page.find("<img src=x"), std::string::npos);
  EXPECT_EQ(count_of(page, "</script>"), 1U);
  EXPECT_EQ(count_of(page, "</style>"), 1U);
  EXPECT_EQ(page.find("\xE2\x80\xAE"), std::string::npos) << "U+202E";
  for (const PlotFile& file : write_plots(data)) EXPECT_EQ(find_fault(file.svg), "") << file.name;
}

TEST(Page, EveryPlotHasATableAndACommand) {
  const std::string page = write_page(made_up());
  const std::size_t plots = count_of(page, "<svg ");
  EXPECT_GE(plots, 6U);
  EXPECT_EQ(count_of(page, "<figure class=\"chart\">"), plots);
  EXPECT_EQ(count_of(page, "<summary>The numbers: "), plots);
  EXPECT_GE(count_of(page, "<p class=\"command\">"), plots);
  EXPECT_EQ(count_of(page, "role=\"img\" aria-labelledby="), plots);
  EXPECT_EQ(write_plots(made_up()).size(), plots);
}

TEST(Page, SaysHowItWasMeasured) {
  const std::string page = write_page(made_up());
  for (const char* fact : {"a machine that was made up, 2 threads, 8.59 GB", "meshlode 0.0.0, made up",
                           "69,451 triangles", "1, 200,000 samples each way",
                           "meshlode sweep made-up.glb -o report --budget 5m", "none: this sweep was made up"}) {
    EXPECT_NE(page.find(fact), std::string::npos) << fact;
  }
}

TEST(Page, SaysWhatTheSceneItselfCallsFor) {
  ReportData data = made_up();
  std::string page = write_page(data);
  for (const char* part :
       {"<strong>triangles much longer than high</strong> (high, 34%; <code>needles</code>), 6,000 in all",
        "<bdi>mesh 3 &#39;made up&#39;</bdi>: 1,000 triangles; costs bytes (about 1,234 of the asset)",
        "<li>and 2 more</li>", "What to do: remesh.",
        "the hard case <code>needles</code> of docs/reference/hard-cases.md",
        "<strong>meshes that no node draws</strong> (low; <code>undrawn-meshes</code>)<",
        "<code>meshlode doctor made-up.glb</code>", "href=\"#doctor\""}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(page.find("mesh 4 &#39;made"), std::string::npos) << "the command tells the rest";
  data.scene_faults->ranked.clear();
  page = write_page(data);
  EXPECT_NE(page.find("Nothing was found in the source"), std::string::npos);
  data.scene_faults.reset();
  EXPECT_NE(write_page(data).find("The scene was not examined."), std::string::npos);
}

TEST(Page, PicturesAreInItOnceAndWithinTheBudget) {
  const ReportData data = made_up();
  const std::string page = write_page(data);
  for (const auto& [path, png] : data.pictures) EXPECT_EQ(count_of(page, app::encode_base64(png)), 1U) << path;
  PageOptions options;
  options.most_picture_bytes = 1;
  const std::string small = write_page(data, options);
  EXPECT_EQ(count_of(small, "data:image/png"), 1U) << "the full resolution alone";
  EXPECT_NE(small.find("3 more pictures lie beside this page"), std::string::npos);
}

Metric metric_of(const char* key, bool is_timed) {
  Metric metric;
  metric.key = metric.title = key;
  metric.is_timed = is_timed;
  return metric;
}

Point point_of(const char* label, double bytes, Figure seconds, double deviation, double flip) {
  Point point;
  point.id = point.label = label;
  if (label != std::string("baseline")) point.changed = {label};
  point.figures = {{"file_bytes", {bytes, bytes, bytes}},
                   {"build_user_seconds", seconds},
                   {"deviation", {deviation, deviation, deviation}},
                   {"flip", {flip, flip, flip}}};
  return point;
}

TEST(Summary, ChoosesTheSmallestTheFastestAndTheMostAccurate) {
  ReportData data;
  data.metrics = {metric_of("file_bytes", false), metric_of("build_user_seconds", true), metric_of("deviation", false),
                  metric_of("flip", false)};
  data.points = {point_of("baseline", 100.0, {2.0, 2.0, 2.0, 1, Figure::Range{1.5, 2.5}}, 1e-4, 500.0),
                 point_of("small", 90.0, {3.0, 3.0, 3.0, 1, Figure::Range{2.6, 3.4}}, 1e-4, 500.0),
                 point_of("quick", 100.0, {1.8, 1.8, 1.8, 1, Figure::Range{1.4, 2.2}}, 1e-4, 600.0),
                 point_of("exact", 100.0, {9.0, 9.0, 9.0, 1, Figure::Range{8.0, 10.0}}, 1.00001e-4, 400.0),
                 point_of("trial", 1.0, {0.1, 0.1, 0.1, 1, Figure::Range{0.1, 0.1}}, 0.0, 1.0)};
  data.points.back().is_experimental = true;
  data.points.push_back(point_of("drawn finer", 100.0, {2.0, 2.0, 2.0, 1, Figure::Range{0.1, 0.2}}, 1e-4, 1.0));
  data.points.back().changed = {"pixel_error"};
  const std::vector<Card> cards = choose_cards(data);
  ASSERT_EQ(cards.size(), 3U);
  EXPECT_EQ(cards[0].point->label, "small");
  EXPECT_EQ(cards[1].point->label, "baseline") << "its range meets that of the quickest, and it changes nothing";
  EXPECT_EQ(cards[1].as_good, std::vector<std::string>{"quick"});
  EXPECT_EQ(cards[2].point->label, "exact") << "deviations alike to a thousandth: the better picture";
  EXPECT_TRUE(choose_cards(ReportData{}).empty());
}

TEST(Summary, IsTheFirstScreenAndTheRestIsFolded) {
  const std::string page = write_page(made_up());
  EXPECT_EQ(count_of(page, "<article class=\"card\""), 3U);
  EXPECT_LT(page.find("id=\"summary\""), page.find("<details class=\"fold\">"));
  EXPECT_EQ(count_of(page, "<details class=\"fold\">") + 1, count_of(page, "<section id="));
}

TEST(Page, ScriptAndStylesAreXmlAsTheyStand) {
  for (const std::string_view text : {page_script(), page_css(), plot_css()}) {
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(text.find_first_of("<&"), std::string_view::npos);
  }
}

TEST(Page, Base64IsThatOfTheStandard) {
  const auto encoded = [](const std::string& text) {
    return app::encode_base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(encoded(""), "");  // RFC 4648, section 10
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xFF\xEF\xBE"), "/+++");
}

TEST(Page, ReportsAreAPageAndItsPlots) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "meshlode-page-test";
  std::filesystem::remove_all(folder);
  OutputFiles files;
  ASSERT_TRUE(write_report(made_up(), folder, files));
  EXPECT_TRUE(std::filesystem::is_regular_file(folder / "index.html"));
  std::set<std::string> names;
  for (const PlotFile& file : write_plots(made_up())) {
    EXPECT_TRUE(names.insert(file.name).second) << file.name;
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / "plots" / file.name)) << file.name;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace meshlode::lab::page
