// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/tables.h"

#include <set>

#include "lab/page/charts.h"
#include "lab/page/numbers.h"

namespace meshlode::lab::page {

namespace {

/// What is weighed against what when points are compared, and the first figure of each other group.
std::vector<const Metric*> main_metrics(const ReportData& data) {
  static const std::set<std::string> weighed = {"build_user_seconds", "file_bytes", "deviation", "triangles_at_max"};
  std::vector<const Metric*> metrics;
  std::set<std::string> groups;
  for (const Metric& metric : data.metrics) {
    if (weighed.contains(metric.key)) groups.insert(metric.group);
  }
  for (const Metric& metric : data.metrics) {
    if (weighed.contains(metric.key) || groups.insert(metric.group).second) metrics.push_back(&metric);
  }
  return metrics;
}

Cell change_cell(const Figure* base, const Figure* figure, const Metric& metric) {
  if (figure == nullptr) return {"-", {}, {}};
  const std::string amount = amount_text(figure->value, metric.unit);
  if (base == nullptr || base == figure) return {amount, figure->value, {}};
  if (metric.is_timed && !(figure->range && base->range)) return {amount, figure->value, "not compared"};
  const bool is_within =
      metric.is_timed && figure->range->low <= base->range->high && base->range->low <= figure->range->high;
  return {amount, figure->value, is_within ? "≈" : change_text(base->value, figure->value)};
}

Row knob_row(const std::string& value, const Point* base, const Point& point, const std::vector<const Metric*>& metrics,
             const std::string& note) {
  Row row{{{value, {}, note}}, point.id};
  for (const Metric* metric : metrics) {
    row.cells.push_back(change_cell(base != nullptr ? find_figure(*base, metric->key) : nullptr,
                                    find_figure(point, metric->key), *metric));
  }
  return row;
}

/// The point that differs from the baseline in this knob's value alone, or the baseline where that is its value.
const Point* find_one_factor(const ReportData& data, const Knob& knob, const std::string& value) {
  for (const Point& point : data.points) {
    const auto found = point.settings.find(knob.name);
    if (found == point.settings.end() || found->second != value) continue;
    if (point.id == data.baseline) return &point;
    if (point.changed.size() == 1 && point.changed[0] == knob.name) return &point;
  }
  return nullptr;
}

}  // namespace

std::vector<Table> tabulate_knobs(const ReportData& data) {
  const Point* const base = data.find_point(data.baseline);
  const std::vector<const Metric*> metrics = main_metrics(data);
  std::vector<Table> tables;
  for (const Knob& knob : data.knobs) {
    Table table;
    table.caption = knob.title + " (" + knob.option + (knob.unit.empty() ? "" : ", " + knob.unit) + ")";
    table.columns = {{"value"}};
    for (const Metric* metric : metrics) table.columns.push_back({metric->title, true});
    for (const std::string& value : knob.values) {
      const Point* const point = find_one_factor(data, knob, value);
      if (point == nullptr || point->error) continue;
      const bool is_base = point == base;
      table.rows.push_back(knob_row(value, base, *point, metrics, is_base ? "baseline" : ""));
    }
    if (table.rows.size() > 1) tables.push_back(std::move(table));
  }
  return tables;
}

Table tabulate_points(const ReportData& data) {
  Table table;
  table.caption = "All points";
  table.columns = {{"point"}, {"beaten by", true}};
  for (const Metric& metric : data.metrics) table.columns.push_back({metric.title, true});
  for (const Point& point : data.points) {
    std::string note = point.id == data.baseline ? "baseline" : "";
    if (point.is_experimental) note += note.empty() ? "experimental" : ", experimental";
    if (point.error) note = "failed: " + *point.error;
    const double beaten = static_cast<double>(point.dominated_by.size());
    Row row{{{point.label, {}, note}, {number_text(beaten), beaten, {}}}, point.id};
    for (const Metric& metric : data.metrics) row.cells.push_back(figure_cell(find_figure(point, metric.key), metric));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table tabulate_commands(const ReportData& data) {
  Table table;
  table.caption = "Commands";
  table.columns = {{"point"}, {"builds it"}, {"draws it"}};
  for (const Point& point : data.points) {
    table.rows.push_back({{{point.label, {}, {}}, {point.command, {}, {}}, {point.draw_command, {}, {}}}, point.id});
  }
  return table;
}

Table tabulate_metrics(const ReportData& data) {
  Table table;
  table.caption = "Figures";
  table.columns = {{"figure"}, {"unit"}, {"better"}, {"how it was measured"}};
  for (const Metric& metric : data.metrics) {
    const std::string unit = metric.unit == "share" ? "share of a mesh's diagonal" : metric.unit;
    table.rows.push_back({{{metric.title, {}, metric.key},
                           {unit, {}, {}},
                           {metric.is_less_better ? "less" : "more", {}, {}},
                           {metric.description, {}, {}}},
                          {}});
  }
  return table;
}

Table tabulate_left_out(const ReportData& data) {
  Table table;
  table.caption = "Planned and not measured";
  table.columns = {{"point"}, {"why"}, {"would have taken", true}, {"command"}};
  for (const LeftOut& one : data.left_out) {
    table.rows.push_back({{{one.label, {}, {}},
                           {one.reason, {}, {}},
                           {amount_text(one.estimated_seconds, "seconds"), one.estimated_seconds, {}},
                           {one.command, {}, {}}},
                          {}});
  }
  return table;
}

}  // namespace meshlode::lab::page
