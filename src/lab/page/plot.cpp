// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "lab/page/numbers.h"
#include "lab/page/palette.h"

namespace meshlode::lab::page {

namespace {

constexpr double kWidth = 480.0, kPlotHeight = 270.0, kTop = 14.0, kRight = 24.0, kLeft = 76.0, kBelow = 46.0;
constexpr double kLegendRow = 19.0, kMarker = 4.6;
constexpr std::array<const char*, 5> kDashes = {"none", "7 3", "2 3", "9 3 2 3", "4 2"};

struct Place {
  double x = 0.0, y = 0.0;
};

struct Frame {
  Axis x, y;
  [[nodiscard]] double across(double value) const { return kLeft + x.place(value) * (kWidth - kLeft - kRight); }
  [[nodiscard]] double down(double value) const { return kTop + (1.0 - y.place(value)) * kPlotHeight; }
  [[nodiscard]] Place at(const PlotPoint& point) const { return {across(point.x), down(point.y)}; }
};

bool is_shown(const PlotPoint& point) {
  return std::abs(point.x) <= 1e300 && std::abs(point.y) <= 1e300;
}

std::string at(double x, double y) {
  return coordinate(x) + "," + coordinate(y);
}

/// A polygon whose corners lie on a circle, the first one at `turn` from the top; each second corner nearer to the
/// middle where `inner` is below 1.
std::string ring(double x, double y, int corners, double turn, double inner, double radius) {
  std::string points;
  for (int i = 0; i < corners; ++i) {
    const double angle = turn + 2.0 * std::numbers::pi * i / corners;
    const double r = i % 2 == 1 ? radius * inner : radius;
    points += (i == 0 ? "" : " ") + at(x + r * std::sin(angle), y - r * std::cos(angle));
  }
  return points;
}

/// Ten shapes; nothing is a circle.
std::optional<std::string> marker_polygon(std::size_t shape, double x, double y) {
  constexpr double kEighth = std::numbers::pi / 4.0, kHalf = std::numbers::pi;
  switch (shape % 10) {
    case 1: return ring(x, y, 4, kEighth, 1.0, kMarker * 1.25);  // square
    case 2: return ring(x, y, 3, 0.0, 1.0, kMarker * 1.35);      // triangle
    case 3: return ring(x, y, 4, 0.0, 1.0, kMarker * 1.35);      // diamond
    case 4: return ring(x, y, 3, kHalf, 1.0, kMarker * 1.35);    // triangle, point down
    case 5: return ring(x, y, 8, 0.0, 0.25, kMarker * 1.5);      // star of four
    case 6: return ring(x, y, 8, kEighth, 0.25, kMarker * 1.5);  // the same, turned
    case 7: return ring(x, y, 10, 0.0, 0.45, kMarker * 1.4);     // star of five
    case 8: return ring(x, y, 3, kHalf / 2.0, 1.0, kMarker * 1.35);
    case 9: return ring(x, y, 6, 0.0, 1.0, kMarker * 1.1);  // hexagon
    default: return std::nullopt;
  }
}

/// Series' names from left to right, then in the next row.
struct LegendEntry {
  std::size_t series = 0;
  double x = 0.0;
  std::size_t row = 0;
};

std::vector<LegendEntry> arrange_legend(const std::vector<Series>& series) {
  std::vector<LegendEntry> entries;
  double x = kLeft;
  std::size_t row = 0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (series[i].name.empty()) continue;
    const double width = 30.0 + text_width(series[i].name) + 14.0;
    if (x > kLeft && x + width > kWidth) {
      x = kLeft;
      ++row;
    }
    entries.push_back({i, x, row});
    x += width;
  }
  return entries;
}

void draw_line(Markup& svg, const char* style, double x1, double y1, double x2, double y2) {
  svg.empty("line", {{"class", style},
                     {"x1", coordinate(x1)},
                     {"y1", coordinate(y1)},
                     {"x2", coordinate(x2)},
                     {"y2", coordinate(y2)}});
}

void draw_text(Markup& svg, const char* style, double x, double y, std::string_view text) {
  svg.element("text", text, {{"class", style}, {"x", coordinate(x)}, {"y", coordinate(y)}});
}

/// Values with their ticks: zero too, where a log axis shows it.
std::vector<std::pair<double, std::string>> labelled_ticks(const Axis& axis) {
  std::vector<std::pair<double, std::string>> ticks;
  if (axis.scale == Scale::kLog && axis.has_zero) ticks.emplace_back(0.0, "0");
  for (const double tick : axis.ticks) ticks.emplace_back(tick, amount_text(tick, axis.unit));
  return ticks;
}

void draw_axes(Markup& svg, const Frame& frame) {
  const double bottom = kTop + kPlotHeight, end = kWidth - kRight;
  double last_end = -1.0;
  for (const auto& [value, text] : labelled_ticks(frame.x)) {
    const double x = frame.across(value), half = text_width(text) / 2.0;
    draw_line(svg, "grid", x, kTop, x, bottom);
    if (x - half < last_end + 5.0) continue;  // its grid line alone
    draw_text(svg, "tick across", std::min(x, kWidth - half), bottom + 16.0, text);
    last_end = x + half;
  }
  for (const auto& [value, text] : labelled_ticks(frame.y)) {
    const double y = frame.down(value);
    draw_line(svg, "grid", kLeft, y, end, y);
    draw_text(svg, "tick up", kLeft - 7.0, y + 4.0, text);
  }
  draw_line(svg, "axis", kLeft, bottom, end, bottom);
  draw_line(svg, "axis", kLeft, kTop, kLeft, bottom);
  draw_text(svg, "label across", (kLeft + end) / 2.0, bottom + 36.0, frame.x.label);
  svg.element("text", frame.y.label,
              {{"class", "label across"},
               {"transform", "translate(13 " + coordinate(kTop + kPlotHeight / 2.0) + ") rotate(-90)"}});
}

std::string path_of(const Frame& frame, const Series& series) {
  std::string path;
  std::optional<Place> last;
  for (const PlotPoint& point : series.points) {
    if (!is_shown(point)) continue;
    const Place place = frame.at(point);
    if (last && series.drawn == Drawn::kSteps) path += "H" + coordinate(place.x);
    path += (last ? "L" : "M") + at(place.x, place.y);
    last = place;
  }
  return path;
}

std::string look_class(const Series& series) {
  return series.is_plain ? "plain" : "s" + std::to_string(series.look % kSeriesColours);
}

std::string dashes_of(const Series& series) {
  return series.is_plain ? "5 4" : kDashes[series.look % kDashes.size()];
}

void draw_spreads(Markup& svg, const Frame& frame, const PlotPoint& point) {
  const Place place = frame.at(point);
  if (point.x_spread.high > point.x_spread.low) {
    draw_line(svg, "spread", frame.across(point.x_spread.low), place.y, frame.across(point.x_spread.high), place.y);
  }
  if (point.y_spread.high > point.y_spread.low) {
    draw_line(svg, "spread", place.x, frame.down(point.y_spread.low), place.x, frame.down(point.y_spread.high));
  }
}

void draw_series(Markup& svg, const Frame& frame, const Series& series) {
  svg.open("g", {{"class", look_class(series)}});
  if (series.drawn != Drawn::kMarkers) {
    const std::string path = path_of(frame, series);
    if (!path.empty()) svg.empty("path", {{"class", "curve"}, {"stroke-dasharray", dashes_of(series)}, {"d", path}});
  }
  if (series.drawn == Drawn::kMarkers || series.drawn == Drawn::kLineAndMarkers) {
    for (const PlotPoint& point : series.points) {
      if (!is_shown(point)) continue;
      draw_spreads(svg, frame, point);
      const Place place = frame.at(point);
      draw_marker(svg, series.look, place.x, place.y, &point);
    }
  }
  svg.close().line();
}

struct Extent {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;

  [[nodiscard]] bool meets(const Extent& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

/// Of a marker with its spread.
Extent marks_of(const Frame& frame, const PlotPoint& point) {
  const Place place = frame.at(point);
  Extent box{place.x - kMarker, place.y - kMarker, place.x + kMarker, place.y + kMarker};
  if (point.x_spread.high > point.x_spread.low) {
    box.left = std::min(box.left, frame.across(point.x_spread.low));
    box.right = std::max(box.right, frame.across(point.x_spread.high));
  }
  if (point.y_spread.high > point.y_spread.low) {
    box.top = std::min(box.top, frame.down(point.y_spread.high));
    box.bottom = std::max(box.bottom, frame.down(point.y_spread.low));
  }
  return box;
}

/// Right of its marker, left of it, above, below, or right and left a little higher: the first place where a label
/// meets neither marks nor labels nor the border. One without such a place is left out; its marker has a title.
void draw_labels(Markup& svg, const Frame& frame, const std::vector<Series>& series) {
  constexpr double kAscent = 10.0, kDescent = 3.0, kGap = 4.0, kLongest = 160.0;
  std::vector<const PlotPoint*> points;
  std::vector<Extent> taken;
  for (const Series& one : series) {
    for (const PlotPoint& point : one.points) {
      if (!is_shown(point) || point.label.empty()) continue;
      points.push_back(&point);
      taken.push_back(marks_of(frame, point));
    }
  }
  for (const PlotPoint* point : points) {
    const Place place = frame.at(*point);
    const Extent marks = marks_of(frame, *point);
    const double width = text_width(point->label), middle = place.x - width / 2.0, beside = place.y + 4.0;
    if (width > kLongest) continue;
    const Place tried[] = {{marks.right + kGap, beside},          {marks.left - kGap - width, beside},
                           {middle, marks.top - kGap - kDescent}, {middle, marks.bottom + kGap + kAscent},
                           {marks.right + kGap, place.y - kGap},  {marks.left - kGap - width, place.y - kGap}};
    for (const Place& base : tried) {
      const Extent box{base.x, base.y - kAscent, base.x + width, base.y + kDescent};
      const bool is_inside =
          box.left >= kLeft && box.right <= kWidth && box.top >= 0.0 && box.bottom <= kTop + kPlotHeight;
      const bool is_free =
          std::none_of(taken.begin(), taken.end(), [&](const Extent& other) { return box.meets(other); });
      if (!is_inside || !is_free) continue;
      taken.push_back(box);
      draw_text(svg, "tick", base.x, base.y, point->label);
      break;
    }
  }
  svg.line();
}

void draw_legend(Markup& svg, const Plot& plot, const std::vector<LegendEntry>& entries) {
  for (const LegendEntry& entry : entries) {
    const Series& series = plot.series[entry.series];
    const double y = kTop + kPlotHeight + kBelow + 12.0 + kLegendRow * static_cast<double>(entry.row);
    svg.open("g", {{"class", look_class(series)}});
    if (series.drawn != Drawn::kMarkers) {
      svg.empty(
          "path",
          {{"class", "curve"}, {"stroke-dasharray", dashes_of(series)}, {"d", "M" + at(entry.x, y - 4.0) + "h24"}});
    }
    if (series.drawn == Drawn::kMarkers || series.drawn == Drawn::kLineAndMarkers) {
      draw_marker(svg, series.look, entry.x + 12.0, y - 4.0, nullptr);
    }
    svg.close();
    draw_text(svg, "key", entry.x + 30.0, y, series.name);
  }
  if (!entries.empty()) svg.line();
}

Frame fit_frame(const Plot& plot) {
  std::vector<double> xs, ys;
  for (const Series& series : plot.series) {
    for (const PlotPoint& point : series.points) {
      if (!is_shown(point)) continue;
      xs.push_back(point.x);
      ys.push_back(point.y);
      if (point.x_spread.high > point.x_spread.low) xs.insert(xs.end(), {point.x_spread.low, point.x_spread.high});
      if (point.y_spread.high > point.y_spread.low) ys.insert(ys.end(), {point.y_spread.low, point.y_spread.high});
    }
  }
  if (plot.has_diagonal) {  // the same axis twice, so that it is one
    xs.insert(xs.end(), ys.begin(), ys.end());
    ys = xs;
  }
  return {fit_axis(plot.x, xs), fit_axis(plot.y, ys)};
}

}  // namespace

double text_width(std::string_view text) {
  double width = 0.0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0) == 0x80) continue;  // inside a character
    const bool is_narrow = std::string_view("iljtf.,:;'|!() ").find(c) != std::string_view::npos;
    const bool is_wide = c == 'm' || c == 'w' || (c >= 'A' && c <= 'Z');
    width += is_narrow ? 4.4 : is_wide ? 9.6 : 7.6;
  }
  return width;
}

void open_svg(Markup& svg, const std::string& id, const std::string& title, const std::string& description,
              double width, double height, Standing standing) {
  const std::string w = coordinate(width), h = coordinate(height);
  if (standing == Standing::kAlone) {
    svg.open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                     {"viewBox", "0 0 " + w + " " + h},
                     {"width", w},
                     {"height", h},
                     {"class", "plot alone"},
                     {"role", "img"},
                     {"aria-labelledby", id + "-title " + id + "-desc"}});
  } else {
    svg.open("svg", {{"viewBox", "0 0 " + w + " " + h},
                     {"class", "plot"},
                     {"role", "img"},
                     {"aria-labelledby", id + "-title " + id + "-desc"}});
  }
  svg.line().element("title", title, {{"id", id + "-title"}}).element("desc", description, {{"id", id + "-desc"}});
  svg.line();
  if (standing == Standing::kAlone) {
    svg.open("style").raw("\n").raw(css_for_itself(plot_css())).close().line();
    svg.empty("rect", {{"class", "paper"}, {"width", w}, {"height", h}}).line();
  }
}

void draw_marker(Markup& svg, std::size_t look, double x, double y, const PlotPoint* point) {
  const auto polygon = marker_polygon(look, x, y);
  // Filled and hollow in turn, so that shapes that come again do not look the same.
  const std::string style = look / 10 % 2 == 0 ? "mark" : "mark hollow";
  const std::string id = point != nullptr ? point->id : "";
  const char* const tag = polygon ? "polygon" : "circle";
  if (polygon && id.empty()) {
    svg.open(tag, {{"class", style}, {"points", *polygon}});
  } else if (polygon) {
    svg.open(tag, {{"class", style}, {"data-point", id}, {"points", *polygon}});
  } else if (id.empty()) {
    svg.open(tag, {{"class", style}, {"cx", coordinate(x)}, {"cy", coordinate(y)}, {"r", coordinate(kMarker)}});
  } else {
    svg.open(tag, {{"class", style},
                   {"data-point", id},
                   {"cx", coordinate(x)},
                   {"cy", coordinate(y)},
                   {"r", coordinate(kMarker)}});
  }
  if (point != nullptr && !point->title.empty()) svg.element("title", point->title);
  svg.close();
}

std::string draw_plot(const Plot& plot, Standing standing) {
  const Frame frame = fit_frame(plot);
  const std::vector<LegendEntry> legend = arrange_legend(plot.series);
  const double rows = legend.empty() ? 0.0 : static_cast<double>(legend.back().row + 1);
  Markup svg;
  open_svg(svg, plot.id, plot.title, plot.description, kWidth,
           kTop + kPlotHeight + kBelow + (rows > 0.0 ? 4.0 + kLegendRow * rows : 0.0), standing);
  draw_axes(svg, frame);
  svg.line();
  if (plot.has_diagonal) {
    const double low = frame.x.low, high = frame.x.high;
    svg.empty("path",
              {{"class", "curve plain"},
               {"stroke-dasharray", "5 4"},
               {"d", "M" + at(frame.across(low), frame.down(low)) + "L" + at(frame.across(high), frame.down(high))}});
    svg.line();
  }
  for (std::size_t i = plot.series.size(); i-- > 0;) draw_series(svg, frame, plot.series[i]);
  draw_labels(svg, frame, plot.series);
  draw_legend(svg, plot, legend);
  svg.close().line();
  return svg.str();
}

}  // namespace meshlode::lab::page
