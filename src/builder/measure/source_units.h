// SPDX-License-Identifier: GPL-3.0-or-later
// The source in *units*: a few neighbouring triangles of one cluster of level 0. A ball around a unit dismisses all of
// it at once where a level's surface is near.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/deviation/source_tree.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder {

class SourceUnits {
 public:
  struct Unit {
    Vec3d center{0.0};
    double radius = 0.0;  ///< of the ball around its triangles
    std::uint32_t first_vertex = 0, vertex_count = 0;
    std::uint32_t first_triangle = 0, triangle_count = 0;
  };
  struct Triangle {
    std::uint32_t id = 0;                  ///< of the source
    std::array<std::uint8_t, 3> corner{};  ///< among the unit's vertices
  };

  SourceUnits() = default;
  /// `cluster_of`: of level 0, per source triangle. Units come in the order of their clusters.
  SourceUnits(const SourceTree::Impl& source, std::span<const std::uint32_t> cluster_of, std::size_t cluster_count);

  [[nodiscard]] const std::vector<Unit>& units() const { return units_; }
  [[nodiscard]] std::span<const std::uint32_t> vertices(const Unit& unit) const {
    return std::span(vertices_).subspan(unit.first_vertex, unit.vertex_count);
  }
  [[nodiscard]] std::span<const Triangle> triangles(const Unit& unit) const {
    return std::span(triangles_).subspan(unit.first_triangle, unit.triangle_count);
  }
  /// Of all units together.
  [[nodiscard]] std::size_t vertex_count() const { return vertices_.size(); }
  /// The units of a cluster of level 0.
  [[nodiscard]] std::uint32_t first_unit(std::uint32_t cluster) const { return first_unit_[cluster]; }
  [[nodiscard]] std::uint32_t end_unit(std::uint32_t cluster) const { return first_unit_[cluster + 1]; }
  /// Triangles do not close around it.
  [[nodiscard]] bool is_border(std::uint32_t vertex) const { return is_border_[vertex] != 0; }

 private:
  /// The units of some clusters, numbered from 0.
  struct Block {
    std::vector<Unit> units;
    std::vector<std::uint32_t> vertices;
    std::vector<Triangle> triangles;

    void add_unit(const SourceTree::Impl& source, std::span<const std::uint32_t> triangles_of_unit);
  };
  void divide(const SourceTree::Impl& source, std::span<const std::uint32_t> cluster_of, std::size_t cluster_count);
  void append(Block&& block);
  void find_borders(const SourceTree::Impl& source);

  std::vector<Unit> units_;
  std::vector<std::uint32_t> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> first_unit_;  ///< per cluster, and the end
  std::vector<std::uint8_t> is_border_;
};

}  // namespace meshlode::builder
