// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/answers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/nearest_name.h"
#include "base/try.h"

namespace meshlode::lab {

namespace {

constexpr std::array<const char*, 4> kDomination{"build_user_seconds", "file_bytes", "deviation", "triangles_at_max"};

const Figure* find_figure(const Candidate& candidate, const Metric& metric) {
  const auto found = candidate.figures->find(metric.key);
  return found == candidate.figures->end() ? nullptr : &found->second;
}

/// Null where the figure is not there or says nothing beside others.
const Figure* find_comparable(const Candidate& candidate, const Metric& metric) {
  const Figure* figure = find_figure(candidate, metric);
  return figure != nullptr && range_of(metric, *figure) ? figure : nullptr;
}

/// No worse in any metric and clearly better in one; false where one of the two lacks a figure.
bool dominates(const Candidate& a, const Candidate& b, std::span<const Metric* const> metrics) {
  bool is_better = false;
  for (const Metric* metric : metrics) {
    const Figure *of_a = find_comparable(a, *metric), *of_b = find_comparable(b, *metric);
    if (of_a == nullptr || of_b == nullptr || is_clearly_better(*metric, *of_b, *of_a)) return false;
    is_better = is_better || is_clearly_better(*metric, *of_a, *of_b);
  }
  return is_better;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

Error wrong_wish(const std::string& detail) {
  return {ErrorCode::kUsage, "--want", detail};
}

Error unknown_metric(std::string_view word) {
  const std::vector<std::string> known = metric_words();
  return wrong_wish("unknown figure '" + std::string(word.substr(0, 64)) + "'" + nearest_or_all(word, known));
}

Result<Wish::Bound> parse_bound(std::string_view part) {
  for (const auto& [relation, name] : app::kRelationNames) {
    const std::size_t at = part.find(name);
    if (at == std::string_view::npos || !app::is_ordered(relation)) continue;
    const std::string_view word = trimmed(part.substr(0, at));
    const std::string_view number = trimmed(part.substr(at + std::string_view(name).size()));
    Wish::Bound bound;
    bound.relation = relation;
    bound.metric = find_metric(word);
    if (bound.metric == nullptr) return unknown_metric(word);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), bound.value);
    if (error != std::errc{} || end != number.data() + number.size() || !std::isfinite(bound.value)) {
      return wrong_wish("'" + std::string(number.substr(0, 64)) + "' is not a number");
    }
    return bound;
  }
  return wrong_wish("give bounds and a goal, comma-separated, such as 'deviation<=1e-4, bytes min'");
}

/// "bytes min".
Result<const Metric*> parse_goal(std::string_view part) {
  const std::string_view side = part.substr(part.size() - 3), word = trimmed(part.substr(0, part.size() - 3));
  const Metric* metric = find_metric(word);
  if (metric == nullptr) return unknown_metric(word);
  if ((side == "min") != metric->is_less_better) {
    const char* better = metric->is_less_better ? " is better the less" : " is better the more";
    return wrong_wish(std::string(metric->key) + better);
  }
  return metric;
}

bool keeps(const Wish::Bound& bound, const Figure& figure) {
  switch (bound.relation) {
    case app::Relation::kGreater: return figure.min > bound.value;
    case app::Relation::kGreaterEqual: return figure.min >= bound.value;
    case app::Relation::kLess: return figure.max < bound.value;
    default: return figure.max <= bound.value;
  }
}

bool keeps_all(const Wish& wish, const Candidate& candidate) {
  if (candidate.is_experimental || find_figure(candidate, *wish.goal) == nullptr) return false;
  return std::all_of(wish.bounds.begin(), wish.bounds.end(), [&](const Wish::Bound& bound) {
    const Figure* figure = find_figure(candidate, *bound.metric);
    return figure != nullptr && keeps(bound, *figure);
  });
}

/// Why the chosen one, of those that could be compared.
std::string reason_of(const Answer& answer, std::size_t points, std::size_t kept, bool has_assumed) {
  std::string why = std::to_string(kept) + " of " + std::to_string(points) +
                    (points == 1 ? " point keeps"
                     : kept == 1 ? " points keeps"
                                 : " points keep") +
                    " all bounds; ";
  if (kept == 1) {
    why += "this is the only one";
  } else if (answer.as_good.empty()) {
    why += answer.not_compared.empty() ? "this one is clearly the best of them"
                                       : "this one is clearly the best of those compared";
  } else {
    why += "the spread does not distinguish this one from " + std::to_string(answer.as_good.size()) + " more, ";
    why += answer.as_good.size() == 1 ? "which changes no fewer settings" : "none of which changes fewer settings";
  }
  if (has_assumed) why += "; a spread of 25% either way is assumed of what was measured once";
  const std::size_t others = answer.not_compared.size();
  if (others > 0) why += "; " + std::to_string(others) + " not compared: one round";
  return why;
}

}  // namespace

std::vector<std::vector<std::size_t>> find_dominators(std::span<const Candidate> candidates) {
  std::array<const Metric*, kDomination.size()> metrics{};
  for (std::size_t i = 0; i < metrics.size(); ++i) metrics[i] = find_metric(kDomination[i]);
  std::vector<std::vector<std::size_t>> out(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = 0; j < candidates.size(); ++j) {
      if (i != j && dominates(candidates[j], candidates[i], metrics)) out[i].push_back(j);
    }
  }
  return out;
}

std::vector<std::size_t> find_frontier(std::span<const Candidate> candidates, const Metric& x, const Metric& y) {
  const std::array<const Metric*, 2> metrics{&x, &y};
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (find_comparable(candidates[i], x) == nullptr || find_comparable(candidates[i], y) == nullptr) continue;
    const bool is_beaten = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
      return dominates(other, candidates[i], metrics);
    });
    if (!is_beaten) out.push_back(i);
  }
  std::sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) {
    const double at = find_figure(candidates[a], x)->value, bt = find_figure(candidates[b], x)->value;
    return std::tuple(at, a) < std::tuple(bt, b);
  });
  return out;
}

Result<Wish> parse_wish(std::string_view text) {
  if (text.size() > app::kMaxConditionsBytes) return wrong_wish("the wish is too long");
  Wish wish;
  wish.text = std::string(trimmed(text));
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string_view part = trimmed(text.substr(at, end - at));
    at = end + 1;
    if (part.ends_with(" min") || part.ends_with(" max")) {
      if (wish.goal != nullptr) return wrong_wish("give one goal");
      TRY_LET(goal, parse_goal(part));
      wish.goal = *goal;
      continue;
    }
    TRY_LET(bound, parse_bound(part));
    wish.bounds.push_back(*bound);
  }
  if (wish.goal == nullptr) return wrong_wish("give a goal, such as 'bytes min'");
  return wish;
}

Answer answer_wish(std::span<const Candidate> candidates, const Wish& wish) {
  Answer answer;
  std::vector<std::size_t> compared;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!keeps_all(wish, candidates[i])) continue;
    (find_comparable(candidates[i], *wish.goal) ? compared : answer.not_compared).push_back(i);
  }
  const std::size_t kept = compared.size() + answer.not_compared.size();
  if (compared.empty()) {
    answer.why = kept == 0 ? "no measured point keeps all bounds"
                           : "not compared: one round says nothing about the spread of " + std::string(wish.goal->key) +
                                 "; measure with --rounds 2 or more";
    return answer;
  }
  const auto goal_of = [&](std::size_t i) -> const Figure& { return *find_figure(candidates[i], *wish.goal); };
  const std::size_t best = *std::min_element(compared.begin(), compared.end(), [&](std::size_t a, std::size_t b) {
    return wish.goal->is_less_better ? goal_of(a).value < goal_of(b).value : goal_of(a).value > goal_of(b).value;
  });
  std::size_t chosen = best;
  for (const std::size_t i : compared) {
    if (is_clearly_better(*wish.goal, goal_of(best), goal_of(i))) continue;
    answer.as_good.push_back(i);
    if (std::tuple(candidates[i].changes, i) < std::tuple(candidates[chosen].changes, chosen)) chosen = i;
  }
  // The chosen asset, drawn in another way, is no other answer to what an asset is or costs.
  const bool is_of_pictures = std::string_view(wish.goal->group) == "picture";
  const auto is_chosen = [&](std::size_t i) {
    return i == chosen || (!is_of_pictures && candidates[i].asset == candidates[chosen].asset);
  };
  std::erase_if(answer.as_good, is_chosen);
  std::erase_if(answer.not_compared, is_chosen);
  answer.point = chosen;
  const bool has_assumed =
      std::any_of(compared.begin(), compared.end(), [&](std::size_t i) { return is_assumed(*wish.goal, goal_of(i)); });
  answer.why = reason_of(answer, candidates.size(), kept, has_assumed);
  return answer;
}

}  // namespace meshlode::lab
