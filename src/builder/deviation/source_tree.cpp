// SPDX-License-Identifier: GPL-3.0-or-later
// The source as the tiers see it: a tree to find its nearest triangle, and the samples that start at level 0.
#include "builder/deviation/source_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/id_table.h"
#include "base/parallel.h"
#include "base/release.h"

namespace meshlode::builder {

namespace {

/// Where samples are set so that none of the source is far from one. Dense scans need their vertices only.
struct Spacing {
  double length = 0.0;
  static constexpr std::uint32_t kMaxPerEdge = 16;

  /// Whether an edge of this squared length stays whole: parts() of its length, without the root. False near the limit,
  /// where the rounding of squares might decide otherwise.
  [[nodiscard]] bool is_short(double edge2) const { return edge2 < 0.999 * length * length; }
  /// Into how many parts an edge is cut.
  [[nodiscard]] std::uint32_t parts(double edge) const {
    if (!(edge > length)) return 1;
    return static_cast<std::uint32_t>(std::min(std::floor(edge / length) + 1.0, static_cast<double>(kMaxPerEdge)));
  }
};

Spacing choose_spacing(const SourceTree::Impl& source) {
  constexpr std::size_t kChunk = 16384;
  struct Sums {
    double edges = 0.0, area = 0.0;
  };
  std::vector<Sums> partials(chunk_count(source.triangles.size(), kChunk));
  parallel_for_each_chunk(source.triangles.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    Sums sums;
    for (std::size_t i = begin; i < end; ++i) {
      const auto [a, b, c] = source.corners(static_cast<std::uint32_t>(i));
      sums.edges += glm::length(b - a) + glm::length(c - b) + glm::length(a - c);
      sums.area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    partials[chunk] = sums;
  });
  Sums all;
  for (const Sums& sums : partials) {
    all.edges += sums.edges;
    all.area += sums.area;
  }
  const double mean_edge = all.edges / (3.0 * static_cast<double>(source.triangles.size()));
  constexpr double kLeastSamples = 10000.0;  // of a coarse mesh
  return {std::min(2.0 * mean_edge, std::sqrt(all.area / kLeastSamples))};
}

/// Calls add(point, vertex) for the samples of one triangle; no vertex: kNoId. A vertex is one of the first triangle
/// that has it.
template <class Add>
void for_each_sample(const SourceTree::Impl& source, const Spacing& spacing, std::uint32_t triangle, const Add& add) {
  const std::array<std::uint32_t, 3> corners = source.vertices(triangle);
  const TriangleCorners p = source.corners(triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    const bool is_again = std::find(corners.begin(), corners.begin() + k, corners[k]) != corners.begin() + k;
    if (!is_again && source.triangles_around(corners[k]).front() == triangle) add(p[k], corners[k]);
  }
  std::array<double, 3> edge2{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d edge = p[(k + 1) % 3] - p[k];
    edge2[k] = glm::dot(edge, edge);
  }
  // Of a dense source nearly all: neither its edges nor its height, which is below the longest, are cut.
  if (spacing.is_short(std::max(edge2[0], std::max(edge2[1], edge2[2])))) return;
  for (std::size_t k = 0; k < 3; ++k) {
    // From its lower end, so that the edges of a closed surface are cut once.
    if (corners[k] > corners[(k + 1) % 3] || spacing.is_short(edge2[k])) continue;
    const std::uint32_t parts = spacing.parts(glm::length(p[(k + 1) % 3] - p[k]));
    for (std::uint32_t i = 1; i < parts; ++i)
      add(p[k] + (p[(k + 1) % 3] - p[k]) * (static_cast<double>(i) / parts), kNoId);
  }
  // The inside: a lattice along the two shorter edges, where the height asks for one.
  const double longest =
      std::max(glm::length(p[1] - p[0]), std::max(glm::length(p[2] - p[1]), glm::length(p[0] - p[2])));
  const double height = longest > 0.0 ? glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) / longest : 0.0;
  const std::uint32_t parts = height > spacing.length ? spacing.parts(longest) : 1;
  for (std::uint32_t i = 1; i < parts; ++i) {
    for (std::uint32_t j = 1; i + j < parts; ++j) {
      const double u = static_cast<double>(i) / parts, v = static_cast<double>(j) / parts;
      add(p[0] + (p[1] - p[0]) * u + (p[2] - p[0]) * v, kNoId);
    }
  }
}

/// Of each position the first one in the same place; nothing where no two are.
std::vector<std::uint32_t> weld(std::span<const Vec3d> positions) {
  IdTable table(positions.size());
  const auto hash_of = [&](std::uint32_t id) {
    std::uint64_t h = 0;
    for (int k = 0; k < 3; ++k) h = hash_word(h, std::bit_cast<std::uint64_t>(positions[id][k] + 0.0));  // one zero
    return h;
  };
  std::vector<std::uint32_t> first(positions.size());
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    first[i] = table
                   .find_or_insert(
                       hash_of(i), i, [&](std::uint32_t other) { return positions[other] == positions[i]; }, hash_of)
                   .id;
  }
  if (table.size() == positions.size()) release(first);
  return first;
}

}  // namespace

SourceTree::SourceTree(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles,
                       std::size_t most_held)
    : impl_(std::make_unique<Impl>()) {
  impl_->positions = positions;
  impl_->triangles = triangles;
  parallel_all(
      [&] {
        impl_->tree.build({positions, triangles},
                          triangles.size() <= most_held ? SurfaceTree::Leaves::kHeld : SurfaceTree::Leaves::kMade,
                          SurfaceTree::Capsules::kLater);
      },
      [&] { impl_->list_corners(); });
  if (impl_->has_hub()) impl_->tree.add_capsules();
  impl_->place.resize(triangles.size());
  parallel_for_each_index(triangles.size(), kLoopGrain, [&](std::size_t i) {
    const TreeSlot slot(i);
    impl_->place[impl_->tree.triangle_at(slot)] = slot;
  });
}

void SourceTree::Impl::list_corners() {
  vertex_of = weld(positions);
  first_corner.assign(positions.size() + 2, 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : vertices(t)) ++first_corner[v + 2];
  }
  for (std::size_t v = 2; v < first_corner.size(); ++v) first_corner[v] += first_corner[v - 1];
  triangle_of_corner.resize(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : vertices(t)) triangle_of_corner[first_corner[v + 1]++] = t;
  }
  first_corner.pop_back();
}

bool SourceTree::Impl::has_hub() const {
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (triangles_around(v).size() >= kHubTriangles) return true;
  }
  return false;
}

SourceTree::~SourceTree() = default;
SourceTree::SourceTree(SourceTree&&) noexcept = default;
SourceTree& SourceTree::operator=(SourceTree&&) noexcept = default;

UnsetVector<CarriedSample> initial_samples(const SourceTree& source) {
  const SourceTree::Impl& impl = source.impl();
  if (impl.triangles.empty()) return {};
  const Spacing spacing = choose_spacing(impl);
  constexpr std::size_t kChunk = 4096;
  std::vector<std::size_t> start(chunk_count(impl.triangles.size(), kChunk) + 1, 0);
  parallel_for_each_chunk(impl.triangles.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t t = begin; t < end; ++t) {
      for_each_sample(impl, spacing, static_cast<std::uint32_t>(t), [&](const Vec3d&, std::uint32_t) { ++count; });
    }
    start[chunk + 1] = count;
  });
  std::partial_sum(start.begin(), start.end(), start.begin());
  UnsetVector<CarriedSample> samples(start.back());
  parallel_for_each_chunk(impl.triangles.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::size_t next = start[chunk];
    for (std::size_t i = begin; i < end; ++i) {
      const auto t = static_cast<std::uint32_t>(i);
      for_each_sample(impl, spacing, t, [&](const Vec3d& point, std::uint32_t vertex) {
        samples[next++] = {point, t, 0.0F, impl.place_of(t), vertex};
      });
    }
  });
  return samples;
}

}  // namespace meshlode::builder
