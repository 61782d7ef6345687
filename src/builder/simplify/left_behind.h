// SPDX-License-Identifier: GPL-3.0-or-later
// How far a collapse leaves the old surface from the new, beyond what quadrics say.
//
// Thin closed features vanish almost free of plane error, and crevices and tunnels close so. What the source points
// behind both vertices would be left at, and how far the new triangles are from the old (new_surface.h), is the truth
// of it.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/simplify.h"
#include "builder/simplify/star_facets.h"

namespace meshlode::builder {

struct WeighedWitness {
  double distance2;  ///< to the new star, in the frame
  Vec3i point;
  std::uint32_t id;
};

/// What each vertex stands for: its witnesses, and the box around all input vertices that came to it.
class LeftBehind {
 public:
  /// `witnesses` per vertex.
  LeftBehind(std::vector<Witnesses> witnesses, const GroupPlaces& places);

  /// The largest squared distance, in the frame, at which the collapse leaves what its vertices stand for: their
  /// witnesses, and what goes without a vertex noticing. \pre star.outer and star.sheets are gathered
  [[nodiscard]] double weigh(CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star, bool keep_area);

  /// `into` stands for what `from` stood for too. Of the witnesses weighed last the farthest stay.
  void join(std::uint32_t into, std::uint32_t from);

  /// Drops the pairs of triangles around the vertex that lie on each other. Such a sheet has no plane error, but it was
  /// there: returns its smallest height, or the size of what stood behind vertices that go with it, in the frame.
  [[nodiscard]] double drop_sheets(CollapseMesh& mesh, const GroupPlaces& places, std::uint32_t vertex) const;

  [[nodiscard]] const Witnesses& witnesses(std::uint32_t vertex) const { return witnesses_[vertex]; }
  /// The diagonal of what the vertex stands for, in the frame.
  [[nodiscard]] double size(std::uint32_t vertex) const { return merged_[vertex].diagonal(); }

 private:
  struct Box {
    Vec3d low, high;
    [[nodiscard]] double diagonal() const { return std::sqrt(glm::dot(high - low, high - low)); }
  };

  [[nodiscard]] double collect_vanishing(CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star);
  void gather_facets(const GroupPlaces& places, const CollapseStar& star);
  /// \pre the facets are gathered
  [[nodiscard]] double weigh_witnesses(std::uint32_t vertex, const GroupPlaces& places);
  [[nodiscard]] double distance2_to_rest(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                         double least) const;

  std::vector<Witnesses> witnesses_;
  std::vector<Box> merged_;
  // Of the collapse weighed last.
  std::vector<std::uint32_t> vanishing_;  ///< vertices that lose their last triangle with it
  std::vector<WeighedWitness> weighed_;
  StarFacets facets_;  ///< the new star
  std::vector<std::uint32_t> corners_;
  std::uint64_t stamp_ = 0;  ///< what is marked with it was marked in this search
  std::vector<std::uint64_t> vertex_stamp_;
};

}  // namespace meshlode::builder
