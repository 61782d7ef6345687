// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/charts.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "lab/page/numbers.h"

namespace meshlode::lab::page {

namespace {

constexpr std::size_t kNotable = 6;

/// Logarithmic where the numbers span a factor of three or more, and for lengths always.
Scale scale_for(const std::vector<double>& values, const std::string& unit) {
  if (unit == "dB") return Scale::kLinear;
  double low = 0.0, high = 0.0;
  for (const double value : values) {
    if (value < 0.0) return Scale::kLinear;
    if (value == 0.0) continue;
    low = low == 0.0 ? value : std::min(low, value);
    high = std::max(high, value);
  }
  return unit == "share" || (low > 0.0 && high / low >= 3.0) ? Scale::kLog : Scale::kLinear;
}

std::string with_capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// "Deviation, largest (share of the diagonal)".
std::string axis_label(const Metric& metric) {
  const std::string title = with_capital(metric.title);
  if (metric.unit.empty() || metric.unit == "triangles" || metric.unit == "seconds" || metric.unit == "bytes") {
    return title;
  }
  return title + " (" + (metric.unit == "share" ? "share of the diagonal" : metric.unit) + ")";
}

/// "Deviation, largest, against build, wall time".
std::string title_of(const Metric& x, const Metric& y) {
  return with_capital(y.title) + (y.title.find(',') != std::string::npos ? ", against " : " against ") + x.title;
}

const Metric* first_of_group(const ReportData& data, const std::string& group, bool is_timed) {
  for (const Metric& metric : data.metrics) {
    if (metric.group == group && metric.is_timed == is_timed) return &metric;
  }
  return nullptr;
}

std::vector<Frontier> shown_pairs(const ReportData& data) {
  if (!data.frontiers.empty()) return data.frontiers;
  std::vector<Frontier> pairs;
  const Metric* const accuracy = first_of_group(data, "accuracy", false);
  for (const Metric* cost : {first_of_group(data, "build", true), first_of_group(data, "size", false)}) {
    if (accuracy != nullptr && cost != nullptr) pairs.push_back({cost->key, accuracy->key, {}});
  }
  return pairs;
}

/// Which knob a point turns: 0 none, 1 several, then the knobs in their order.
std::size_t kind_of(const ReportData& data, const Point& point) {
  if (point.id == data.baseline || point.changed.empty()) return 0;
  if (point.changed.size() > 1) return 1;
  for (std::size_t i = 0; i < data.knobs.size(); ++i) {
    if (data.knobs[i].name == point.changed[0]) return 2 + i;
  }
  return 1;
}

PlotPoint plot_point(const Point& point, const Metric& x, const Metric& y, const Figure& fx, const Figure& fy) {
  PlotPoint out;
  out.x = fx.value;
  out.y = fy.value;
  out.x_spread = {fx.low, fx.high};
  out.y_spread = {fy.low, fy.high};
  out.id = point.id;
  out.label = point.label;
  out.title = point.label + ": " + x.title + " " + amount_text(fx.value, x.unit) + ", " + y.title + " " +
              amount_text(fy.value, y.unit);
  return out;
}

Series frontier_line(const ReportData& data, const Frontier& frontier) {
  Series line;
  line.name = "frontier";
  line.is_plain = true;
  line.drawn = Drawn::kLine;
  for (const std::string& id : frontier.points) {
    const Point* const point = data.find_point(id);
    const Figure* const x = point != nullptr ? find_figure(*point, frontier.x) : nullptr;
    const Figure* const y = point != nullptr ? find_figure(*point, frontier.y) : nullptr;
    if (x != nullptr && y != nullptr) line.points.push_back({x->value, y->value, {}, {}, {}, {}});
  }
  return line;
}

Chart chart_pair(const ReportData& data, const Frontier& frontier, const Metric& x, const Metric& y) {
  const std::set<std::string> on_frontier(frontier.points.begin(), frontier.points.end());
  Chart chart;
  std::vector<Series> kinds(2 + data.knobs.size());
  kinds[0].name = "baseline";
  kinds[1].name = "several knobs";
  for (std::size_t i = 0; i < data.knobs.size(); ++i) kinds[2 + i].name = data.knobs[i].title;
  for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i].look = i;
  chart.table.columns = {{"point"}, {x.title, true}, {y.title, true}, {"on the frontier"}};
  std::vector<double> xs, ys;
  for (const Point& point : data.points) {
    const Figure* const fx = find_figure(point, x.key);
    const Figure* const fy = find_figure(point, y.key);
    if (fx == nullptr || fy == nullptr) continue;
    kinds[kind_of(data, point)].points.push_back(plot_point(point, x, y, *fx, *fy));
    xs.push_back(fx->value);
    ys.push_back(fy->value);
    const Cell membership{on_frontier.contains(point.id) ? "yes" : "no", {}, {}};
    chart.table.rows.push_back({{{point.label, {}, {}}, figure_cell(fx, x), figure_cell(fy, y), membership}, point.id});
  }
  chart.plot.id = "pair-" + std::to_string(&x - data.metrics.data()) + "-" + std::to_string(&y - data.metrics.data());
  chart.plot.title = title_of(x, y);
  chart.plot.description =
      std::to_string(chart.table.rows.size()) + " points; the table below the plot has their numbers.";
  chart.table.caption = chart.plot.title;
  chart.plot.x = {axis_label(x), x.unit, scale_for(xs, x.unit)};
  chart.plot.y = {axis_label(y), y.unit, scale_for(ys, y.unit)};
  for (Series& kind : kinds) {
    if (!kind.points.empty()) chart.plot.series.push_back(std::move(kind));
  }
  if (frontier.points.size() > 1) chart.plot.series.push_back(frontier_line(data, frontier));
  chart.reading = std::string("Better is ") + (x.is_less_better ? "left" : "right") + " and " +
                  (y.is_less_better ? "down" : "up") +
                  ". Points on the dashed line are beaten by no other in both. Bars are the spread of repeated "
                  "measurements: where they overlap there is no difference.";
  return chart;
}

/// qem, measured or certified: as the asset says, else a setting, whatever the knob is called; empty where neither
/// does.
std::string error_tier(const Point& point) {
  if (!point.error_tier.empty()) return point.error_tier;
  for (const auto& [name, value] : point.settings) {
    if (value == "qem" || value == "measured" || value == "certified") return value;
  }
  return {};
}

}  // namespace

const Figure* find_figure(const Point& point, const std::string& key) {
  const auto found = point.figures.find(key);
  return found == point.figures.end() ? nullptr : &found->second;
}

Cell figure_cell(const Figure* figure, const Metric& metric) {
  if (figure == nullptr) return {"-", {}, {}};
  Cell cell{amount_text(figure->value, metric.unit), figure->value, {}};
  if (figure->count > 1) {
    cell.note = amount_text(figure->low, metric.unit) + " to " + amount_text(figure->high, metric.unit) + ", " +
                std::to_string(figure->count) + " times";
  }
  return cell;
}

std::vector<const Point*> notable_points(const ReportData& data, std::size_t most) {
  std::vector<std::string> ids = {data.baseline};
  for (const Recommendation& one : data.recommendations) {
    if (one.point) ids.push_back(*one.point);
  }
  for (const Frontier& frontier : data.frontiers) ids.insert(ids.end(), frontier.points.begin(), frontier.points.end());
  std::vector<const Point*> points;
  std::set<std::string> seen;
  for (const std::string& id : ids) {
    const Point* const point = data.find_point(id);
    if (point == nullptr || points.size() == most) continue;
    const std::string& asset = point->content_hash.empty() ? point->id : point->content_hash;
    if (seen.insert(asset).second) points.push_back(point);
  }
  return points;
}

std::vector<Chart> chart_frontiers(const ReportData& data) {
  std::vector<Chart> charts;
  std::set<std::pair<std::string, std::string>> done;
  for (const Frontier& frontier : shown_pairs(data)) {
    const Metric* const x = data.find_metric(frontier.x);
    const Metric* const y = data.find_metric(frontier.y);
    if (x == nullptr || y == nullptr || !done.emplace(frontier.x, frontier.y).second) continue;
    charts.push_back(chart_pair(data, frontier, *x, *y));
  }
  return charts;
}

Chart chart_triangles(const ReportData& data) {
  Chart chart;
  chart.plot.id = "triangles";
  chart.plot.title = "Triangles at equal true deviation";
  chart.plot.description = "The fewest triangles whose largest true deviation is within a bound, by that bound.";
  chart.reading =
      "Each line is one asset: how many triangles a cut needs that is nowhere farther from the source than the "
      "bound. Lower is better.";
  chart.table.caption = chart.plot.title;
  chart.table.columns = {{"point"}, {"deviation at most", true}, {"triangles", true}};
  std::size_t look = 0;
  for (const Point* point : notable_points(data, kNotable)) {
    Series series{point->label, look++, Drawn::kLineAndMarkers, {}, false};
    for (const EqualDeviation& equal : point->equal) {
      if (equal.is_rms || !equal.triangles) continue;
      const double count = static_cast<double>(*equal.triangles);
      const std::string title =
          point->label + ": " + amount_text(count, "triangles") + " triangles within " + number_text(equal.deviation);
      series.points.push_back({equal.deviation, count, {}, {}, title, point->id});
      chart.table.rows.push_back({{{point->label, {}, {}},
                                   {number_text(equal.deviation), equal.deviation, {}},
                                   {amount_text(count, "triangles"), count, {}}},
                                  point->id});
    }
    std::stable_sort(series.points.begin(), series.points.end(),
                     [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
    if (!series.points.empty()) chart.plot.series.push_back(std::move(series));
  }
  chart.plot.x = {"Largest true deviation at most (share of the diagonal)", "share", Scale::kLog};
  chart.plot.y = {"Triangles", "triangles", Scale::kLog};
  return chart;
}

Chart chart_stored_errors(const ReportData& data) {
  Chart chart;
  chart.plot.id = "stored-errors";
  chart.plot.title = "True against stored error";
  chart.plot.description =
      "The true largest deviation of uniform cuts against the largest error that the asset stores for "
      "what they draw. On the dashed diagonal both are equal.";
  chart.reading =
      "Below the diagonal the stored error is on the safe side; above it the cut is farther from the source than "
      "the asset says.";
  chart.plot.has_diagonal = true;
  chart.table.caption = chart.plot.title;
  chart.table.columns = {{"point"}, {"triangles", true}, {"stored", true}, {"true", true}, {"true over stored", true}};
  std::size_t look = 0;
  for (const Point* point : notable_points(data, kNotable)) {
    Series series{point->label, look++, Drawn::kMarkers, {}, false};
    for (const Cut& cut : point->cuts) {
      const std::string title = point->label + ": stored " + number_text(cut.stored) + ", true " + number_text(cut.max);
      series.points.push_back({cut.stored, cut.max, {}, {}, title, point->id});
      const bool has_ratio = cut.stored > 0.0;
      const double count = static_cast<double>(cut.triangles), ratio = has_ratio ? cut.max / cut.stored : 0.0;
      chart.table.rows.push_back(
          {{{point->label, {}, {}},
            {amount_text(count, "triangles"), count, {}},
            {number_text(cut.stored), cut.stored, {}},
            {number_text(cut.max), cut.max, {}},
            {has_ratio ? number_text(ratio) : "-", has_ratio ? std::optional(ratio) : std::nullopt, {}}},
           point->id});
    }
    if (!series.points.empty()) chart.plot.series.push_back(std::move(series));
  }
  chart.plot.x = {"Stored error (share of the diagonal)", "share", Scale::kLog};
  chart.plot.y = {"True largest deviation (share of the diagonal)", "share", Scale::kLog};
  return chart;
}

Chart chart_error_distribution(const ReportData& data) {
  std::map<std::string, std::vector<double>> ratios;  // by tier
  std::set<std::string> seen;
  for (const Point& point : data.points) {
    if (!point.same_asset_as.empty()) continue;  // counted once
    for (const Cut& cut : point.cuts) {
      if (cut.stored > 0.0) ratios[error_tier(point)].push_back(cut.max / cut.stored);
    }
  }
  Chart chart;
  chart.plot.id = "error-distribution";
  chart.plot.title = "How true the stored errors are";
  chart.plot.description =
      "The share of all measured cuts whose true deviation is at most so many times the stored error.";
  chart.reading =
      "A line that has reached 100% left of 1 belongs to a tier that never says too little; one that rises far "
      "left of 1 says too much.";
  chart.table.caption = chart.plot.title;
  chart.table.columns = {{"error tier"},   {"cuts", true},    {"least", true},
                         {"median", true}, {"largest", true}, {"above 1", true}};
  std::size_t look = 0;
  for (auto& [tier, all] : ratios) {
    std::sort(all.begin(), all.end());
    const double count = static_cast<double>(all.size());
    const std::string name = tier.empty() ? "all" : tier;
    Series series{name, look++, Drawn::kSteps, {}, false};
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i == 0) series.points.push_back({all[i], 0.0, {}, {}, {}, {}});
      // Of equal ones the last; at most some hundreds of steps are drawn.
      const bool is_last_of_equal = i + 1 == all.size() || all[i + 1] != all[i];
      const bool is_drawn =
          all.size() <= 400 || i + 1 == all.size() || i * 400 / all.size() != (i + 1) * 400 / all.size();
      if (!is_last_of_equal || !is_drawn) continue;
      series.points.push_back({all[i], 100.0 * static_cast<double>(i + 1) / count, {}, {}, {}, {}});
    }
    chart.plot.series.push_back(std::move(series));
    const double above = static_cast<double>(all.end() - std::upper_bound(all.begin(), all.end(), 1.0));
    const double median = all[(all.size() - 1) / 2];
    chart.table.rows.push_back({{{name, {}, {}},
                                 {amount_text(count, "triangles"), count, {}},
                                 {number_text(all.front()), all.front(), {}},
                                 {number_text(median), median, {}},
                                 {number_text(all.back()), all.back(), {}},
                                 {number_text(above), above, {}}},
                                {}});
  }
  chart.plot.x = {"True over stored error", "", Scale::kLog};
  chart.plot.y = {"Cuts, % of the tier's", "", Scale::kLinear, true};
  return chart;
}

std::vector<ByteChart> chart_bytes(const ReportData& data) {
  std::vector<ByteChart> charts;
  for (const Point* point : notable_points(data, 3)) {
    if (point->sections.empty()) continue;
    ByteChart chart;
    chart.map.id = "bytes-" + std::to_string(charts.size());
    chart.map.title = "Bytes of the file: " + point->label;
    chart.map.description = "Areas in proportion to the bytes of the file's sections; the table has them.";
    chart.table.caption = chart.map.title;
    chart.table.columns = {{"section"}, {"bytes in the file", true}, {"share", true}, {"bytes decoded", true}};
    chart.command = point->command;
    double total = 0.0;
    for (const ByteShare& section : point->sections) total += static_cast<double>(section.bytes);
    for (const ByteShare& section : point->sections) {
      chart.map.parts.push_back({section.name, section.bytes});
      const double bytes = static_cast<double>(section.bytes), decoded = static_cast<double>(section.decoded_bytes);
      const double share = total > 0.0 ? 100.0 * bytes / total : 0.0;
      chart.table.rows.push_back({{{section.name, {}, {}},
                                   {amount_text(bytes, "triangles"), bytes, {}},
                                   {number_text(share) + "%", share, {}},
                                   {amount_text(decoded, "triangles"), decoded, {}}},
                                  {}});
    }
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace meshlode::lab::page
