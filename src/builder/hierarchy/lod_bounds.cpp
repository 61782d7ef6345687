// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/hierarchy/lod_bounds.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "builder/hierarchy/margins.h"

namespace meshlode::builder {
namespace {

// Lists of ids per key: count, prefix sum, fill (in id order).
struct Lists {
  std::vector<std::uint32_t> first;  ///< key_count + 1
  std::vector<std::uint32_t> ids;
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t key) const {
    return std::span(ids).subspan(first[key], first[key + 1] - first[key]);
  }
};

template <class KeyOf>
Lists list_by_key(std::size_t item_count, std::size_t key_count, const KeyOf& key_of) {
  Lists lists;
  lists.first.assign(key_count + 1, 0);
  for (std::size_t i = 0; i < item_count; ++i) {
    if (const std::uint32_t key = key_of(i); key != kNoId) ++lists.first[key + 1];
  }
  for (std::size_t k = 0; k < key_count; ++k) lists.first[k + 1] += lists.first[k];
  lists.ids.resize(lists.first[key_count]);
  std::vector<std::uint32_t> next(lists.first.begin(), lists.first.end() - 1);
  for (std::size_t i = 0; i < item_count; ++i) {
    if (const std::uint32_t key = key_of(i); key != kNoId) lists.ids[next[key]++] = static_cast<std::uint32_t>(i);
  }
  return lists;
}

}  // namespace

Hierarchy::Sphere enclose_spheres(std::span<const Hierarchy::Sphere> inner, EnclosingBall enclose) {
  if (inner.empty()) return {};
  std::vector<Ball> balls(inner.size());
  for (std::size_t i = 0; i < inner.size(); ++i) balls[i] = {center_of(inner[i]), inner[i].radius};
  const Vec3d middle = enclose(balls).center;
  Hierarchy::Sphere outer{{static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)},
                          0.0F};
  // The centre is rounded first and the radius measured from where it fell.
  const Vec3d center = center_of(outer);
  double radius = 0.0;
  for (const Hierarchy::Sphere& s : inner) radius = std::max(radius, nesting_radius(center, s));
  outer.radius = float_above(radius);
  return outer;
}

float grow_error(double error, float finer) {
  double grown = double{finer} * (1.0 + kErrorGrowth);
  if (error > grown) grown = std::max(grown, std::min(error, double{kMaxStoredError}));  // NaN counts as none
  return grown > 0.0 ? std::max(kMinStoredError, float_above(grown)) : 0.0F;
}

std::vector<float> nest_errors(const LodDag& dag) {
  std::vector<float> errors(dag.groups.size());
  for (std::size_t g = errors.size(); g-- > 0;) {  // from coarse to fine as they lie: the finer ones are behind
    const DagGroup& group = dag.groups[g];
    float finer = 0.0F;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const GroupId own = dag.clusters[c].own_group;
      if (own.is_valid()) finer = std::max(finer, errors[own.value]);
    }
    errors[g] = group.is_terminal ? format::kInfiniteError : grow_error(group.error, finer);
  }
  return errors;
}

LodBounds nest_lod_bounds(const LodDag& dag, std::span<const Hierarchy::Sphere> culling, EnclosingBall enclose) {
  const std::size_t group_count = dag.groups.size();
  LodBounds bounds;
  bounds.spheres.resize(group_count);
  bounds.errors = nest_errors(dag);
  const Lists made = list_by_key(dag.clusters.size(), group_count, [&](std::size_t c) {
    const GroupId own = dag.clusters[c].own_group;
    return own.is_valid() ? own.value : kNoId;
  });
  std::size_t level_count = 0;
  for (const DagGroup& g : dag.groups) level_count = std::max(level_count, std::size_t{g.level} + 1);
  const Lists levels = list_by_key(group_count, level_count, [&](std::size_t g) { return dag.groups[g].level; });

  // A member's own group consumed a finer level than the member's, so it is done before this group's level begins.
  for (std::size_t level = 0; level < level_count; ++level) {
    const std::span<const std::uint32_t> groups = levels.of(level);
    parallel_for_each_index(groups.size(), 16, [&](std::size_t i) {
      const std::uint32_t g = groups[i];
      const DagGroup& group = dag.groups[g];
      std::vector<std::uint32_t> finer_groups;
      std::vector<Hierarchy::Sphere> inner;
      for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
        const GroupId own = dag.clusters[c].own_group;
        if (!own.is_valid()) {
          inner.push_back(culling[c]);
          continue;
        }
        assert(dag.groups[own.value].level < group.level);
        finer_groups.push_back(own.value);
      }
      std::sort(finer_groups.begin(), finer_groups.end());
      finer_groups.erase(std::unique(finer_groups.begin(), finer_groups.end()), finer_groups.end());
      for (const std::uint32_t f : finer_groups) inner.push_back(bounds.spheres[f]);
      for (const std::uint32_t c : made.of(g)) inner.push_back(culling[c]);
      bounds.spheres[g] = enclose_spheres(inner, enclose);
    });
  }
  return bounds;
}

}  // namespace meshlode::builder
