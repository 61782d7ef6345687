// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a group while edges collapse: connectivity alone, no geometry decisions.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "builder/prepared.h"

namespace meshlode::builder {

/// Triangles by vertices and wedges, with the triangles around each vertex as a linked list of corners: joining two
/// vertices is then joining two lists. A corner is 3 · triangle + k.
class CollapseMesh {
 public:
  static constexpr std::uint32_t kEnd = 0xFFFFFFFFU;

  /// Triangles with two corners on one vertex are dropped at once: they have no area and no border.
  CollapseMesh(const std::vector<WedgeTriangle>& triangles, const std::vector<std::uint32_t>& wedge_position,
               std::size_t vertex_count);

  [[nodiscard]] std::uint32_t alive_count() const { return alive_count_; }
  [[nodiscard]] std::size_t triangle_count() const { return is_alive_.size(); }
  [[nodiscard]] std::size_t vertex_count() const { return head_.size(); }
  [[nodiscard]] bool is_alive(std::uint32_t triangle) const { return is_alive_[triangle] != 0; }
  [[nodiscard]] std::uint32_t vertex(std::uint32_t corner) const { return vertex_[corner]; }
  [[nodiscard]] std::uint32_t wedge(std::uint32_t corner) const { return wedge_[corner]; }
  void set_wedge(std::uint32_t corner, std::uint32_t wedge) { wedge_[corner] = wedge; }
  [[nodiscard]] static std::uint32_t next_in_triangle(std::uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
  }
  /// The two other vertices of the corner's triangle, in its order.
  [[nodiscard]] std::array<std::uint32_t, 2> others(std::uint32_t corner) const {
    const std::uint32_t next = next_in_triangle(corner);
    return {vertex_[next], vertex_[next_in_triangle(next)]};
  }

  /// The living corners at a vertex, in an order that depends on the history of collapses alone.
  void corners_of(std::uint32_t vertex, std::vector<std::uint32_t>& out);

  /// Moves all corners of `from` to `to` and drops the triangles that held both.
  void merge_vertices(std::uint32_t to, std::uint32_t from);

  /// Drops pairs of triangles around `vertex` that cover the same three vertices in opposite orientation: together they
  /// have no border and enclose nothing. `dropped` lists one triangle of each pair.
  void drop_opposite_pairs(std::uint32_t vertex, std::vector<std::uint32_t>& dropped);

 private:
  void kill(std::uint32_t triangle) {
    is_alive_[triangle] = 0;
    --alive_count_;
  }

  std::vector<std::uint32_t> vertex_, wedge_, next_;  ///< per corner
  std::vector<std::uint32_t> head_, tail_;            ///< per vertex
  std::vector<std::uint8_t> is_alive_;                ///< per triangle
  std::uint32_t alive_count_ = 0;
};

}  // namespace meshlode::builder
