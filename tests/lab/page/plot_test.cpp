// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "lab/page/palette.h"
#include "lab/page/well_formed.h"

namespace meshlode::lab::page {
namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

Plot plot_of(std::vector<Series> series) {
  Plot plot;
  plot.id = "p";
  plot.title = "Title";
  plot.description = "What it shows";
  plot.x = {"across", "seconds"};
  plot.y = {"up", "bytes"};
  plot.series = std::move(series);
  return plot;
}

std::string marker(std::size_t look) {
  Markup svg;
  draw_marker(svg, look, 0.0, 0.0, nullptr);
  return svg.str();
}

TEST(Plot, FortyLooksDifferWithoutColour) {
  std::set<std::string> with_colour, shapes;
  for (std::size_t look = 0; look < 40; ++look) {
    with_colour.insert("s" + std::to_string(look % kSeriesColours) + marker(look));
    if (look < 20) shapes.insert(marker(look));
  }
  EXPECT_EQ(with_colour.size(), 40U);
  EXPECT_EQ(shapes.size(), 20U) << "ten shapes, filled and hollow";
}

TEST(Plot, DrawsAMarkerForEachPointAndOneInTheLegend) {
  const std::string svg = draw_plot(
      plot_of({{"one", 0, Drawn::kMarkers, {{1, 1, {}, {}, "a", "id-a"}, {2, 3, {}, {}, "b", "id-b"}}, false}}),
      Standing::kInPage);
  EXPECT_EQ(find_fault(svg), "");
  EXPECT_EQ(count_of(svg, "class=\"mark\""), 3U);
  EXPECT_EQ(count_of(svg, "data-point=\"id-a\""), 1U);
  EXPECT_NE(svg.find("role=\"img\""), std::string::npos);
  EXPECT_NE(svg.find("aria-labelledby=\"p-title p-desc\""), std::string::npos);
}

TEST(Plot, DrawsSpreadsWhereThereAreSome) {
  const std::string svg = draw_plot(
      plot_of({{"one", 0, Drawn::kMarkers, {{1, 1, {0.9, 1.2}, {}, "", ""}, {2, 3, {2, 2}, {}, "", ""}}, false}}),
      Standing::kInPage);
  EXPECT_EQ(count_of(svg, "class=\"spread\""), 1U);
}

TEST(Plot, LinesDifferByTheirDashes) {
  const std::vector<PlotPoint> points = {{1, 1, {}, {}, "", ""}, {2, 2, {}, {}, "", ""}};
  std::set<std::string> dashes;
  for (std::size_t look = 0; look < 5; ++look) {
    const std::string svg = draw_plot(plot_of({{"x", look, Drawn::kLine, points, false}}), Standing::kInPage);
    const std::string name = "stroke-dasharray=\"";
    const std::size_t at = svg.find(name);
    ASSERT_NE(at, std::string::npos);
    dashes.insert(svg.substr(at + name.size(), svg.find('"', at + name.size()) - at - name.size()));
  }
  EXPECT_EQ(dashes.size(), 5U);
}

TEST(Plot, HostileTextsStayTexts) {
  Plot plot = plot_of({{"</svg><script>", 0, Drawn::kMarkers, {{1, 1, {}, {}, "</title>\"'", "\"><b>"}}, false}});
  plot.title = "<a>";
  plot.x.label = "&";
  const std::string svg = draw_plot(plot, Standing::kAlone);
  EXPECT_EQ(find_fault(svg), "");
  EXPECT_EQ(svg.find("<script>"), std::string::npos);
}

TEST(Plot, TakesAnyNumbers) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::string svg = draw_plot(
      plot_of({{"x",
                0,
                Drawn::kLineAndMarkers,
                {{infinity, 1, {}, {}, "", ""}, {1, -infinity, {}, {}, "", ""}, {1e300, -1e300, {}, {}, "", ""}},
                false}}),
      Standing::kInPage);
  EXPECT_EQ(find_fault(svg), "");
  EXPECT_EQ(count_of(svg, "class=\"mark\""), 2U) << "one point and the legend's";
  for (const char* bad : {"nan", "inf"}) EXPECT_EQ(svg.find(bad), std::string::npos);
  EXPECT_EQ(find_fault(draw_plot(plot_of({}), Standing::kAlone)), "");
}

TEST(Plot, AloneHasItsColoursInIt) {
  const std::string svg = draw_plot(plot_of({}), Standing::kAlone);
  EXPECT_EQ(svg.find("var("), std::string::npos);
  EXPECT_NE(svg.find("prefers-color-scheme:dark"), std::string::npos);
  EXPECT_NE(svg.find("xmlns=\"http://www.w3.org/2000/svg\""), std::string::npos);
}

/// Relative luminance and contrast as WCAG 2 defines them.
double channel(const std::string& colour, std::size_t at) {
  const double c = std::stoi(colour.substr(at, 2), nullptr, 16) / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double luminance(const std::string& colour) {
  return 0.2126 * channel(colour, 1) + 0.7152 * channel(colour, 3) + 0.0722 * channel(colour, 5);
}
double contrast(const std::string& a, const std::string& b) {
  const double x = luminance(a), y = luminance(b);
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

TEST(Palette, EveryColourCanBeSeenOnThePaper) {
  for (const char* theme : {"light", "dark"}) {
    const std::string css = palette_properties();
    const std::string set = css.substr(css.find(std::string("{color-scheme:") + theme));
    const auto colour = [&](const std::string& name) {
      return set.substr(set.find("--" + name + ":") + name.size() + 3, 7);
    };
    for (const char* text : {"ink", "soft", "accent", "good", "bad"}) {
      EXPECT_GE(contrast(colour(text), colour("paper")), 4.5) << theme << " " << text;
      EXPECT_GE(contrast(colour(text), colour("panel")), 4.5) << theme << " " << text << " on the panel";
    }
    for (std::size_t i = 0; i < kSeriesColours; ++i) {
      EXPECT_GE(contrast(colour("s" + std::to_string(i)), colour("paper")), 3.0) << theme << " " << i;
    }
  }
}

TEST(Palette, NamesNoColourThatIsNone) {
  const std::string properties = palette_properties();
  const std::string css = std::string(page_css()) + std::string(plot_css());
  for (std::size_t at = css.find("var(--"); at != std::string::npos; at = css.find("var(--", at + 1)) {
    const std::size_t begin = at + 6, end = css.find_first_of("),", begin);
    const std::string name = css.substr(begin, end - begin);
    if (name == "at") continue;  // the slider's
    EXPECT_NE(properties.find("--" + name + ":"), std::string::npos) << name;
  }
}

TEST(Plot, LabelsStandWhereThereIsRoomAndNowhereElse) {
  Plot plot;
  plot.id = "labels";
  Series series;
  for (const auto& [x, y, label] :
       {std::tuple(0.0, 0.0, "low"), std::tuple(1.0, 1.0, "high"), std::tuple(0.5, 0.5, "middle")}) {
    series.points.push_back({x, y, {}, {}, "", "", label});
  }
  plot.series = {series};
  std::string svg = draw_plot(plot, Standing::kInPage);
  for (const char* label : {">low</text>", ">high</text>", ">middle</text>"})
    EXPECT_EQ(count_of(svg, label), 1U) << label;
  // Many points in one place: right, left, above and below of it, and no fifth label.
  plot.series[0].points.assign(20, {0.5, 0.5, {}, {}, "", "", "same"});
  plot.series[0].points.push_back({0.0, 0.0, {}, {}, "", "", std::string(100, 'w')});
  plot.series[0].points.push_back({1.0, 1.0, {}, {}, "", "", ""});
  svg = draw_plot(plot, Standing::kInPage);
  EXPECT_EQ(count_of(svg, ">same</text>"), 4U);
  EXPECT_EQ(count_of(svg, "www"), 0U) << "longer than a third of the plot";
}

}  // namespace
}  // namespace meshlode::lab::page
