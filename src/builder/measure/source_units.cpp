// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/source_units.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/box.h"
#include "base/parallel.h"
#include "base/release.h"
#include "builder/measure/level_surface.h"

namespace meshlode::builder {

namespace {

/// A larger unit is dismissed later, a smaller one asks for more of its vertices twice: from 24 to 128 the dragon costs
/// the same within 5%. Its vertices are numbered in a byte.
constexpr std::size_t kUnit = 64;
static_assert(3 * kUnit <= 256);
/// Of level 0, divided by one thread.
constexpr std::size_t kClustersOfBlock = 64;

/// Halves a cluster's triangles by the median along the longest side until they are units; calls add(unit).
template <class Add>
void halve(std::span<std::uint32_t> triangles, const SourceTree::Impl& source, const Add& add) {
  if (triangles.size() <= kUnit) return add(triangles);
  Box3d centers;
  const auto center = [&](std::uint32_t t) {
    const auto [a, b, c] = source.corners(t);
    return a + b + c;
  };
  for (const std::uint32_t t : triangles) centers.add(center(t));
  const int axis = centers.longest_axis();
  const std::size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half), triangles.end(),
                   [&](std::uint32_t x, std::uint32_t y) {
                     const double p = center(x)[axis], q = center(y)[axis];
                     return p != q ? p < q : x < y;
                   });
  halve(triangles.first(half), source, add);
  halve(triangles.subspan(half), source, add);
}

}  // namespace

SourceUnits::SourceUnits(const SourceTree::Impl& source, std::span<const std::uint32_t> cluster_of,
                         std::size_t cluster_count) {
  parallel_all([&] { find_borders(source); }, [&] { divide(source, cluster_of, cluster_count); });
}

void SourceUnits::divide(const SourceTree::Impl& source, std::span<const std::uint32_t> cluster_of,
                         std::size_t cluster_count) {
  std::vector<std::uint32_t> first(cluster_count + 1, 0);
  for (const std::uint32_t c : cluster_of) ++first[c + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> sorted(cluster_of.size()), next(first.begin(), first.end() - 1);
  for (std::uint32_t t = 0; t < cluster_of.size(); ++t) sorted[next[cluster_of[t]]++] = t;
  first_unit_.assign(cluster_count + 1, 0);
  std::vector<Block> blocks((cluster_count + kClustersOfBlock - 1) / kClustersOfBlock);
  parallel_for_each_chunk(cluster_count, kClustersOfBlock, [&](std::size_t b, std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      if (first[c] < first[c + 1]) {
        halve(std::span(sorted).subspan(first[c], first[c + 1] - first[c]), source, [&](std::span<std::uint32_t> unit) {
          std::sort(unit.begin(), unit.end());
          blocks[b].add_unit(source, unit);
        });
      }
      first_unit_[c + 1] = static_cast<std::uint32_t>(blocks[b].units.size());  // of the block
    }
  });
  triangles_.reserve(cluster_of.size());
  vertices_.reserve(cluster_of.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::size_t end = std::min(cluster_count, (b + 1) * kClustersOfBlock);
    for (std::size_t c = b * kClustersOfBlock; c < end; ++c)
      first_unit_[c + 1] += static_cast<std::uint32_t>(units_.size());
    append(std::move(blocks[b]));
  }
}

void SourceUnits::append(Block&& block) {
  for (Unit& unit : block.units) {
    unit.first_vertex += static_cast<std::uint32_t>(vertices_.size());
    unit.first_triangle += static_cast<std::uint32_t>(triangles_.size());
  }
  units_.insert(units_.end(), block.units.begin(), block.units.end());
  vertices_.insert(vertices_.end(), block.vertices.begin(), block.vertices.end());
  triangles_.insert(triangles_.end(), block.triangles.begin(), block.triangles.end());
  release(block.units, block.vertices, block.triangles);
}

void SourceUnits::Block::add_unit(const SourceTree::Impl& source, std::span<const std::uint32_t> triangles_of_unit) {
  Unit unit;
  unit.first_vertex = static_cast<std::uint32_t>(vertices.size());
  unit.first_triangle = static_cast<std::uint32_t>(triangles.size());
  Box3d box;
  for (const std::uint32_t t : triangles_of_unit) {
    Triangle triangle;
    triangle.id = t;
    const std::array<std::uint32_t, 3> ids = source.vertices(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto begin = vertices.begin() + unit.first_vertex;
      const auto at = std::find(begin, vertices.end(), ids[k]);
      triangle.corner[k] = static_cast<std::uint8_t>(at - begin);
      if (at == vertices.end()) vertices.push_back(ids[k]);
      box.add(source.positions[ids[k]]);
    }
    triangles.push_back(triangle);
  }
  unit.vertex_count = static_cast<std::uint32_t>(vertices.size()) - unit.first_vertex;
  unit.triangle_count = static_cast<std::uint32_t>(triangles_of_unit.size());
  unit.center = box.low + 0.5 * box.size();
  double radius2 = 0.0;
  for (std::size_t v = unit.first_vertex; v < vertices.size(); ++v) {
    const Vec3d away = source.positions[vertices[v]] - unit.center;
    radius2 = std::max(radius2, glm::dot(away, away));
  }
  unit.radius = std::sqrt(radius2) * (1.0 + 1e-9);
  units.push_back(unit);
}

void SourceUnits::find_borders(const SourceTree::Impl& source) {
  std::vector<std::uint32_t> balance(source.positions.size(), 0);  // 0 around a closed fan: each next is a previous
  is_border_.assign(source.positions.size(), 0);                   // corners there, up to 3
  for (std::uint32_t t = 0; t < source.triangles.size(); ++t) {
    const auto c = source.vertices(t);
    for (const std::uint32_t v : c) {
      const std::size_t k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
      balance[v] += c[(k + 1) % 3] * 2654435761U - c[(k + 2) % 3] * 2654435761U;
      is_border_[v] = static_cast<std::uint8_t>(std::min(is_border_[v] + 1, 3));
    }
  }
  for (std::size_t v = 0; v < balance.size(); ++v) is_border_[v] = balance[v] != 0 || is_border_[v] < 3 ? 1 : 0;
}

}  // namespace meshlode::builder
