// SPDX-License-Identifier: GPL-3.0-or-later
// A treemap: areas in proportion to sizes. Squarified: Bruls, Huizing, van Wijk, "Squarified Treemaps", 2000.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lab/page/plot.h"

namespace meshlode::lab::page {

struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  [[nodiscard]] double area() const { return width * height; }
};

/// One box each, in the order of the sizes, which together fill `room` without overlap. What is not above 0 or not
/// finite gets a box without area. Long strips are avoided best where sizes descend.
[[nodiscard]] std::vector<Box> squarify(std::span<const double> sizes, const Box& room);

struct TreemapPart {
  std::string name;
  std::uint64_t bytes = 0;
};

struct Treemap {
  std::string id, title, description;
  std::vector<TreemapPart> parts;
};

/// Boxes told apart by colour, hatching and their names; the largest first.
[[nodiscard]] std::string draw_treemap(const Treemap& map, Standing standing);

}  // namespace meshlode::lab::page
