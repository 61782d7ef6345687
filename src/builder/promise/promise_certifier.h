// SPDX-License-Identifier: GPL-3.0-or-later
// The certified tier for what is promised (docs/reference/selection.md, "What is promised"): the induction of
// deviation/certify.cpp over the finished DAG, in the product space, where triangles are as flat as in three
// dimensions. Level 0 is covered by the source and the source by level 0; then each group hands on what is proven of
// the triangles of its members to the triangles that were made of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "builder/deviation/deviation.h"
#include "builder/lod_dag.h"
#include "builder/measure/groups_by_level.h"
#include "builder/promise/painted_source.h"
#include "builder/promise/partners.h"
#include "builder/promise/product_cover.h"
#include "builder/promise/product_surfaces.h"
#include "builder/promise/product_tree.h"
#include "format/grid.h"

namespace meshlode::builder {

/// Per group, object units of the product space, without a margin; and of level 0 alone.
struct ProductDeviations {
  std::vector<double> groups;
  double level0 = 0.0;
};

template <std::size_t D>
class PromiseCertifier {
 public:
  /// What is given must outlive this. `quantization`: what it moves a point by; pieces of level 0 that are so near are
  /// good enough.
  PromiseCertifier(const ProductSurfaces<D>& surfaces, const LodDag& dag, const format::PositionGrid& grid,
                   double quantization)
      : surfaces_(surfaces), dag_(dag), grid_(grid), quantization_(quantization) {}

  /// \pre the source has on_grid
  [[nodiscard]] ProductDeviations certify(const PaintedSource& source) const {
    ProductDeviations found;
    found.groups.assign(dag_.groups.size(), 0.0);
    std::vector<std::vector<TriangleBound>> bounds(dag_.clusters.size());
    found.level0 = certify_level0(source, bounds);
    const std::vector<std::vector<std::uint32_t>> outputs = clusters_made_of_groups(dag_);
    for (const std::vector<std::uint32_t>& groups : groups_by_level(dag_)) {
      // Clusters belong to one group, and are made from one: nobody else writes there.
      parallel_for_each_index(groups.size(), 1, [&](std::size_t i) {
        const DagGroup& group = dag_.groups[groups[i]];
        if (!group.is_terminal) found.groups[groups[i]] = certify_group(group, outputs[groups[i]], bounds);
      });
    }
    return found;
  }

 private:
  using Surface = ProductSurface<D>;
  using Bounds = std::vector<std::vector<TriangleBound>>;  // per cluster, of the triangles that has_points()

  /// The triangles of some clusters that something is measured of, and how many each has.
  struct Triangles {
    Surface surface;
    std::vector<std::size_t> count;  ///< per cluster
  };
  [[nodiscard]] Triangles triangles_of(std::span<const std::uint32_t> clusters) const {
    Triangles out;
    for (const std::uint32_t c : clusters) {
      const std::size_t first = out.surface.triangles.size();
      surfaces_.add_cluster(dag_.clusters[c], out.surface);
      leave_out_pointless(out.surface, first);
      out.count.push_back(out.surface.triangles.size() - first);
    }
    return out;
  }
  /// Of the triangles from `first` on. Returns which are left, counted from there.
  std::vector<std::uint32_t> leave_out_pointless(Surface& surface, std::size_t first) const {
    std::vector<std::uint32_t> kept;
    for (std::size_t t = first; t < surface.triangles.size(); ++t) {
      if (!surfaces_.has_points(surface, static_cast<std::uint32_t>(t))) continue;
      surface.triangles[first + kept.size()] = surface.triangles[t];
      kept.push_back(static_cast<std::uint32_t>(t - first));
    }
    surface.triangles.resize(first + kept.size());
    return kept;
  }

  static void keep(std::span<const std::uint32_t> clusters, const Triangles& of, const CertifiedGroup& step,
                   Bounds& bounds) {
    auto begin = step.bounds.begin();
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      const auto end = begin + static_cast<std::ptrdiff_t>(of.count[i]);
      bounds[clusters[i]].assign(begin, end);
      begin = end;
    }
  }

  double certify_level0(const PaintedSource& painted, Bounds& bounds) const {
    std::vector<std::uint32_t> clusters;
    for (std::uint32_t c = 0; c < dag_.clusters.size(); ++c) {
      if (!dag_.clusters[c].own_group.is_valid()) clusters.push_back(c);
    }
    const Triangles level0 = triangles_of(clusters);
    Surface source = surfaces_.of_source(painted);
    const std::vector<std::uint32_t> numbers = leave_out_pointless(source, 0);
    const std::vector<TriangleBound> nothing(source.triangles.size());
    const CertifiedGroup step =
        hand_on(source, nothing, level0.surface, quantization_, find_partners(painted, numbers, level0.surface, grid_));
    keep(clusters, level0, step, bounds);
    return step.deviation;
  }

  /// Takes the bounds of the members, leaves those of what was made of them.
  double certify_group(const DagGroup& group, std::span<const std::uint32_t> outputs, Bounds& bounds) const {
    std::vector<std::uint32_t> members(group.cluster_count);
    std::vector<TriangleBound> known;
    for (std::uint32_t i = 0; i < group.cluster_count; ++i) {
      const std::uint32_t c = members[i] = group.first_cluster + i;
      known.insert(known.end(), bounds[c].begin(), bounds[c].end());
      bounds[c] = {};
    }
    const Triangles finer = triangles_of(members), coarser = triangles_of(outputs);
    const CertifiedGroup step = hand_on(finer.surface, known, coarser.surface, 0.0);
    keep(outputs, coarser, step, bounds);
    return step.deviation;
  }

  const ProductSurfaces<D>& surfaces_;
  const LodDag& dag_;
  format::PositionGrid grid_;
  double quantization_;
};

}  // namespace meshlode::builder
