// SPDX-License-Identifier: GPL-3.0-or-later
// The source as the tiers see it: a tree to find its nearest triangle, and the samples that start at level 0.
#include "build/deviation/source_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/id_table.h"
#include "base/release.h"

namespace meshlode::build {

namespace {

// A source of at most so many triangles has its leaves held, 68 bytes a triangle: the constant part of measuring, the
// same few thousand points for every mesh, asks small trees over and over.
constexpr std::size_t kMostHeldTriangles = 65536;

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
  double edges = 0.0, area = 0.0;
  for (const auto& t : source.triangles) {
    const Vec3d& a = source.positions[t[0]];
    const Vec3d& b = source.positions[t[1]];
    const Vec3d& c = source.positions[t[2]];
    edges += glm::length(b - a) + glm::length(c - b) + glm::length(a - c);
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  const double mean_edge = edges / (3.0 * static_cast<double>(source.triangles.size()));
  constexpr double kLeastSamples = 10000.0;  // of a coarse mesh
  return {std::min(2.0 * mean_edge, std::sqrt(area / kLeastSamples))};
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

SourceTree::SourceTree(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles)
    : impl_(std::make_unique<Impl>()) {
  impl_->positions = positions;
  impl_->triangles = triangles;
  impl_->vertex_of = weld(positions);
  impl_->tree.build({positions, triangles, impl_->vertex_of},
                    triangles.size() <= kMostHeldTriangles ? SurfaceTree::Leaves::kHeld : SurfaceTree::Leaves::kMade);
  std::vector<std::uint32_t>& first = impl_->first_corner;
  first.assign(positions.size() + 2, 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : impl_->vertices(t)) ++first[v + 2];
  }
  for (std::size_t v = 2; v < first.size(); ++v) first[v] += first[v - 1];
  impl_->triangle_of_corner.resize(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : impl_->vertices(t)) impl_->triangle_of_corner[first[v + 1]++] = t;
  }
  first.pop_back();
  impl_->place.resize(triangles.size());
  for (std::uint32_t i = 0; i < impl_->tree.size(); ++i)
    impl_->place[impl_->tree.triangle_at(TreeSlot(i))] = TreeSlot(i);
}

SourceTree::~SourceTree() = default;
SourceTree::SourceTree(SourceTree&&) noexcept = default;
SourceTree& SourceTree::operator=(SourceTree&&) noexcept = default;

std::vector<CarriedSample> initial_samples(const SourceTree& source) {
  const SourceTree::Impl& impl = source.impl();
  std::vector<CarriedSample> samples;
  if (impl.triangles.empty()) return samples;
  const Spacing spacing = choose_spacing(impl);
  std::vector<std::uint8_t> is_taken(impl.positions.size(), 0);
  samples.reserve(impl.positions.size());
  for (std::uint32_t t = 0; t < impl.triangles.size(); ++t) {
    const std::array<std::uint32_t, 3> corners = impl.vertices(t);
    const TriangleCorners p = impl.corners(t);
    const auto add = [&](const Vec3d& point, std::uint32_t vertex = kNoId) {
      samples.push_back({point, t, 0.0F, impl.place_of(t), vertex});
    };
    for (std::size_t k = 0; k < 3; ++k) {
      if (is_taken[corners[k]] == 0) add(p[k], corners[k]);
      is_taken[corners[k]] = 1;
    }
    std::array<double, 3> edge2{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d edge = p[(k + 1) % 3] - p[k];
      edge2[k] = glm::dot(edge, edge);
    }
    // Of a dense source nearly all: neither its edges nor its height, which is below the longest, are cut.
    if (spacing.is_short(std::max(edge2[0], std::max(edge2[1], edge2[2])))) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      // From its lower end, so that the edges of a closed surface are cut once.
      if (corners[k] > corners[(k + 1) % 3] || spacing.is_short(edge2[k])) continue;
      const std::uint32_t parts = spacing.parts(glm::length(p[(k + 1) % 3] - p[k]));
      for (std::uint32_t i = 1; i < parts; ++i) add(p[k] + (p[(k + 1) % 3] - p[k]) * (static_cast<double>(i) / parts));
    }
    // The inside: a lattice along the two shorter edges, where the height asks for one.
    const double longest =
        std::max(glm::length(p[1] - p[0]), std::max(glm::length(p[2] - p[1]), glm::length(p[0] - p[2])));
    const double height = longest > 0.0 ? glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) / longest : 0.0;
    const std::uint32_t parts = height > spacing.length ? spacing.parts(longest) : 1;
    for (std::uint32_t i = 1; i < parts; ++i) {
      for (std::uint32_t j = 1; i + j < parts; ++j) {
        add(p[0] + (p[1] - p[0]) * (static_cast<double>(i) / parts) + (p[2] - p[0]) * (static_cast<double>(j) / parts));
      }
    }
  }
  return samples;
}

}  // namespace meshlode::build
