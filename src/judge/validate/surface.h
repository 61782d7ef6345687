// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh of an asset as a judge sees it: decoded integers, positions named by value, and the border of every cluster as
// a chain of edges. Two vertices are one position if and only if their grid integers are equal (I3), so a crack is an
// edge that does not cancel, whatever the build believed.
//
// The *chain* of a set of triangles gives each undirected edge of positions the number of its uses from lower to higher
// position minus those the other way; edges between equal positions are left out. Chains add, and a closed surface's
// chain is zero: with the chains of clusters at hand, a group or a cut costs a sum.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace meshlode::judge {

struct EdgeUse {
  std::uint32_t edge = 0;  ///< into MeshSurface::edges
  std::int32_t net = 0;    ///< never 0
};

struct MeshSurface {
  MeshId mesh;
  std::uint32_t first_cluster = 0, cluster_count = 0;
  std::uint32_t first_group = 0, group_count = 0;
  std::vector<Vec3i> positions;                                ///< distinct, ascending
  std::vector<std::uint32_t> first_vertex;                     ///< per cluster of the mesh, one more at the end
  std::vector<std::uint32_t> vertex_position;                  ///< into positions
  std::vector<std::uint64_t> vertex_attributes;                ///< hash of the channels after the position
  std::vector<std::uint32_t> first_triangle;                   ///< per cluster of the mesh, one more at the end
  std::vector<std::array<std::uint8_t, 3>> triangle_vertices;  ///< local to the cluster
  std::vector<std::array<std::uint32_t, 2>> edges;             ///< positions, ascending; those of some cluster's chain
  std::vector<std::uint32_t> first_use;                        ///< per cluster of the mesh, one more at the end
  std::vector<EdgeUse> uses;                                   ///< ascending by edge within a cluster
  std::vector<std::vector<std::uint32_t>> made;  ///< per group of the mesh: clusters (of the mesh) made from it

  [[nodiscard]] std::span<const EdgeUse> chain(std::uint32_t cluster) const {
    return std::span(uses).subspan(first_use[cluster], first_use[cluster + 1] - first_use[cluster]);
  }
  [[nodiscard]] std::span<const std::array<std::uint8_t, 3>> triangles(std::uint32_t cluster) const {
    return std::span(triangle_vertices)
        .subspan(first_triangle[cluster], first_triangle[cluster + 1] - first_triangle[cluster]);
  }
};

/// The surface of a mesh from its clusters, one after the other, so that they need not all be decoded at once.
class SurfaceBuilder {
 public:
  /// \pre every id of the mesh's tables is in range
  SurfaceBuilder(const run::Asset& asset, MeshId mesh);
  /// Each cluster of the mesh, in order.
  void add(const run::DecodedCluster& cluster);
  [[nodiscard]] MeshSurface finish();

 private:
  struct PositionKey {
    std::int32_t x, y, z;
    std::uint32_t vertex;
    auto operator<=>(const PositionKey&) const = default;
  };
  void name_positions();
  void add_chains();

  const run::Asset& asset_;
  MeshSurface surface_;
  std::vector<PositionKey> keys_;  ///< of all vertices
};

/// \pre every id of the mesh's tables is in range; `clusters` is decode_all of the asset
[[nodiscard]] MeshSurface build_surface(const run::Asset& asset, MeshId mesh,
                                        std::span<const run::DecodedCluster> clusters);

/// The sum of the chains of clusters (indices within the mesh), ascending, without zeros.
[[nodiscard]] std::vector<EdgeUse> sum_chains(const MeshSurface& surface, std::span<const std::uint32_t> clusters);

/// Calls visit(edge, finer, coarser) for every edge of either chain, ascending.
template <class Visit>
void for_each_edge(std::span<const EdgeUse> finer, std::span<const EdgeUse> coarser, const Visit& visit) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < finer.size() || j < coarser.size()) {
    const bool take_finer = j == coarser.size() || (i < finer.size() && finer[i].edge <= coarser[j].edge);
    const bool take_coarser = i == finer.size() || (j < coarser.size() && coarser[j].edge <= finer[i].edge);
    const std::uint32_t edge = take_finer ? finer[i].edge : coarser[j].edge;
    visit(edge, take_finer ? finer[i].net : 0, take_coarser ? coarser[j].net : 0);
    if (take_finer) ++i;
    if (take_coarser) ++j;
  }
}

/// "(1 2 3)"
[[nodiscard]] std::string position_text(const MeshSurface& surface, std::uint32_t position);
/// "(1 2 3)-(4 5 6)"
[[nodiscard]] std::string edge_text(const MeshSurface& surface, std::uint32_t edge);

}  // namespace meshlode::judge
