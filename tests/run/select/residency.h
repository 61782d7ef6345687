// SPDX-License-Identifier: GPL-3.0-or-later
// Random DAGs in pages, some of which are resident.
#pragma once

#include <cmath>
#include <vector>

#include "run/select/random_dag.h"
#include "run/select/resident.h"

namespace meshlode::run {

using test::RandomSource;
using test::TestTables;
using test::TransformKind;

/// Groups in pages of 1 to `most` each, of one mesh.
inline std::uint32_t deal_pages(RandomSource& random, TestTables& tables, std::uint32_t most) {
  std::uint32_t page = 0, left = 0;
  for (std::size_t g = 0; g < tables.groups.size(); ++g) {
    if (g > 0 && (left == 0 || tables.groups[g].mesh != tables.groups[g - 1].mesh)) {
      ++page;
      left = 0;
    }
    if (left == 0) left = 1 + random.below(most);
    tables.groups[g].page = page;
    --left;
  }
  return page + 1;
}

inline TestTables random_tables(RandomSource& random, std::uint32_t meshes, std::uint32_t leaf_clusters) {
  TestTables tables;
  for (std::uint32_t mesh = 0; mesh < meshes; ++mesh) {
    test::RandomDagOptions options;
    options.leaf_clusters = leaf_clusters + mesh;
    const test::RandomDag made = test::make_random_dag(random, options);
    tables.add_mesh(made.dag, builder::build_hierarchy(made.dag, made.mesh), random.in_cube(10.0));
    for (const TransformKind kind : {TransformKind::kIdentity, TransformKind::kMirrored, TransformKind::kSheared}) {
      tables.instances.push_back(test::make_random_instance(random, kind, 10.0));
      tables.instances.back().mesh = mesh;
    }
  }
  return tables;
}

struct Residency {
  std::vector<std::uint32_t> words;
  explicit Residency(std::uint32_t pages) : words((pages + 31) / 32) {}
  [[nodiscard]] bool has(std::uint32_t page) const { return (words[page / 32] >> page % 32 & 1U) != 0; }
  void add(std::uint32_t page) { words[page / 32] |= 1U << page % 32; }
};

inline Residency random_residency(RandomSource& random, const TestTables& tables, std::uint32_t pages, double chance,
                                  bool has_roots) {
  Residency out(pages);
  for (std::uint32_t p = 0; p < pages; ++p) {
    if (random.chance(chance)) out.add(p);
  }
  for (const format::GroupRecord& group : tables.groups) {
    if (has_roots && (group.flags & format::kGroupTerminal) != 0) out.add(group.page);
  }
  return out;
}

inline bool fails(const MetricView& view, const format::GroupRecord& group) {
  return !metric_passes(view, group.center[0], group.center[1], group.center[2], group.radius, group.error);
}

class Selected {
 public:
  explicit Selected(const SelectTables& tables) : selector(tables), items_(1) {}
  std::span<const ClusterInstance> operator()(const SelectTables& tables, const ResidentQuery& query) {
    std::size_t count = selector.select(tables, query, items_);
    if (count > items_.size()) {
      items_.resize(count);
      count = selector.select(tables, query, items_);
    }
    return std::span(items_).first(count);
  }
  ResidentSelector selector;

 private:
  std::vector<ClusterInstance> items_;
};

inline std::vector<ClusterInstance> copy_of(std::span<const ClusterInstance> items) {
  return {items.begin(), items.end()};
}

/// In world space, by the words of it.
inline bool is_sphere_outside(const Frustum& frustum, const format::InstanceRecord& instance,
                              const format::MeshRecord& mesh, const format::CullSphere& sphere) {
  const double* m = instance.transform;
  for (const auto& plane : frustum.planes) {
    double at = plane[3], reach2 = 0.0;
    for (int row = 0; row < 3; ++row) at += plane[row] * m[4 * row + 3];
    for (int axis = 0; axis < 3; ++axis) {
      const double n = plane[0] * m[axis] + plane[1] * m[4 + axis] + plane[2] * m[8 + axis];
      at += n * (mesh.origin[axis] + sphere.center[axis]);
      reach2 += n * n;
    }
    if (at < -sphere.radius * std::sqrt(reach2)) return true;
  }
  return false;
}

}  // namespace meshlode::run
