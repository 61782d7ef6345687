// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace meshlode::test::hard {

double between(double low, double high, bool is_whole) {
  if (!std::isfinite(low) || !std::isfinite(high)) return low;
  const double middle = low > 0.0 && high > 0.0 ? std::sqrt(low) * std::sqrt(high) : 0.5 * (low + high);
  if (!is_whole) return middle;
  // Of 127 and 129 it is 128: floor() alone would find nothing there.
  return std::clamp(std::floor(middle), std::min({low + 1.0, high + 1.0, std::max(low, high)}), std::max(low, high));
}

namespace {

struct Point {
  double at;
  Verdict verdict;
  std::string detail;
};

using TryAt = std::function<Point(double)>;

/// What lies between two points of different verdicts, until they are near to each other: into `points`, in order.
void refine(const Point& low, const Point& high, int steps, bool is_whole, const TryAt& try_at,
            std::vector<Point>& points) {
  if (steps == 0 || low.verdict == high.verdict) return;
  const double middle = between(low.at, high.at, is_whole);
  if (middle == low.at || middle == high.at) return;
  const Point point = try_at(middle);  // between two verdicts may lie a third
  refine(low, point, steps - 1, is_whole, try_at, points);
  points.push_back(point);
  refine(point, high, steps - 1, is_whole, try_at, points);
}

}  // namespace

Swept sweep_case(const HardCase& hard_case, const Ask& ask, const Closeness& closeness, bool only_first) {
  Swept swept;
  swept.hard_case = &hard_case;
  swept.easy = ask(hard_case.sweep.front(), true);
  std::vector<Point> points{{hard_case.sweep.front(), swept.easy.verdict, swept.easy.detail}};
  const TryAt try_at = [&](double parameter) {
    const Trial trial = ask(parameter, false);
    return Point{parameter, trial.verdict, trial.detail};
  };
  for (std::size_t i = 1; i < hard_case.sweep.size() && !only_first; ++i) {
    const Point last = points.back(), next = try_at(hard_case.sweep[i]);
    refine(last, next, closeness.steps, hard_case.is_whole, try_at, points);
    points.push_back(next);
  }
  for (const Point& point : points) {
    if (swept.stretches.empty() || swept.stretches.back().verdict != point.verdict) {
      swept.stretches.push_back({point.at, point.at, point.verdict, point.detail});
    } else {
      swept.stretches.back().to = point.at;
    }
  }
  return swept;
}

}  // namespace meshlode::test::hard
