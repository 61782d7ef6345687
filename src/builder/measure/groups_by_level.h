// SPDX-License-Identifier: GPL-3.0-or-later
// The finished DAG from fine to coarse.
#pragma once

#include <cstdint>
#include <vector>

#include "builder/lod_dag.h"

namespace meshlode::builder {

/// Of each group the clusters that were made of it.
inline std::vector<std::vector<std::uint32_t>> clusters_made_of_groups(const LodDag& dag) {
  std::vector<std::vector<std::uint32_t>> made(dag.groups.size());
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    if (dag.clusters[c].own_group.is_valid()) made[dag.clusters[c].own_group.value].push_back(c);
  }
  return made;
}

/// The groups of each level, fine to coarse: all members of one come from level 0 or from levels before its own.
inline std::vector<std::vector<std::uint32_t>> groups_by_level(const LodDag& dag) {
  std::vector<std::vector<std::uint32_t>> levels;
  for (std::uint32_t g = 0; g < dag.groups.size(); ++g) {
    if (dag.groups[g].level >= levels.size()) levels.resize(std::size_t{dag.groups[g].level} + 1);
    levels[dag.groups[g].level].push_back(g);
  }
  return levels;
}

}  // namespace meshlode::builder
