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

SourceTree::SourceTree(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles)
    : impl_(std::make_unique<Impl>()) {
  impl_->positions = positions;
  impl_->triangles = triangles;
  bool has_hub = false;
  parallel_all(
      [&] {
        impl_->tree.build({positions, triangles}, SurfaceTree::Leaves::kHeldIfFew, SurfaceTree::Capsules::kLater);
      },
      [&] {
        impl_->vertex_of = weld(positions);
        has_hub = impl_->has_hub();
      });
  if (has_hub) impl_->tree.add_capsules();
  impl_->place.resize(triangles.size());
  parallel_for_each_index(triangles.size(), kLoopGrain, [&](std::size_t i) {
    const TreeSlot slot(i);
    impl_->place[impl_->tree.triangle_at(slot)] = slot;
  });
}

bool SourceTree::Impl::has_hub() const {
  std::vector<std::uint32_t> around(positions.size(), 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : vertices(t)) {
      if (++around[v] >= kHubTriangles) return true;
    }
  }
  return false;
}

SourceTree::~SourceTree() = default;
SourceTree::SourceTree(SourceTree&&) noexcept = default;
SourceTree& SourceTree::operator=(SourceTree&&) noexcept = default;

}  // namespace meshlode::builder
