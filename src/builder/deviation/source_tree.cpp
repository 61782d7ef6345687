// SPDX-License-Identifier: GPL-3.0-or-later
// The source as the tiers see it: a tree to find its nearest triangle.
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

}  // namespace meshlode::builder
