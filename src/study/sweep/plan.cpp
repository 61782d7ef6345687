// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/sweep/plan.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <tuple>

namespace meshlode::study {

namespace {

constexpr double kFilled = 0.9;  ///< estimates are rough

}  // namespace

std::vector<PlannedPoint> plan_points(std::span<const Knob> knobs, std::span<const Point> points,
                                      const BaselineCost& cost, std::uint32_t rounds, double budget) {
  std::set<std::string> built, measured;
  const auto estimate = [&](const Point& point) {
    const double frames = cost.draw * rounds;
    if (built.contains(build_key(knobs, point))) return frames;
    const double measure = measured.contains(content_key(knobs, point)) ? 0.0 : cost.measure;
    return frames + measure + cost.build * build_factor(knobs, point) * rounds;
  };
  std::vector<PlannedPoint> plan(points.size());
  std::vector<double> alone(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    plan[i].point = i;
    alone[i] = estimate(points[i]);
  }
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(points[a].kind != PointKind::kBaseline, -points[a].worth, alone[a], a) <
           std::tuple(points[b].kind != PointKind::kBaseline, -points[b].worth, alone[b], b);
  });
  double spent = 0.0;
  for (const std::size_t i : order) {
    plan[i].estimate = estimate(points[i]);
    const bool is_within = budget <= 0.0 || spent + plan[i].estimate <= kFilled * budget;
    plan[i].is_chosen = is_within || points[i].kind == PointKind::kBaseline;
    if (!plan[i].is_chosen) continue;
    spent += plan[i].estimate;
    built.insert(build_key(knobs, points[i]));
    measured.insert(content_key(knobs, points[i]));
  }
  return plan;
}

}  // namespace meshlode::study
