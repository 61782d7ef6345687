// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of a group's deviation while a DAG is built, for each tier (I7, docs/architecture.md), and what is
// handed on from level to level to know it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "builder/dag/build_dag.h"
#include "builder/dag/level_pool.h"
#include "builder/deviation/deviation.h"
#include "builder/prepared.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// Of one simplified group.
struct GroupErrors {
  double deviation = 0.0;         ///< object units: of this group alone
  double error = 0.0;             ///< object units: with the tier's margin, and not below those of the finer groups
  double normal_deviation = 0.0;  ///< degrees
  double uv_deviation = 0.0;      ///< UV units
  CarriedTruth carried;           ///< for the triangles of the result
};

class GroupMeter {
 public:
  /// The mesh's frame and exact triangles must outlive the meter. kQuadric measures nothing.
  GroupMeter(const PreparedMesh& mesh, ErrorSource tier);

  [[nodiscard]] bool is_measuring() const { return source_.has_value(); }
  /// For the triangles of level 0, which the mesh still has; `pool` has its positions.
  [[nodiscard]] CarriedTruth level0(const BuildPool& pool) const;
  /// `clusters` of the pool, with their triangles in `finer`, became `coarser`.
  [[nodiscard]] GroupErrors measure(const BuildPool& pool, const std::vector<ClusterId>& clusters,
                                    const SimplifyInput& finer, const SimplifyResult& coarser,
                                    std::size_t groups_of_round) const;

 private:
  const PreparedMesh& mesh_;
  bool is_certified_;
  std::optional<SourceTree> source_;
  std::vector<std::uint32_t> wedge_of_exact_;  ///< by id in the exact triangles; empty: they are those of wedges
};

}  // namespace meshlode::builder
