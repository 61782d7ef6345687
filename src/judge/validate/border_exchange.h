// SPDX-License-Identifier: GPL-3.0-or-later
// What one group may do to an open border (docs/explanation/border-proof.md). Internal to the judge.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "judge/validate/borders.h"
#include "judge/validate/surface.h"

namespace meshlode::judge {

/// What changes on an edge: the part of the finer use that goes and the part of the coarser one that comes. Uses of one
/// sign cancel as far as they agree.
struct Exchange {
  std::uint32_t edge;
  std::int32_t removed;  ///< of the finer chain, signed
  std::int32_t added;    ///< by the coarser chain, signed
};

/// A set of clusters: its chain and its triangles, by positions.
struct ClusterSet {
  std::vector<EdgeUse> chain;                           ///< ascending by edge
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< into MeshSurface::positions
};

/// Loops less pieces: the independent loops of the set's border (edges counted as often as used, less positions, plus
/// connected parts), less the pieces of surface, connected across edges, that have a border. A disc has none, a ring
/// one, two discs that touch in a vertex none. At least 0 for a manifold.
[[nodiscard]] std::int64_t count_holes(const MeshSurface& surface, const ClusterSet& set);

/// Ascending by edge; empty if the chains are equal.
[[nodiscard]] std::vector<Exchange> exchanges_of(std::span<const EdgeUse> finer, std::span<const EdgeUse> coarser);

/// The first reason why `coarser` may not stand for `finer`; empty if it may. `exchanges` are those of their chains.
[[nodiscard]] std::string refuse_exchange(const MeshSurface& surface, const BorderSet& border,
                                          std::span<const Exchange> exchanges, const ClusterSet& finer,
                                          const ClusterSet& coarser);

}  // namespace meshlode::judge
