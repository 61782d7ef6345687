// SPDX-License-Identifier: GPL-3.0-or-later
// The connectivity of a group while its edges are collapsed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"
#include "builder/prepared.h"

namespace meshlode::builder {

struct EdgeUse;

/// A vertex and the living corners at it, of the few triangles that a collapse looks at. A vertex with more is a hub:
/// its collapses are refused (SimplifyResult::crowded).
struct Ring {
  static constexpr std::uint32_t kMost = 32;

  std::uint32_t vertex = kNoId;
  std::uint32_t count = 0;
  bool is_hub = false;  ///< then the corners are the first few
  std::array<std::uint32_t, kMost> corner;

  [[nodiscard]] std::span<const std::uint32_t> corners() const { return {corner.data(), count}; }
};

/// Triangles by vertices and wedges, with the triangles around each vertex as a linked list of corners: joining two
/// vertices is then joining two lists. A corner is 3 · triangle + k. Edges have numbers, and a corner knows that of the
/// edge from it to the next corner of its triangle.
class CollapseMesh {
 public:
  static constexpr std::uint32_t kEnd = kNoId;
  using Ends = std::array<std::uint32_t, 2>;  ///< kEnd: the edge is gone

  /// Triangles with two corners on one vertex are dropped at once: they have no area and no border.
  CollapseMesh(const std::vector<WedgeTriangle>& triangles, const std::vector<std::uint32_t>& wedge_position,
               std::size_t vertex_count);
  /// `uses` are those of sorted_edge_uses(). Before the first collapse.
  void number_edges(std::span<const EdgeUse> uses);

  [[nodiscard]] std::uint32_t alive_count() const { return alive_count_; }
  [[nodiscard]] std::size_t triangle_count() const { return is_alive_.size(); }
  [[nodiscard]] std::size_t vertex_count() const { return head_.size(); }
  [[nodiscard]] std::size_t edge_count() const { return ends_.size(); }
  [[nodiscard]] bool is_alive(std::uint32_t triangle) const { return is_alive_[triangle] != 0; }
  [[nodiscard]] std::uint32_t vertex(std::uint32_t corner) const { return vertex_[corner]; }
  [[nodiscard]] std::uint32_t wedge(std::uint32_t corner) const { return wedge_[corner]; }
  void set_wedge(std::uint32_t corner, std::uint32_t wedge) { wedge_[corner] = wedge; }
  [[nodiscard]] std::uint32_t edge(std::uint32_t corner) const { return edge_[corner]; }
  [[nodiscard]] const Ends& ends(std::uint32_t edge) const { return ends_[edge]; }
  [[nodiscard]] static std::uint32_t next_in_triangle(std::uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
  }
  /// The two other vertices of the corner's triangle, in its order.
  [[nodiscard]] std::array<std::uint32_t, 2> others(std::uint32_t corner) const {
    const std::uint32_t next = next_in_triangle(corner);
    return {vertex_[next], vertex_[next_in_triangle(next)]};
  }
  [[nodiscard]] bool has(std::uint32_t triangle, std::uint32_t vertex) const {
    const std::uint32_t* v = &vertex_[3 * std::size_t{triangle}];
    return v[0] == vertex || v[1] == vertex || v[2] == vertex;
  }

  /// The living corners at a vertex, in an order that depends on the history of collapses alone.
  void gather(std::uint32_t vertex, Ring& out);
  /// Whether one of them is as asked.
  template <class IsAsked>
  [[nodiscard]] bool any_corner(std::uint32_t vertex, const IsAsked& is_asked) const {
    for (std::uint32_t corner = head_[vertex]; corner != kEnd; corner = next_[corner]) {
      if (is_alive(corner / 3) && is_asked(corner)) return true;
    }
    return false;
  }

  /// b's vertex becomes a's. `gone` are the triangles that go, the first `on_edge` of them those between the two;
  /// `is_manifold`: at most two triangles stand on an edge, and the link condition holds.
  void join(const Ring& a, const Ring& b, std::span<const std::uint32_t> gone, std::size_t on_edge, bool is_manifold);

 private:
  /// Edges from b to vertices that a has an edge to: the second of a pair becomes the first.
  struct EdgePairs;
  void pair_on(const Ring& a, const Ring& b, std::span<const std::uint32_t> triangles, EdgePairs& out);
  void pair_by_neighbors(const Ring& a, const Ring& b, EdgePairs& out);
  void move_ends(const Ring& b, std::uint32_t a, const EdgePairs& pairs);

  std::vector<std::uint32_t> vertex_, wedge_, next_, edge_;  ///< per corner
  std::vector<std::uint32_t> head_, tail_;                   ///< per vertex
  std::vector<std::uint8_t> is_alive_;                       ///< per triangle
  std::vector<Ends> ends_;                                   ///< per edge
  std::uint32_t alive_count_ = 0;
};

}  // namespace meshlode::builder
