// SPDX-License-Identifier: GPL-3.0-or-later
// The star of a collapse: the triangles around both ends of an edge, gathered once for all that weighs the collapse.
// First its connectivity, which most refusals need, then its triangles in lanes of four, around the target.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/deviation/four_triangles.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/group_places.h"

namespace meshlode::builder {

/// One search marks vertices without any of them being unmarked after it.
class VertexMarks {
 public:
  explicit VertexMarks(std::size_t vertex_count) : mark_(vertex_count, 0) {}
  void start_search() { now_ += 2; }
  void mark(std::uint32_t vertex) { mark_[vertex] = now_; }
  void mark_twice(std::uint32_t vertex) { mark_[vertex] = now_ + 1; }
  void unmark(std::uint32_t vertex) { mark_[vertex] = 0; }
  [[nodiscard]] bool is_marked_once(std::uint32_t vertex) const { return mark_[vertex] == now_; }
  [[nodiscard]] bool is_marked_twice(std::uint32_t vertex) const { return mark_[vertex] == now_ + 1; }

 private:
  std::vector<std::uint32_t> mark_;
  std::uint32_t now_ = 0;
};

/// Four triangles in floats, as distances are asked of them.
struct FourFacets {
  FourTriangles triangles;
  FourTriangleTerms terms;
};

struct CollapseStar {
  /// What a triangle around the joined vertex has beside it.
  struct OuterEdge {
    std::uint32_t x, y;    ///< in the triangle's order
    std::uint32_t corner;  ///< of the triangle as it is, at a or b
  };
  static constexpr std::size_t kMostOuter = 2 * Ring::kMost;
  static constexpr std::size_t kMostOnEdge = 8;  ///< an edge with more triangles is refused as a hub is
  static constexpr std::size_t kMostGone = kMostOnEdge + kMostOuter;

  Ring a, b;
  Vec3d target{0.0};  ///< in the group's frame

  // gather_star()
  std::array<OuterEdge, kMostOuter> outer_edges;
  std::uint32_t outer_count = 0;
  std::array<std::uint32_t, kMostGone>
      gone_triangles;  ///< those on the edge, then sheets: pairs that lie on each other
  std::uint32_t gone_count = 0, on_edge = 0;
  std::array<std::uint32_t, kMostOnEdge> tips;  ///< of the triangles on the edge
  std::uint32_t common_neighbors = 0;           ///< of a and b
  bool has_tip_edges = false;                   ///< with two tips or more: at a and at b, a triangle has two of them

  // gather_facets(): `fresh` around the target, `old` as they are, in the order of the outer edges
  std::array<FourFacets, kMostOuter / 4> fresh;
  std::array<FourFacets, kMostOuter / 4 + (kMostGone + 3) / 4> old;  ///< and of what goes, where add_gone() is asked

  [[nodiscard]] std::span<const OuterEdge> outer() const { return {outer_edges.data(), outer_count}; }
  [[nodiscard]] std::span<const std::uint32_t> gone() const { return {gone_triangles.data(), gone_count}; }
  [[nodiscard]] std::span<const std::uint32_t> sheets() const { return gone().subspan(on_edge); }
  [[nodiscard]] std::size_t block_count() const { return (outer_count + 3) / 4; }
};

enum class Gathered : std::uint8_t { kStar, kNoTriangle, kTooMany };

/// What its edge has around it. \pre the rings are gathered, neither of them a hub's
[[nodiscard]] Gathered gather_star(const CollapseMesh& mesh, VertexMarks& marks, CollapseStar& star);

/// Pairs of triangles that would lie on each other in opposite orientation go: they enclose nothing and have no border.
void move_sheets_out(CollapseStar& star);

/// \pre star.target is set
void gather_facets(const CollapseMesh& mesh, const GroupPlaces& places, CollapseStar& star);

/// Puts the triangles that go behind the old ones. Returns how many blocks there are then.
std::size_t add_gone(const CollapseMesh& mesh, const GroupPlaces& places, CollapseStar& star);

/// The least squared distance of a point, from the target, to all triangles of the blocks.
[[nodiscard]] inline float distance2_to(std::span<const FourFacets> blocks, const Vec3f& point) {
  const Vec3Lanes p{lanes(point.x), lanes(point.y), lanes(point.z)};
  Lanes nearest = distances2_to(blocks[0].triangles, blocks[0].terms, p);
  for (std::size_t i = 1; i < blocks.size(); ++i) {
    nearest = min_lanes(nearest, distances2_to(blocks[i].triangles, blocks[i].terms, p));
  }
  return least_lane(nearest)[0];
}

}  // namespace meshlode::builder
