// SPDX-License-Identifier: GPL-3.0-or-later
// What the detectors ask of a mesh: points where positions are equal, the triangles between them, and edges in order.
// Everything is sorted, nothing hashed, so that no mesh can make it quadratic: O(n log n).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/box.h"
#include "base/vec.h"
#include "scene/detect/fault.h"
#include "scene/scene.h"

namespace meshlode::scene {

enum class TriangleKind : std::uint8_t {
  kSound,
  kNotFinite,   ///< a corner without a vertex, or at no finite position
  kDegenerate,  ///< without area
  kDuplicate,   ///< on the same points, with the same material, as an earlier triangle
};

/// An edge of a sound triangle, from corner `corner` to the next one.
struct TopologyEdge {
  std::uint32_t low = 0, high = 0;  ///< points, low < high
  std::uint32_t triangle = 0;
  std::uint8_t corner = 0;
  bool is_forward = true;  ///< the triangle runs from low to high

  /// The triangle's corners at `low` and at `high`.
  [[nodiscard]] std::uint32_t corner_low() const { return is_forward ? corner : (corner + 1U) % 3U; }
  [[nodiscard]] std::uint32_t corner_high() const { return is_forward ? (corner + 1U) % 3U : corner; }
};

/// All primitives of a mesh together.
struct Topology {
  std::vector<Vec3d>
      points;             ///< distinct finite positions of triangles over `unit`: within 1, or 8 at the end of doubles
  double unit = 1.0;      ///< a power of two: object units in a unit of `points`
  Box3d box;              ///< of `points`, in their unit
  double diagonal = 0.0;  ///< of the box
  double median_edge = 0.0;  ///< of the three edges of each sound triangle, in that unit; 0 where there are none
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< points; kNoId of a triangle that is kNotFinite
  std::vector<std::array<std::uint32_t, 3>> vertices;   ///< of the same corners, numbered through all primitives
  std::vector<std::uint32_t> first_vertex;              ///< of each primitive, and one past the last
  std::vector<std::uint32_t> first_triangle;            ///< of each primitive, and one past the last
  std::vector<TriangleKind> kinds;
  std::vector<std::uint8_t> is_reversed;  ///< 1: a duplicate that faces the other way than the first on its points
  std::vector<TopologyEdge> edges;        ///< of sound triangles, by low, high, triangle

  [[nodiscard]] std::uint32_t primitive_of(std::uint32_t triangle) const;
  [[nodiscard]] FaultTriangle name_of_triangle(std::uint32_t triangle) const;
  [[nodiscard]] bool has_edge(std::uint32_t a, std::uint32_t b) const;
  /// In the unit of `points`, not normalized: twice the area long.
  [[nodiscard]] Vec3d area_normal(std::uint32_t triangle) const;

  /// Calls body(std::span<const TopologyEdge>) for each run of edges between the same two points.
  template <class Body>
  void for_each_edge(const Body& body) const {
    for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
      while (end < edges.size() && edges[end].low == edges[first].low && edges[end].high == edges[first].high) ++end;
      body(std::span(edges).subspan(first, end - first));
    }
  }
};

/// Whether ids of 32 bits suffice for a mesh; a larger one cannot be built either.
[[nodiscard]] bool is_countable(const SourceMesh& mesh);

/// Any indices and positions, whatever they hold. \pre is_countable(mesh)
[[nodiscard]] Topology make_topology(const SourceMesh& mesh);

/// Triangles that a fault concerns: each once, whoever names it again.
class ConcernedTriangles {
 public:
  explicit ConcernedTriangles(const Topology& topology)
      : topology_(topology), is_marked_(topology.triangles.size(), 0) {}
  void mark(std::uint32_t triangle) {
    count_ += is_marked_[triangle] == 0 ? 1U : 0U;
    is_marked_[triangle] = 1;
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Of all triangles of the mesh; 0 of a mesh without any.
  [[nodiscard]] double share() const;
  /// Into the fault: their number and the first of them.
  void list_in(Fault& fault) const;

 private:
  const Topology& topology_;
  std::vector<std::uint8_t> is_marked_;
  std::uint64_t count_ = 0;
};

}  // namespace meshlode::scene
