// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/prepare/separate_needles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "base/id_table.h"
#include "base/parallel.h"
#include "base/unset_vector.h"

namespace meshlode::builder {

namespace {

/// Shorter ones lose less than a few steps, which is what the grid costs anyway.
constexpr int kShortest = 4;
/// Squared half diagonal of a cell: how far the grid may move a vertex, in steps.
constexpr double kFarthest2 = 0.75;

auto tuple_of(const Vec3i& q) {
  return std::tuple(q.x, q.y, q.z);
}
auto tuple_of(const Vec3d& p) {
  return std::tuple(p.x, p.y, p.z);
}

/// Corners a and b share a cell; the tip is elsewhere.
struct Needle {
  std::uint32_t a, b, tip;  ///< a before b by position
};

/// The needle that lies along the k-th edge of a triangle, if there is one.
std::optional<Needle> needle_at(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles,
                                std::span<const Vec3i> cells, std::size_t t, std::size_t k) {
  Needle needle{triangles[t + k], triangles[t + (k + 1) % 3], triangles[t + (k + 2) % 3]};
  if (cells[needle.a] != cells[needle.b] || positions[needle.a] == positions[needle.b]) return {};
  const Vec3i along = cells[needle.tip] - cells[needle.a];
  if (std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)}) < kShortest) return {};
  if (tuple_of(positions[needle.b]) < tuple_of(positions[needle.a])) std::swap(needle.a, needle.b);
  return needle;
}

std::vector<Needle> find_needles(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles,
                                 std::span<const Vec3i> cells) {
  const std::size_t count = triangles.size() / 3;
  std::vector<std::uint8_t> has_needle(count, 0);  // they are few: found side by side, collected in order
  parallel_for_each_index(count, kLoopGrain, [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (needle_at(positions, triangles, cells, 3 * t, k)) has_needle[t] = 1;
    }
  });
  std::vector<Needle> needles;
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; has_needle[t] != 0 && k < 3; ++k) {
      if (const std::optional<Needle> needle = needle_at(positions, triangles, cells, 3 * t, k)) {
        needles.push_back(*needle);
      }
    }
  }
  std::sort(needles.begin(), needles.end(), [&](const Needle& x, const Needle& y) {
    return std::tuple(tuple_of(positions[x.a]), tuple_of(positions[x.b]), tuple_of(positions[x.tip])) <
           std::tuple(tuple_of(positions[y.a]), tuple_of(positions[y.b]), tuple_of(positions[y.tip]));
  });
  return needles;
}

using Cell = std::tuple<int, int, int>;
using Point = std::tuple<double, double, double>;

/// Sorted, each once; asked about by many that are not in it.
template <class T>
class SmallSet {
 public:
  void add(const T& value) { values_.push_back(value); }
  void finish() {
    std::sort(values_.begin(), values_.end());
    values_.erase(std::unique(values_.begin(), values_.end()), values_.end());
    is_hashed_.assign(std::bit_ceil(16 * values_.size() + 64), 0);
    for (const T& value : values_) is_hashed_[slot_of(value)] = 1;
  }
  [[nodiscard]] bool contains(const T& value) const {
    return is_hashed_[slot_of(value)] != 0 && std::binary_search(values_.begin(), values_.end(), value);
  }

 private:
  [[nodiscard]] std::size_t slot_of(const T& value) const {
    const auto word = [](auto x) { return std::bit_cast<std::uint64_t>(static_cast<double>(x) + 0.0); };
    const auto& [x, y, z] = value;
    return hash_word(hash_word(hash_word(0, word(x)), word(y)), word(z)) & (is_hashed_.size() - 1);
  }

  std::vector<T> values_;
  std::vector<std::uint8_t> is_hashed_;  ///< a power of two of them
};

/// What needles can change, and no more: the vertices at their corners, and which cells beside them are taken.
struct Surroundings {
  std::vector<std::uint32_t> by_position;  ///< vertices at a corner a or b of a needle
  std::set<Cell> taken;                    ///< cells beside those, where a triangle's vertex lies
};

Surroundings find_surroundings(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles,
                               std::span<const Vec3i> cells, const std::vector<Needle>& needles) {
  SmallSet<Point> corners;
  SmallSet<Cell> beside;
  for (const Needle& needle : needles) {
    for (const std::uint32_t v : {needle.a, needle.b}) {
      corners.add(tuple_of(positions[v]));
      for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {-1, 1}) {
          Vec3i cell = cells[v];
          cell[axis] += side;
          beside.add(tuple_of(cell));
        }
      }
    }
  }
  corners.finish();
  beside.finish();
  std::vector<std::uint8_t> is_used(positions.size(), 0);
  for (const std::uint32_t v : triangles) is_used[v] = 1;
  // They are few: found side by side, collected in order.
  constexpr std::uint8_t kCorner = 1, kBeside = 2;
  UnsetVector<std::uint8_t> what(positions.size());
  parallel_for_each_index(positions.size(), kLoopGrain, [&](std::size_t v) {
    what[v] = 0;
    if (is_used[v] == 0) return;
    if (corners.contains(tuple_of(positions[v]))) what[v] |= kCorner;
    if (beside.contains(tuple_of(cells[v]))) what[v] |= kBeside;
  });
  Surroundings found;
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if ((what[v] & kCorner) != 0) found.by_position.push_back(v);
    if ((what[v] & kBeside) != 0) found.taken.insert(tuple_of(cells[v]));
  }
  return found;
}

}  // namespace

std::uint64_t separate_needles(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles,
                               const format::PositionGrid& grid, std::span<Vec3i> cells) {
  const std::vector<Needle> needles = find_needles(positions, triangles, cells);
  if (needles.empty()) return 0;

  // Vertices of equal position move together; a cell is free where no triangle's vertex lies, and none has moved to.
  auto [by_position, taken] = find_surroundings(positions, triangles, cells, needles);
  const auto before = [&](std::uint32_t x, std::uint32_t y) { return tuple_of(positions[x]) < tuple_of(positions[y]); };
  std::sort(by_position.begin(), by_position.end(), before);

  const double step = grid.step();
  std::uint64_t kept = 0;
  for (const Needle& needle : needles) {
    if (cells[needle.a] != cells[needle.b]) {
      ++kept;  // a neighbour has moved it
      continue;
    }
    std::uint32_t best = needle.a;
    Vec3i best_cell(0);
    double best_distance2 = kFarthest2;
    bool is_found = false;
    for (const std::uint32_t v : {needle.a, needle.b}) {
      const std::uint32_t other = v == needle.a ? needle.b : needle.a;
      const Vec3d residual = positions[v] / step - Vec3d(cells[v]);
      for (int axis = 0; axis < 3; ++axis) {
        const int side = residual[axis] > 0.0 ? 1 : -1;
        // Away from the other corner, or the needle would turn over.
        if (!((positions[v][axis] - positions[other][axis]) * side > 0.0)) continue;
        Vec3i cell = cells[v];
        cell[axis] += side;
        if (std::abs(cell[axis]) > format::kMaxGridCoordinate) continue;
        const Vec3d left = positions[v] / step - Vec3d(cell);
        const double distance2 = glm::dot(left, left);
        if (distance2 > best_distance2 || (is_found && distance2 == best_distance2)) continue;
        if (taken.contains(tuple_of(cell))) continue;
        best = v;
        best_cell = cell;
        best_distance2 = distance2;
        is_found = true;
      }
    }
    if (!is_found) continue;
    ++kept;
    const auto [first, last] = std::equal_range(by_position.begin(), by_position.end(), best, before);
    for (auto v = first; v != last; ++v) cells[*v] = best_cell;
    taken.insert(tuple_of(best_cell));
  }
  return kept;
}

}  // namespace meshlode::builder
