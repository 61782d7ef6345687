// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/noise_budget.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <utility>

namespace meshlode::builder {

namespace {

constexpr double kNoPixelSize = std::numeric_limits<double>::infinity();
constexpr double kSizeStep = 1.0108892860517005;  // 2^(1/64): pixel sizes that are looked at

/// A group in a cut, as it would be from now on.
struct Step {
  double cost = 0.0;   ///< of the budget: a difference of squares
  double price = 0.0;  ///< of a triangle that it spares
  std::size_t level = 0, group = 0, way = 0;

  /// The dearer one, as queues want it; of two the later group.
  [[nodiscard]] bool operator<(const Step& other) const {
    if (price != other.price) return price > other.price;
    return level != other.level ? level > other.level : group > other.group;
  }
};

class Cut {
 public:
  explicit Cut(std::span<const std::vector<NoisyGroup>> levels) : levels_(levels) {
    for (const std::vector<NoisyGroup>& level : levels) uses_.emplace_back(level.size());
  }

  /// From the smallest pixels to the largest, so that what has come stays: noise only falls.
  void coarsen(double pixel_size, const NoiseBudget& budget) {
    const bool is_shift_held = pixel_size < budget.shift_below;
    double squares = 0.0;
    shifts_.clear();
    sum_shift_ = 0.0;
    std::priority_queue<Step> steps;
    for (std::size_t l = 0; l < levels_.size(); ++l) {
      for (std::size_t g = 0; g < levels_[l].size(); ++g) {
        if (is_drawn(l, g)) {
          squares += squares_of(l, g, pixel_size);
          add_shifts(drawn_way(l, g), 1.0);
        }
        if (const auto step = step_to(l, g, pixel_size)) steps.push(*step);
      }
    }
    while (!steps.empty()) {
      const Step step = steps.top();
      steps.pop();
      const auto now = step_to(step.level, step.group, pixel_size);
      if (!now) continue;
      if (now->cost != step.cost) {  // what it replaces is another by now
        steps.push(*now);
        continue;
      }
      if (squares + step.cost > budget.noise * budget.noise) continue;
      change_shifts(step, 1.0);
      if (std::abs(sum_shift_) > budget.sum_shift || (is_shift_held && largest_shift() > budget.shift)) {
        change_shifts(step, -1.0);
        continue;
      }
      squares += step.cost;
      uses_[step.level][step.group] = {pixel_size, step.way};
      for (std::size_t l = step.level + 1, g = step.group; l < levels_.size(); ++l) {
        g /= children(l);
        if (const auto next = step_to(l, g, pixel_size)) steps.push(*next);
        if (children(l) > 1) break;
      }
    }
  }

  [[nodiscard]] std::vector<std::vector<NoiseUse>> take_uses() { return std::move(uses_); }

 private:
  /// Of a group of a level above the first, in the level below.
  [[nodiscard]] std::size_t children(std::size_t level) const {
    return levels_[level - 1].size() / levels_[level].size();
  }
  [[nodiscard]] bool is_used(std::size_t level, std::size_t group) const {
    return uses_[level][group].pixel_size < kNoPixelSize;
  }
  /// Whether a group above stands for this one.
  [[nodiscard]] bool is_replaced(std::size_t level, std::size_t group) const {
    for (std::size_t l = level + 1; l < levels_.size(); ++l) {
      group /= children(l);
      if (is_used(l, group)) return true;
    }
    return false;
  }
  [[nodiscard]] bool is_drawn(std::size_t level, std::size_t group) const {
    return is_used(level, group) && !is_replaced(level, group);
  }
  [[nodiscard]] double squares_of(std::size_t level, std::size_t group, double pixel_size) const {
    const NoisyGroup& from = levels_[level][group];
    const double noise = from.ways[uses_[level][group].way].noise->most_from(pixel_size);
    return from.share * noise * noise;
  }

  [[nodiscard]] const NoisyWay& drawn_way(std::size_t level, std::size_t group) const {
    return levels_[level][group].ways[uses_[level][group].way];
  }
  void add_shifts(const NoisyWay& way, double sign) {
    if (shifts_.size() < way.shifts.size()) shifts_.resize(way.shifts.size(), 0.0);
    for (std::size_t v = 0; v < way.shifts.size(); ++v) shifts_[v] += sign * way.shifts[v];
    sum_shift_ += sign * way.sum_shift;
  }
  /// With the step's group instead of what it replaces, or back.
  void change_shifts(const Step& step, double sign) {
    add_shifts(levels_[step.level][step.group].ways[step.way], sign);
    for (const Drawn& drawn : drawn_below(step.level, step.group))
      add_shifts(drawn_way(drawn.level, drawn.group), -sign);
  }
  [[nodiscard]] double largest_shift() const {
    double largest = 0.0;
    for (const double shift : shifts_) largest = std::max(largest, std::abs(shift));
    return largest;
  }

  struct Drawn {
    std::size_t level = 0, group = 0;
  };
  /// What a group replaces, if all of it is thinned out or nothing is; where a level has the same groups as the one
  /// below, it may come without that.
  [[nodiscard]] std::vector<Drawn> drawn_below(std::size_t level, std::size_t group) const {
    while (level > 0 && children(level) == 1) {
      if (is_used(--level, group)) return {{level, group}};
    }
    std::vector<Drawn> below;
    for (std::size_t i = 0; level > 0 && i < children(level); ++i)
      below.push_back({level - 1, group * children(level) + i});
    return below;
  }

  /// The group instead of what it replaces, if it may come.
  [[nodiscard]] std::optional<Step> step_to(std::size_t level, std::size_t group, double pixel_size) const {
    if (is_used(level, group) || is_replaced(level, group)) return std::nullopt;
    const NoisyGroup& from = levels_[level][group];
    Step step{.level = level, .group = group};
    double least = kNoPixelSize;
    for (std::size_t w = 0; w < from.ways.size(); ++w) {
      const double noise = from.ways[w].noise->most_from(pixel_size);
      if (!(noise < least)) continue;
      least = noise;
      step.way = w;
    }
    if (!(least <= kLoosestNoise)) return std::nullopt;
    const std::vector<Drawn> below = drawn_below(level, group);
    auto spared = below.empty() ? static_cast<double>(from.source_triangles) : 0.0;
    for (const Drawn& drawn : below) {
      if (!is_used(drawn.level, drawn.group)) return std::nullopt;
      step.cost -= squares_of(drawn.level, drawn.group, pixel_size);
      spared += static_cast<double>(drawn_way(drawn.level, drawn.group).triangles);
    }
    step.cost += from.share * least * least;
    spared -= static_cast<double>(from.ways[step.way].triangles);
    step.price = step.cost / std::max(1.0, spared);
    return step;
  }

  std::span<const std::vector<NoisyGroup>> levels_;
  std::vector<std::vector<NoiseUse>> uses_;
  std::vector<double> shifts_;  ///< of what is drawn, by view
  double sum_shift_ = 0.0;
};

}  // namespace

double NoiseCurve::most_from(double pixel_size) const {
  if (points.empty() || pixel_size < std::max(finest, points.back().pixel_size)) return kNoPixelSize;
  double most = points.front().noise;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point &large = points[i - 1], &small = points[i];
    if (pixel_size >= large.pixel_size) break;
    const double share = (pixel_size - small.pixel_size) / (large.pixel_size - small.pixel_size);
    most = std::max(most, small.noise + (large.noise - small.noise) * std::max(0.0, share));
  }
  return most;
}

std::vector<std::vector<NoiseUse>> share_out_noise(std::span<const std::vector<NoisyGroup>> levels,
                                                   const NoiseBudget& budget) {
  double smallest = kNoPixelSize, largest = 0.0;
  for (const std::vector<NoisyGroup>& level : levels) {
    for (const NoisyGroup& group : level) {
      for (const NoisyWay& way : group.ways) {
        if (way.noise->points.empty()) continue;
        smallest = std::min(smallest, way.noise->points.back().pixel_size);
        largest = std::max(largest, way.noise->points.front().pixel_size);
      }
    }
  }
  Cut cut(levels);
  // Up to the largest itself, where noise is least.
  for (double size = smallest; size < largest; size *= kSizeStep) cut.coarsen(size, budget);
  if (largest > 0.0) cut.coarsen(largest, budget);
  return cut.take_uses();
}

void leave_out_undrawn(std::vector<std::vector<NoiseUse>>& uses) {
  for (std::size_t l = 0; l < uses.size(); ++l) {
    for (std::size_t above = l + 1; above < uses.size() && uses[above].size() == uses[l].size(); ++above) {
      for (std::size_t g = 0; g < uses[l].size(); ++g) {
        if (uses[above][g].pixel_size <= uses[l][g].pixel_size) uses[l][g] = {};
      }
    }
  }
}

}  // namespace meshlode::builder
