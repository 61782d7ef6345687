// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/noise_limits.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace meshlode::build {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kLimitSteps = 10;          // of a limit, from the loosest to the strict one
constexpr std::size_t kMostSizes = 256;  // of pixels, at which cuts are looked at

/// A group's best way under a limit, and from which pixel size on cuts have it: not before what it replaces.
struct Use {
  const NoiseCurve* way = nullptr;
  double pixel_size = kInfinity;
};

class Cuts {
 public:
  explicit Cuts(std::span<const std::vector<NoisyGroup>> levels) : levels_(levels), uses_(levels.size()) {}

  void use_limits(std::span<const double> limits) {
    for (std::size_t l = 0; l < levels_.size(); ++l) {
      uses_[l].assign(levels_[l].size(), {});
      for (std::size_t g = 0; g < levels_[l].size(); ++g) {
        Use& use = uses_[l][g];
        for (const NoiseCurve* way : levels_[l][g].ways) {
          const double size = way->size_for(limits[l]);
          if (size < use.pixel_size) use = {way, size};
        }
        for (std::size_t child = 0; l > 0 && child < children(l); ++child) {
          use.pixel_size = std::max(use.pixel_size, uses_[l - 1][g * children(l) + child].pixel_size);
        }
      }
    }
  }

  /// Squares by level, of a cut at a pixel size.
  void look(double pixel_size, std::vector<double>& squares) const {
    squares.assign(levels_.size(), 0.0);
    if (levels_.empty()) return;
    for (std::size_t g = 0; g < levels_.back().size(); ++g) look(levels_.size() - 1, g, pixel_size, squares);
  }

  /// Those from which on some group is used, where noise is largest; of very many some, the largest among them.
  [[nodiscard]] std::vector<double> sizes() const {
    std::vector<double> all;
    for (const std::vector<Use>& level : uses_) {
      for (const Use& use : level) {
        if (use.pixel_size < kInfinity) all.push_back(use.pixel_size);
      }
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    const std::size_t stride = (all.size() + kMostSizes - 1) / kMostSizes;
    std::vector<double> some;
    for (std::size_t i = 0; i < all.size(); i += stride) some.push_back(all[all.size() - 1 - i]);
    return some;
  }

 private:
  /// Of a group of a level above the first, in the level below.
  [[nodiscard]] std::size_t children(std::size_t level) const {
    return levels_[level - 1].size() / levels_[level].size();
  }

  void look(std::size_t level, std::size_t g, double pixel_size, std::vector<double>& squares) const {
    const Use& use = uses_[level][g];
    if (use.way != nullptr && use.pixel_size <= pixel_size) {
      const double noise = use.way->at(pixel_size);
      squares[level] += levels_[level][g].share * noise * noise;
      return;
    }
    if (level == 0) return;  // the pieces themselves
    for (std::size_t child = 0; child < children(level); ++child) {
      look(level - 1, g * children(level) + child, pixel_size, squares);
    }
  }

  std::span<const std::vector<NoisyGroup>> levels_;
  std::vector<std::vector<Use>> uses_;
};

}  // namespace

double NoiseCurve::size_for(double limit) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].noise <= limit) continue;
    if (i == 0) return kInfinity;
    const Point &good = points[i - 1], &bad = points[i];
    const double share = (bad.noise - limit) / (bad.noise - good.noise);
    return bad.pixel_size + (good.pixel_size - bad.pixel_size) * std::min(1.0, share);
  }
  return points.empty() ? kInfinity : points.back().pixel_size;
}

double NoiseCurve::at(double pixel_size) const {
  if (points.empty()) return 0.0;
  if (pixel_size >= points.front().pixel_size) return points.front().noise;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point &large = points[i - 1], &small = points[i];
    if (pixel_size < small.pixel_size) continue;
    const double share = (pixel_size - small.pixel_size) / (large.pixel_size - small.pixel_size);
    return small.noise + (large.noise - small.noise) * share;
  }
  return points.back().noise;
}

std::vector<double> choose_noise_limits(std::span<const std::vector<NoisyGroup>> levels, double strict, double most) {
  std::vector<int> steps(levels.size(), 0);
  std::vector<double> limits(levels.size(), kLoosestNoise);
  Cuts cuts(levels);
  cuts.use_limits(limits);
  std::vector<double> squares;
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (const double size : cuts.sizes()) {
      cuts.look(size, squares);
      double sum = 0.0;
      std::size_t worst = levels.size();
      for (std::size_t l = 0; l < levels.size(); ++l) {
        sum += squares[l];
        const bool may_fall = steps[l] < kLimitSteps && squares[l] > 0.0;
        if (may_fall && (worst == levels.size() || squares[l] > squares[worst])) worst = l;
      }
      if (!(sum > most * most) || worst == levels.size()) continue;
      ++steps[worst];
      limits[worst] = strict + (kLoosestNoise - strict) * (kLimitSteps - steps[worst]) / kLimitSteps;
      cuts.use_limits(limits);
      is_changed = true;
      break;
    }
  }
  return limits;
}

}  // namespace meshlode::build
