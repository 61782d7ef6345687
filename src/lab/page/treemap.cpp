// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/treemap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lab/page/numbers.h"
#include "lab/page/palette.h"

namespace meshlode::lab::page {

namespace {

constexpr double kWidth = 480.0, kHeight = 290.0;

/// The worst ratio of sides in a row of boxes along a side of the length `side`.
double worst_ratio(double sum, double smallest, double largest, double side) {
  const double square = side * side, sum_square = sum * sum;
  return std::max(square * largest / sum_square, sum_square / (square * smallest));
}

/// Puts areas[begin, end) in one row along the shorter side of the room, and takes it away from the room.
void place_row(std::span<const double> areas, std::span<const std::size_t> row, Box& room, std::vector<Box>& boxes) {
  double sum = 0.0;
  for (const std::size_t i : row) sum += areas[i];
  const bool is_column = room.width >= room.height;
  const double side = is_column ? room.height : room.width;
  const double depth = side > 0.0 ? std::min(sum / side, is_column ? room.width : room.height) : 0.0;
  double done = 0.0;
  for (const std::size_t i : row) {
    const double start = side * done / sum;
    done += areas[i];
    const double length = side * done / sum - start;
    boxes[i] = is_column ? Box{room.x, room.y + start, depth, length} : Box{room.x + start, room.y, length, depth};
  }
  if (is_column) {
    room.x += depth;
    room.width -= depth;
  } else {
    room.y += depth;
    room.height -= depth;
  }
}

/// Lines of six directions and spacings; 0 is none.
std::string hatch_path(std::size_t kind) {
  static constexpr std::array kPaths = {
      "", "M-2,2l4,-4M0,8l8,-8M6,10l4,-4", "M-2,6l4,4M0,0l8,8M6,-2l4,4", "M0,4h8", "M4,0v8", "M0,4h8M4,0v8"};
  return kPaths[kind % kPaths.size()];
}

void draw_box(Markup& svg, const std::string& id, std::size_t rank, const Box& box, const std::string& name,
              const std::string& amount) {
  const std::string x = coordinate(box.x), y = coordinate(box.y);
  const std::string w = coordinate(box.width), h = coordinate(box.height);
  svg.open("g", {{"class", "s" + std::to_string(rank % kSeriesColours)}}).element("title", name + ": " + amount);
  svg.empty("rect", {{"class", "box"}, {"x", x}, {"y", y}, {"width", w}, {"height", h}});
  if (rank % 6 != 0) {
    svg.empty("rect", {{"class", "hatch"},
                       {"fill", "url(#" + id + "-hatch" + std::to_string(rank % 6) + ")"},
                       {"x", x},
                       {"y", y},
                       {"width", w},
                       {"height", h}});
  }
  const double wide = std::max(text_width(name), text_width(amount)) + 10.0;
  if (box.width >= wide && box.height >= 36.0) {
    const double middle = box.x + box.width / 2.0, centre = box.y + box.height / 2.0;
    svg.empty("rect", {{"class", "plate"},
                       {"x", coordinate(middle - wide / 2.0)},
                       {"y", coordinate(centre - 17.0)},
                       {"width", coordinate(wide)},
                       {"height", "34"},
                       {"rx", "3"}});
    svg.element("text", name, {{"class", "across name"}, {"x", coordinate(middle)}, {"y", coordinate(centre - 3.0)}});
    svg.element("text", amount, {{"class", "across"}, {"x", coordinate(middle)}, {"y", coordinate(centre + 12.0)}});
  }
  svg.close().line();
}

}  // namespace

std::vector<Box> squarify(std::span<const double> sizes, const Box& room) {
  std::vector<Box> boxes(sizes.size(), Box{room.x, room.y, 0.0, 0.0});
  std::vector<std::size_t> left;
  double total = 0.0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (!(sizes[i] > 0.0) || !std::isfinite(sizes[i])) continue;
    left.push_back(i);
    total += sizes[i];
  }
  if (left.empty() || !std::isfinite(total) || !(room.area() > 0.0)) return boxes;
  std::vector<double> areas(sizes.size(), 0.0);
  for (const std::size_t i : left) areas[i] = sizes[i] / total * room.area();

  Box rest = room;
  std::size_t begin = 0;
  while (begin < left.size()) {
    const double side = std::min(rest.width, rest.height);
    double sum = 0.0, smallest = areas[left[begin]], largest = smallest, best = 0.0;
    std::size_t end = begin;
    for (; end < left.size(); ++end) {
      const double area = areas[left[end]];
      const double ratio = worst_ratio(sum + area, std::min(smallest, area), std::max(largest, area), side);
      if (end > begin && !(ratio <= best)) break;
      sum += area;
      smallest = std::min(smallest, area);
      largest = std::max(largest, area);
      best = ratio;
    }
    place_row(areas, std::span(left).subspan(begin, end - begin), rest, boxes);
    begin = end;
  }
  return boxes;
}

std::string draw_treemap(const Treemap& map, Standing standing) {
  std::vector<std::size_t> order(map.parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return map.parts[a].bytes > map.parts[b].bytes; });
  std::vector<double> sizes;
  for (const std::size_t i : order) sizes.push_back(static_cast<double>(map.parts[i].bytes));
  const std::vector<Box> boxes = squarify(sizes, {1.0, 1.0, kWidth - 2.0, kHeight - 2.0});
  Markup svg;
  open_svg(svg, map.id, map.title, map.description, kWidth, kHeight, standing);
  svg.open("defs");
  for (std::size_t kind = 1; kind < 6; ++kind) {
    svg.open("pattern", {{"id", map.id + "-hatch" + std::to_string(kind)},
                         {"width", "8"},
                         {"height", "8"},
                         {"patternUnits", "userSpaceOnUse"}});
    svg.empty("path", {{"class", "hatching"}, {"d", hatch_path(kind)}}).close();
  }
  svg.close().line();
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!(boxes[i].area() > 0.0)) continue;
    draw_box(svg, map.id, i, boxes[i], map.parts[order[i]].name, amount_text(sizes[i], "bytes"));
  }
  svg.close().line();
  return svg.str();
}

}  // namespace meshlode::lab::page
