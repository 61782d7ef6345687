// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/plan.h"

#include <algorithm>
#include <set>
#include <string>
#include <tuple>

namespace meshlode::lab {

namespace {

constexpr double kFilled = 0.9;       ///< estimates are rough
constexpr double kFirstFilled = 0.5;  ///< by first rounds, before points that are not of accuracy are left out

bool is_of_accuracy(std::span<const Knob> knobs, const Point& point) {
  if (point.kind != PointKind::kOneFactor) return false;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    if (point.values[k] != knobs[k].usual) return knobs[k].is_of_accuracy;
  }
  return false;
}

struct Estimate {
  double first = 0.0, all = 0.0;  ///< wall seconds of the first round, and of all
};

/// What points cost beside those that are chosen already.
class Estimates {
 public:
  Estimates(std::span<const Knob> knobs, const BaselineCost& cost, std::uint32_t rounds)
      : knobs_(knobs), cost_(cost), rounds_(rounds) {}

  [[nodiscard]] Estimate of(const Point& point) const {
    const bool is_built = built_.contains(build_key(knobs_, point));
    const double round = cost_.draw + (is_built ? 0.0 : cost_.build * build_factor(knobs_, point));
    const bool is_measured = is_built || measured_.contains(content_key(knobs_, point));
    const double once = is_measured ? 0.0 : cost_.measure;
    return {once + round, once + round * rounds_};
  }

  void choose(const Point& point) {
    built_.insert(build_key(knobs_, point));
    measured_.insert(content_key(knobs_, point));
  }

 private:
  std::span<const Knob> knobs_;
  BaselineCost cost_;
  double rounds_;
  std::set<std::string> built_, measured_;
};

/// How much of the budget the first rounds fill with this point among them.
double most_filled(std::span<const Knob> knobs, const Point& point) {
  return is_of_accuracy(knobs, point) ? kFilled : kFirstFilled;
}

}  // namespace

std::vector<PlannedPoint> plan_points(std::span<const Knob> knobs, std::span<const Point> points,
                                      const BaselineCost& cost, std::uint32_t rounds, double budget) {
  Estimates estimates(knobs, cost, rounds);
  std::vector<PlannedPoint> plan(points.size());
  std::vector<double> alone(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    plan[i].point = i;
    alone[i] = estimates.of(points[i]).all;
  }
  std::sort(plan.begin(), plan.end(), [&](const PlannedPoint& a, const PlannedPoint& b) {
    const Point &of_a = points[a.point], &of_b = points[b.point];
    return std::tuple(of_a.kind != PointKind::kBaseline, -of_a.worth, alone[a.point], a.point) <
           std::tuple(of_b.kind != PointKind::kBaseline, -of_b.worth, alone[b.point], b.point);
  });
  double first = 0.0, all = 0.0;
  for (PlannedPoint& one : plan) {
    const Point& point = points[one.point];
    const Estimate own = estimates.of(point);
    one.estimate = own.all;
    one.first = own.first;
    const bool is_within =
        budget <= 0.0 || first + own.first <= most_filled(knobs, point) * budget || all + own.all <= kFilled * budget;
    one.is_chosen = is_within || point.kind == PointKind::kBaseline;
    if (!one.is_chosen) continue;
    first += own.first;
    all += own.all;
    estimates.choose(point);
  }
  return plan;
}

std::size_t choose_more(std::span<const Knob> knobs, std::span<const Point> points, const BaselineCost& cost,
                        std::uint32_t rounds, double budget, double took, std::vector<PlannedPoint>& plan) {
  Estimates estimates(knobs, cost, rounds);
  double estimated = 0.0;
  for (const PlannedPoint& one : plan) {
    if (!one.is_chosen) continue;
    estimated += one.first;
    estimates.choose(points[one.point]);
  }
  if (!(estimated > 0.0)) return 0;
  const double scale = took / estimated;
  std::size_t count = 0;
  for (PlannedPoint& one : plan) {
    const Point& point = points[one.point];
    const Estimate own = estimates.of(point);
    if (one.is_chosen || took + scale * own.first > most_filled(knobs, point) * budget) continue;
    took += scale * own.first;
    one.is_chosen = true;
    one.estimate = scale * own.all;
    one.first = scale * own.first;
    estimates.choose(point);
    ++count;
  }
  return count;
}

Fineness choose_fineness(double budget, std::uint64_t meshes, std::uint64_t vertices) {
  constexpr std::uint64_t kMost = 100000, kLeast = 2000;
  Fineness out{kMost, Searches::kAll, 640, 360, true};
  if (!(budget > 0.0)) return out;
  // A first look at everything is some forty points; half of a point's share is for its build. What a measurement takes
  // of one thread, as measured: so much for each vertex, with all searches or few, and so much for each sample.
  constexpr double kPoints = 40.0, kVertex = 76e-6, kVertexFew = 30e-6, kSample = 16e-6, kSmallPictures = 1.5;
  const double share = 0.5 * budget / kPoints;
  const auto of_vertices = static_cast<double>(vertices);
  if (kVertex * of_vertices > share) out.searches = Searches::kFew;
  const double left = share - (out.searches == Searches::kAll ? kVertex : kVertexFew) * of_vertices;
  const double fitting = left / (kSample * static_cast<double>(std::max<std::uint64_t>(meshes, 1)));
  out.samples = kLeast;
  for (const std::uint64_t samples : {5000U, 10000U, 20000U, 50000U, 100000U}) {
    if (static_cast<double>(samples) <= fitting) out.samples = samples;
  }
  if (share < kSmallPictures) {
    out.width = 320;
    out.height = 180;
    out.is_device_asked = false;
  }
  return out;
}

}  // namespace meshlode::lab
