// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/summary.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lab/page/charts.h"
#include "lab/page/numbers.h"
#include "lab/page/parts.h"

namespace meshlode::lab::page {

namespace {

constexpr double kSame = 1e-3;  ///< a share of a figure below which two of them are the same to a reader

/// What a figure is compared by. \pre a timed one has a range
Figure::Range range_of(const Figure& figure, bool is_timed) {
  if (is_timed) return *figure.range;
  const double slack = 0.5 * kSame * std::abs(figure.value);
  return {figure.value - slack, figure.value + slack};
}

/// The best points by one metric, the one that changes fewest settings first.
std::vector<const Point*> best_points(const std::vector<const Point*>& points, const Metric& metric) {
  const double sign = metric.is_less_better ? 1.0 : -1.0;
  std::optional<double> best;
  Figure::Range bound;
  std::vector<const Point*> measured;
  for (const Point* point : points) {
    const Figure* const figure = find_figure(*point, metric.key);
    if (figure == nullptr || (metric.is_timed && !figure->range)) continue;  // without a range: not compared
    measured.push_back(point);
    if (best && sign * figure->value >= *best) continue;
    best = sign * figure->value;
    bound = range_of(*figure, metric.is_timed);
  }
  std::erase_if(measured, [&](const Point* point) {
    const Figure::Range range = range_of(*find_figure(*point, metric.key), metric.is_timed);
    return range.low > bound.high || range.high < bound.low;
  });
  std::stable_sort(measured.begin(), measured.end(),
                   [](const Point* a, const Point* b) { return a->changed.size() < b->changed.size(); });
  return measured;
}

void write_card(Markup& html, const ReportData& data, const Card& card) {
  const Point& point = *card.point;
  html.open("article", {{"class", "card"}, {"data-point", point.id}});
  html.element("h3", card.title).open("p").open("strong").name(point.label).close().close();
  html.open("dl").line();
  for (const char* key : {"file_bytes", "build_user_seconds", "deviation", "triangles_at_max", "flip"}) {
    const Metric* const metric = data.find_metric(key);
    const Figure* const figure = find_figure(point, key);
    if (metric == nullptr || figure == nullptr) continue;
    html.element("dt", metric->title).element("dd", amount_text(figure->value, metric->unit)).line();
  }
  html.close();
  write_command(html, "Build it", point.command);
  if (!card.as_good.empty()) {
    html.open("details").element("summary", "As good within the spread: " + std::to_string(card.as_good.size()));
    write_paragraph(html, joined(card.as_good) + ".");
    html.close();
  }
  html.close().line();
}

}  // namespace

std::vector<Card> choose_cards(const ReportData& data) {
  std::vector<const Point*> points;
  for (const Point& point : data.points) {
    const bool is_drawn_otherwise =
        std::find(point.changed.begin(), point.changed.end(), "pixel_error") != point.changed.end();
    if (!point.is_experimental && !point.error && !is_drawn_otherwise) points.push_back(&point);
  }
  struct Goal {
    const char* title;
    std::vector<const char*> keys;  ///< the next one decides between the best by those before
  };
  // Largest deviations are those of level 0, which most points share: the picture at one pixel of error decides then.
  const Goal goals[] = {{"Smallest file", {"file_bytes"}},
                        {"Fastest build", {"build_user_seconds"}},
                        {"Most accurate", {"deviation", "flip"}}};
  std::vector<Card> cards;
  for (const Goal& goal : goals) {
    Card card{goal.title, nullptr, nullptr, {}};
    std::vector<const Point*> best = points;
    for (const char* key : goal.keys) {
      const Metric* const metric = data.find_metric(key);
      if (metric == nullptr) continue;
      std::vector<const Point*> better = best_points(best, *metric);
      if (better.empty()) continue;
      best = std::move(better);
      if (card.metric == nullptr) card.metric = metric;
    }
    if (card.metric == nullptr) continue;
    card.point = best.front();
    for (std::size_t i = 1; i < best.size(); ++i) card.as_good.push_back(best[i]->label);
    cards.push_back(std::move(card));
  }
  return cards;
}

void write_summary(Markup& html, const ReportData& data) {
  html.open("div", {{"class", "glance"}}).line();
  const std::vector<Chart> charts = chart_frontiers(data);
  if (!charts.empty()) write_chart(html, charts.front(), data.command);
  html.open("div", {{"class", "cards"}}).line();
  for (const Card& card : choose_cards(data)) write_card(html, data, card);
  html.close().line().close().line();
}

}  // namespace meshlode::lab::page
