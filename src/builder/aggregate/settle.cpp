// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/settle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "base/box.h"
#include "base/parallel.h"
#include "builder/aggregate/views.h"
#include "builder/symmetric.h"

namespace meshlode::builder {

namespace {

/// How much noise can be settled: a third and more of it goes, and a fifth may stay.
constexpr double kMostToSettle = 0.28, kSettled = 0.19;
/// How often each splat is moved, to the best of how many places.
constexpr std::size_t kSweeps = 5, kTries = 3;
/// How far at first, in pixels along each of three axes, and one of the tries turned by how much, in radians about
/// each; and how much of that from one sweep to the next.
constexpr double kReach = 0.6, kTurn = 0.3, kShrink = 0.75;

/// Samples of the source along half of the smallest pixel: of pieces that are smaller many count.
constexpr int kFinestHalf = 4;

/// A number's bits, well mixed (SplitMix64, public domain).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ x >> 30U) * 0xBF58476D1CE4E5B9U;
  x = (x ^ x >> 27U) * 0x94D049BB133111EBU;
  return x ^ x >> 31U;
}

/// Evenly in a cube from -1 to 1, by a seed.
Vec3d in_cube(std::uint64_t seed) {
  Vec3d p;
  for (int k = 0; k < 3; ++k)
    p[k] = static_cast<double>(mixed(seed + static_cast<std::uint64_t>(k)) >> 11U) * 0x1p-52 - 1.0;
  return p;
}

/// Turned about an axis by its length in radians, if that is little.
void turn_about(const Vec3d& axis, Splat& splat) {
  const Vec3d u = splat.axis_u + glm::cross(axis, splat.axis_u), v = splat.axis_v + glm::cross(axis, splat.axis_v);
  splat.axis_u = u / glm::length(u);
  const Vec3d across = v - splat.axis_u * glm::dot(splat.axis_u, v);
  splat.axis_v = across / glm::length(across);
}

/// The room that splats take up before they are moved, along the axes of where they are: a wall that came to be thicker
/// would show much more of itself where one looks along it, and few views do.
class Room {
 public:
  explicit Room(const WayToSettle& way) {
    const std::vector<Splat>& splats = way.splats.splats;
    Vec3d middle(0.0);
    for (const Splat& splat : splats) middle += splat.center / static_cast<double>(splats.size());
    Mat3d moments(0.0);
    for (const Splat& splat : splats) moments += outer(splat.center - middle, splat.center - middle);
    axes_ = axes_of(moments).direction;
    Box3d middles;
    for (const Splat& splat : splats) {
      middles.add(along(splat.center));
      for (const Vec3d& corner : splat.corners(way.factor)) box_.add(along(corner));
    }
    half_ = 0.5 * middles.size();
  }

  /// By `reach` at most along each axis, and by no more than middles are apart there.
  [[nodiscard]] Vec3d step(const Vec3d& in_cube, double reach) const {
    Vec3d sum(0.0);
    for (int k = 0; k < 3; ++k) sum += axes_[static_cast<std::size_t>(k)] * (in_cube[k] * std::min(reach, half_[k]));
    return sum;
  }
  [[nodiscard]] bool holds(const Corners& corners) const {
    return std::all_of(corners.begin(), corners.end(), [&](const Vec3d& corner) {
      const Vec3d at = along(corner);
      return box_.is_within({at, at}, 0.0);
    });
  }

 private:
  [[nodiscard]] Vec3d along(const Vec3d& p) const {
    return {glm::dot(p, axes_[0]), glm::dot(p, axes_[1]), glm::dot(p, axes_[2])};
  }

  std::array<Vec3d, 3> axes_;
  Box3d box_;        ///< of corners
  Vec3d half_{0.0};  ///< of the box of the middles
};

/// Another place for a splat: one of its tries lies another way up too, the next one is turned.
Splat moved(const Splat& splat, const Room& room, std::size_t attempt, std::uint64_t seed, double reach, double turn) {
  Splat other = splat;
  other.center += room.step(in_cube(seed), reach);
  if (attempt == 0) other.turn_to(static_cast<std::uint32_t>(mixed(seed + 3) & 3U));
  if (attempt == 1) turn_about(turn * in_cube(seed + 4), other);
  return other;
}

/// All views of splats in pixels of one size.
class Pictures {
 public:
  Pictures(const SourcePictures& source, const SourcePictures::Size& size, const WayToSettle& way)
      : factor_(way.factor) {
    CardSamples samples;
    double mean = 0.0;
    for (std::size_t v = 0; v < size.views.size(); ++v) {
      HalfPixels& view = views_.emplace_back(size.views[v], source.lattice(), settling_views()[v]);
      mean += view.source_squares() / static_cast<double>(size.views.size());
      for (const Splat& splat : way.splats.splats) {
        view.draw(splat.corners(factor_), samples);
        view.add(samples);
      }
    }
    // Each view counts by what it shows: of a wall seen along itself that is little, and single directions go furthest
    // off there.
    constexpr double kLeast = 0.001;
    for (const HalfPixels& view : views_) weights_.push_back(mean / std::max(view.source_squares(), kLeast * mean));
    here_.resize(views_.size());
    there_.resize(views_.size());
  }

  [[nodiscard]] double noise() const {
    double change = 0.0, whole = 0.0;
    for (const HalfPixels& view : views_) {
      change += view.squares();
      whole += view.source_squares();
    }
    return whole > 0.0 ? std::sqrt(change / whole) : 0.0;
  }

  /// Each splat once, to the best of some places.
  void move_all(const Room& room, std::size_t sweep, double reach, double turn, Splats& splats) {
    for (std::size_t i = 0; i < splats.splats.size(); ++i) {
      Splat& splat = splats.splats[i];
      const Splat start = splat;
      take_out(start);
      for (std::size_t k = 0; k < kTries; ++k) {
        const Splat other = moved(start, room, k, mixed((i * kSweeps + sweep) * kTries + k), reach, turn);
        if (is_better(other.corners(factor_), room)) splat = other;
      }
      put_best();
    }
  }

 private:
  void take_out(const Splat& splat) {
    const Corners corners = splat.corners(factor_);
    for (std::size_t v = 0; v < views_.size(); ++v) {
      views_[v].draw(corners, here_[v]);
      views_[v].remove(here_[v]);
    }
    least_ = change_by(here_);
  }
  /// Whether there is room for the splat, and less noise with it there than with the best so far.
  bool is_better(const Corners& corners, const Room& room) {
    if (!room.holds(corners)) return false;
    for (std::size_t v = 0; v < views_.size(); ++v) views_[v].draw(corners, there_[v]);
    const double change = change_by(there_);
    if (!(change < least_)) return false;
    least_ = change;
    std::swap(here_, there_);
    return true;
  }
  void put_best() {
    for (std::size_t v = 0; v < views_.size(); ++v) views_[v].add(here_[v]);
  }
  [[nodiscard]] double change_by(std::span<const CardSamples> card) {
    double change = 0.0;
    for (std::size_t v = 0; v < views_.size(); ++v)
      change += weights_[v] * static_cast<double>(views_[v].change_by(card[v]));
    return change;
  }

  double factor_;
  std::vector<HalfPixels> views_;
  std::vector<double> weights_;
  std::vector<CardSamples> here_, there_;  ///< by view: what a splat covers where it is best, and where it is tried
  double least_ = 0.0;
};

}  // namespace

SourcePictures::SourcePictures(const SourceSurface& source, const MeshFrame& frame, const ByPiece& leaf_triangles,
                               double finest_pixel)
    : lattice_(frame.center, frame.radius, finest_pixel / (2.0 * kFinestHalf)) {
  const auto& views = settling_views();
  std::array<std::vector<SourceHalves>, kSettlingViews> of_view;
  parallel_for_each_index(views.size(), 1, [&](std::size_t v) {
    const SampleMask all = cover_of(draw_leaves(source, leaf_triangles, lattice_, views[v], 0, 1).front()).once;
    // Two sizes an octave.
    of_view[v] = {SourceHalves(all, kFinestHalf), SourceHalves(all, kFinestHalf * 3 / 2)};
    while (of_view[v].back().half * lattice_.spacing < frame.radius)
      of_view[v].push_back(of_view[v][of_view[v].size() - 2].coarser());
  });
  sizes_.resize(of_view.front().size());
  for (std::size_t s = 0; s < sizes_.size(); ++s) {
    sizes_[s].pixel_size = 2.0 * of_view.front()[s].half * lattice_.spacing;
    for (std::vector<SourceHalves>& view : of_view) sizes_[s].views.push_back(std::move(view[s]));
  }
}

std::size_t settle(const SourcePictures& source, double finest, std::span<WayToSettle> ways) {
  const auto sizes = source.sizes();
  const auto first = std::find_if(sizes.begin(), sizes.end() - 1,
                                  [&](const SourcePictures::Size& size) { return size.pixel_size >= finest; });
  std::vector<Room> rooms;
  for (const WayToSettle& way : ways) rooms.emplace_back(way);
  std::optional<std::size_t> best;
  for (const SourcePictures::Size& size : std::span(first, sizes.end())) {
    double less = 1.0;
    std::size_t sweep = 0;
    if (!best) {
      const bool is_last = &size == &sizes.back();
      const bool is_quiet = is_last || std::any_of(ways.begin(), ways.end(), [&](const WayToSettle& way) {
                              return Pictures(source, size, way).noise() <= kMostToSettle;
                            });
      if (!is_quiet) continue;
      // Some ways settle better than others do, which shows at once.
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t w = 0; w < ways.size(); ++w) {
        WayToSettle& way = ways[w];
        Pictures pictures(source, size, way);
        pictures.move_all(rooms[w], sweep, kReach * size.pixel_size, kTurn, way.splats);
        if (best && !(pictures.noise() < least)) continue;
        least = pictures.noise();
        best = w;
      }
      less = kShrink;
      sweep = 1;
    }
    WayToSettle& way = ways[*best];
    Pictures pictures(source, size, way);
    for (; sweep < kSweeps; ++sweep, less *= kShrink)
      pictures.move_all(rooms[*best], sweep, less * kReach * size.pixel_size, less * kTurn, way.splats);
    if (pictures.noise() <= kSettled) break;
  }
  return *best;
}

}  // namespace meshlode::builder
