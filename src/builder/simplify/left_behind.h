// SPDX-License-Identifier: GPL-3.0-or-later
// How far a collapse leaves the old surface from the new, beyond what quadrics say.
//
// Thin closed features vanish almost free of plane error, and crevices and tunnels close so. What the source points
// behind both vertices would be left at, and how far the new triangles are from the old (new_surface.h), is the truth
// of it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// What each vertex stands for: its witnesses, and all that was joined into it.
class LeftBehind {
 public:
  /// Both of the ends and of the vertices that may go with them.
  static constexpr std::size_t kMostVertices = 10;

  /// `positions` must outlive this.
  LeftBehind(std::vector<Witnesses> witnesses, const std::vector<Vec3i>& positions);

  /// How the collapse is looked at.
  struct Asked {
    bool is_manifold = true;   ///< at most two triangles stand on an edge, and the link condition holds
    bool is_on_border = true;  ///< both ends are
    bool keep_area = false;
  };
  /// The largest squared distance at which the collapse leaves what its vertices stand for: of their witnesses, and of
  /// what goes without a vertex noticing. None where more vertices would go with it than kMostVertices.
  /// \pre the facets are gathered
  [[nodiscard]] std::optional<float> weigh(const CollapseMesh& mesh, const GroupPlaces& places, VertexMarks& marks,
                                           const CollapseStar& star, const Asked& asked);

  /// `into` stands for what `from` stood for too. Of the witnesses weighed last the farthest stay.
  void join(std::uint32_t into, std::uint32_t from);

  [[nodiscard]] const Witnesses& witnesses(std::uint32_t vertex) const { return witnesses_[vertex]; }
  /// The squared diagonal of the box around what the vertex stands for, in the frame.
  [[nodiscard]] double size2(std::uint32_t vertex, const GroupPlaces& places) const;

 private:
  struct Weighed {
    float distance2;
    std::uint32_t vertex, index;  ///< of the vertex's witnesses
  };

  bool find_vanishing(const CollapseMesh& mesh, const GroupPlaces& places, VertexMarks& marks, const CollapseStar& star,
                      const Asked& asked);
  bool find_among_neighbors(const CollapseMesh& mesh, const GroupPlaces& places, VertexMarks& marks,
                            const CollapseStar& star);
  bool look_at(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star, std::uint32_t vertex);
  [[nodiscard]] float distance2_to_rest(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                        const Vec3i& point, float enough) const;
  void weigh_witnesses(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                       std::uint32_t vertex);
  [[nodiscard]] double size2_of_both(const CollapseStar& star, const GroupPlaces& places);

  const std::vector<Vec3i>& positions_;
  std::vector<Witnesses> witnesses_;
  std::vector<std::uint32_t> next_joined_;  ///< per vertex: rings of those that became one
  // Of the collapse weighed last.
  float largest2_ = 0.0F;
  std::array<std::uint32_t, kMostVertices> vertices_;  ///< the ends, and what loses its last triangle with them
  std::array<Weighed, kMostVertices * Witnesses::kCapacity> weighed_;  ///< the farthest first
  std::uint32_t vertex_count_ = 0, weighed_count_ = 0;
};

/// The squared height of a triangle at an end of the star, with that corner at the target: of a sheet that is dropped,
/// above its outer edge before the collapse, and the least of its heights after it, which is what is told.
[[nodiscard]] double height2_of_sheet(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                      std::uint32_t triangle, bool is_least);

}  // namespace meshlode::builder
