// SPDX-License-Identifier: GPL-3.0-or-later
// What of some triangles is farther from a surface than what is known, by bounds. A part of a triangle is left where
// its middle is near and it is small, or one triangle of the surface is near to all of it; what may be farthest is
// divided first. Complete where the surface's triangles are large against the distance, and else as far as its effort
// goes.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/vec.h"
#include "build/deviation/surface_tree.h"

namespace meshlode::build {

class BoundedSearch {
 public:
  /// A point that was farther.
  struct Found {
    double distance = 0.0;  ///< object units, measured exactly; 0: there was none
    Vec3d at{0.0};
    TreeSlot place;  ///< of what is nearest to it
  };

  /// Nothing is looked for within `margin` times what is known: `known`, and then what is found. \pre margin >= 1. The
  /// tree must outlive this.
  BoundedSearch(const SurfaceTree& tree, double margin, double known)
      : tree_(tree), margin_(margin), beyond_(margin * known) {}

  /// Whether all of a triangle is known not to be beyond. Its middle is measured. `place`: of the tree, where the
  /// search for what is nearest to the middle begins; may be invalid.
  [[nodiscard]] bool is_within(const std::array<Vec3d, 3>& corners, TreeSlot place) {
    Part part{corners, place};
    return is_within(part);
  }
  /// The same, and what may be beyond is divided by run().
  void add(const std::array<Vec3d, 3>& corners, TreeSlot place);
  /// At most so many parts are made.
  void run(std::size_t parts);

  /// The farthest.
  [[nodiscard]] const Found& found() const { return found_; }

 private:
  /// Of a triangle, or all of it.
  struct Part {
    std::array<Vec3d, 3> corner;
    TreeSlot place;
    double bound = std::numeric_limits<double>::infinity();  ///< no point of it is farther from the surface

    [[nodiscard]] bool operator<(const Part& other) const { return bound < other.bound; }
    [[nodiscard]] std::array<Part, 4> divided() const;
  };

  [[nodiscard]] bool is_within(Part& part);

  const SurfaceTree& tree_;
  double margin_, beyond_;  ///< no nearer point is of use
  Found found_;
  std::vector<Part> parts_;
};

}  // namespace meshlode::build
