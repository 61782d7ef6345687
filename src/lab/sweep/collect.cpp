// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/collect.h"

#include <array>
#include <map>
#include <span>
#include <string>
#include <utility>

namespace meshlode::lab {

namespace {

using Values = std::map<std::string, std::vector<double>>;

void add_values(const Measurement* measurement, Values& values) {
  if (measurement == nullptr) return;
  for (const auto& [key, value] : measurement->figures) values[key].push_back(value);
}

void collect_point(const State& state, std::uint32_t rounds, std::span<const Knob> knobs, PointResult& one) {
  const std::string built = build_key(knobs, one.point), drawn = settings_key(knobs, one.point);
  one.is_done = false;
  one.error.clear();
  one.figures.clear();
  one.asset = state.find(MeasurementKind::kAsset, built);
  one.drawn = state.find(MeasurementKind::kDraw, drawn);
  const Measurement* first = state.find(MeasurementKind::kBuild, built, 1);
  for (const Measurement* m : {first, one.asset, one.drawn, state.find(MeasurementKind::kFrames, drawn, 1)}) {
    if (m != nullptr && one.error.empty()) one.error = m->error;
  }
  const bool is_measured = first != nullptr && one.asset != nullptr && one.drawn != nullptr;
  one.is_done = one.is_chosen && (is_measured || !one.error.empty());
  if (!one.is_done) return;
  one.is_from_state = is_measured && one.asset->is_stored && one.drawn->is_stored;
  Values values;
  add_values(one.asset, values);
  add_values(one.drawn, values);
  for (std::uint32_t round = 1; round <= rounds; ++round) {
    add_values(state.find(MeasurementKind::kBuild, built, round), values);
    add_values(state.find(MeasurementKind::kFrames, drawn, round), values);
  }
  for (auto& [key, all] : values) one.figures[key] = figure_of(std::move(all));
}

/// What people ask first.
constexpr std::array<const char*, 4> kUsualWishes{"deviation<=1e-4, bytes min", "deviation<=1e-3, bytes min",
                                                  "deviation<=1e-3, time min", "normal<=1, bytes min"};

struct Axes {
  const char *x, *y;
};
constexpr std::array<Axes, 6> kFrontiers{{{"build_user_seconds", "triangles_at_max"},
                                          {"build_user_seconds", "file_bytes"},
                                          {"file_bytes", "deviation"},
                                          {"file_bytes", "triangles_at_max"},
                                          {"file_bytes", "decode_seconds"},
                                          {"frame_cpu_seconds", "flip"}}};

void place(std::vector<std::size_t>& indices, const std::vector<std::size_t>& places) {
  for (std::size_t& i : indices) i = places[i];
}

void recommend(const std::vector<Wish>& wishes, std::span<const Candidate> candidates,
               const std::vector<std::size_t>& places, bool needs_point, SweepResult& result) {
  for (const Wish& wish : wishes) {
    Answer answer = answer_wish(candidates, wish);
    if (needs_point && !answer.point && answer.not_compared.empty()) continue;
    if (answer.point) answer.point = places[*answer.point];
    place(answer.as_good, places);
    place(answer.not_compared, places);
    result.recommendations.push_back({wish, std::move(answer)});
  }
}

}  // namespace

std::vector<Candidate> candidates_of(const SweepResult& result, std::vector<std::size_t>& places) {
  std::vector<Candidate> candidates;
  places.clear();
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const PointResult& one = result.points[i];
    if (!one.is_done || !one.error.empty()) continue;
    candidates.push_back({&one.figures, changed_knobs(result.knobs, one.point).size(),
                          build_key(result.knobs, one.point), is_experimental(result.knobs, one.point)});
    places.push_back(i);
  }
  return candidates;
}

void collect_results(const State& state, std::uint32_t rounds, SweepResult& result) {
  for (PointResult& one : result.points) {
    collect_point(state, rounds, result.knobs, one);
    const bool is_to_come = one.is_chosen && !result.is_complete;
    one.reason = is_to_come ? LeftOutReason::kInterrupted : LeftOutReason::kBudget;
  }
}

void answer_all(const std::vector<Wish>& wishes, SweepResult& result) {
  std::vector<std::size_t> places;
  const std::vector<Candidate> candidates = candidates_of(result, places);
  result.dominated_by.assign(result.points.size(), {});
  std::vector<std::vector<std::size_t>> dominators = find_dominators(candidates);
  for (std::size_t i = 0; i < dominators.size(); ++i) {
    place(dominators[i], places);
    result.dominated_by[places[i]] = std::move(dominators[i]);
  }
  result.frontiers.clear();
  for (const Axes& axes : kFrontiers) {
    Frontier frontier{find_metric(axes.x), find_metric(axes.y), {}};
    frontier.points = find_frontier(candidates, *frontier.x, *frontier.y);
    place(frontier.points, places);
    if (!frontier.points.empty()) result.frontiers.push_back(std::move(frontier));
  }
  result.recommendations.clear();
  if (!wishes.empty()) return recommend(wishes, candidates, places, false, result);
  std::vector<Wish> usual;
  for (const char* text : kUsualWishes) {
    if (auto wish = parse_wish(text)) usual.push_back(std::move(*wish));
  }
  recommend(usual, candidates, places, true, result);
}

}  // namespace meshlode::lab
