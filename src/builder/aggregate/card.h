// SPDX-License-Identifier: GPL-3.0-or-later
// Cards: what the pieces of an aggregate (leaves, blades, crumbs) are to whoever thins them out. A card is flat, has an
// area, a place and a shape; how it is cut is forgotten.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace meshlode::builder {

using Corners = std::array<Vec3d, 3>;

/// Object units, relative to the mesh's origin.
struct Card {
  Vec3d center{0.0};                  ///< of its area
  Vec3d axis_u{0.0}, axis_v{0.0};     ///< unit, at right angles; u is the longer way
  double half_u = 0.0, half_v = 0.0;  ///< half axes of the ellipse whose second moments it has
  double area = 0.0;                  ///< of what is opaque
  std::uint32_t material = 0;         ///< of the source
  [[nodiscard]] Vec3d normal() const { return glm::cross(axis_u, axis_v); }
};

/// Many cards, with AttributeLayout::stride() floats each.
struct Cards {
  std::vector<Card> cards;
  std::vector<float> attributes;

  [[nodiscard]] std::size_t size() const { return cards.size(); }
};

/// A card on its way to become one triangle. Its area is known but for a factor that its group has in common.
struct Splat {
  Vec3d center{0.0}, axis_u{0.0}, axis_v{0.0};
  double half_u = 0.0, half_v = 0.0;  ///< its shape, and of a blade its length
  double area = 0.0;                  ///< at a factor of 1
  bool is_blade = false;              ///< keeps its length: only its width changes with the area
  std::uint32_t turn = 0;             ///< 0 … 3: which way up
  std::uint32_t material = 0;         ///< of the source

  [[nodiscard]] Vec3d normal() const { return glm::cross(axis_u, axis_v); }
  /// Becomes a blade along u, of so many times the length that a rectangle of its second moments has, around the same
  /// centroid.
  void stretch_to_blade(double times);
  /// Lies another way up, around the same centroid.
  void turn_to(std::uint32_t way_up);

  /// Counter-clockwise around u × v; of factor · area. A blade is as long as its shape says, or as wide,
  /// others have the shape's second moments.
  [[nodiscard]] Corners corners(double factor) const;
};

/// As many splats as cards of a level have become, with their attributes.
struct Splats {
  std::vector<Splat> splats;
  std::vector<float> attributes;
};

}  // namespace meshlode::builder
