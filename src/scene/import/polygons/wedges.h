// SPDX-License-Identifier: GPL-3.0-or-later
// Corners that have attributes of their own become vertices: one for each position and what its corners say.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "scene/import/polygons/polygon_soup.h"

namespace meshlode::scene {

/// What a corner says for itself; nothing of what it does not.
struct WedgeAttributes {
  std::optional<Vec2f> uv;
  std::optional<Vec3f> normal;
  std::optional<Vec4f> color;
};

class WedgeBuilder {
 public:
  /// The positions are soup.positions; the soup's other arrays that are as long as these are carried along.
  explicit WedgeBuilder(PolygonSoup& soup);
  /// The vertex of such a corner: the position's own the first time, later a new one.
  std::uint32_t take(std::uint32_t position, const WedgeAttributes& attributes);

 private:
  using Key = std::array<std::uint32_t, 11>;  // position, which attributes there are, and their bits
  void set(std::uint32_t vertex, const WedgeAttributes& attributes);
  PolygonSoup& soup_;
  std::vector<bool> is_used_;
  std::map<Key, std::uint32_t> wedges_;
};

}  // namespace meshlode::scene
