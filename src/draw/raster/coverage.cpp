// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/raster/coverage.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "base/parallel.h"
#include "draw/raster/alpha_cutoff.h"

namespace meshlode::draw {

namespace {

constexpr std::int32_t kBandRows = 16;  ///< rows of a band; a band belongs to one task

/// So many columns are looked at one by one in the time that the divisions of columns_within() take.
constexpr std::int32_t kFewColumns = 32;

__extension__ typedef unsigned __int128 Wide;

/// E(p) of the edge from a to b, positive on the inner side of a triangle of positive area, as a plane over the pixels.
struct Edge {
  std::int64_t at_origin = 0;           ///< at the centre of pixel (0, 0)
  std::int64_t step_x = 0, step_y = 0;  ///< to the next pixel
  std::int64_t bias = 0;                ///< -1 where a centre on the edge is outside (neither a top nor a left edge)

  Edge() = default;
  Edge(const ScreenVertex& a, const ScreenVertex& b) {
    const std::int64_t dx = std::int64_t{b.x} - a.x, dy = std::int64_t{b.y} - a.y;
    const std::int64_t half = kSubpixels / 2;
    at_origin = dx * (half - a.y) - dy * (half - a.x);
    step_x = -dy * kSubpixels;
    step_y = dx * kSubpixels;
    bias = dy < 0 || (dy == 0 && dx > 0) ? 0 : -1;
  }
  [[nodiscard]] std::int64_t at(std::int32_t x, std::int32_t y) const { return at_origin + step_x * x + step_y * y; }
};

/// Whether the triangle is there at all: asked last, because it costs most.
bool is_there(const ScreenSoup& soup, const VisibilityBuffer& buffer, std::size_t pixel, TriangleKey key) {
  if (key.mask == TriangleKey::kOpaque) return true;
  const std::size_t x = pixel % buffer.width, y = pixel / buffer.width;
  return passes_alpha(soup.masked[key.mask], static_cast<double>(x) + 0.5 - 0.5 * buffer.width,
                      static_cast<double>(y) + 0.5 - 0.5 * buffer.height);
}

void put_pixel(const ScreenSoup& soup, VisibilityBuffer& buffer, std::size_t pixel, std::uint32_t depth,
               TriangleKey key) {
  std::uint32_t& old_depth = buffer.depth[pixel];
  std::uint32_t& old_item = buffer.item[pixel];
  std::uint32_t& old_triangle = buffer.triangle[pixel];
  const bool is_nearer = depth != old_depth     ? depth > old_depth
                         : key.item != old_item ? key.item < old_item
                                                : key.triangle < old_triangle;
  if (!is_nearer || !is_there(soup, buffer, pixel, key)) return;
  old_depth = depth;
  old_item = key.item;
  old_triangle = key.triangle;
}

PixelRange rows_of_band(PixelRange rows, std::int32_t band) {
  return {std::max(rows.first, band * kBandRows), std::min(rows.last, band * kBandRows + kBandRows - 1)};
}

/// Of `columns` of a row those within all three edges, of which `e` are the values at the first column. Most of what is
/// around a long thin triangle lies beside it.
PixelRange columns_within(const Edge (&edges)[3], const std::int64_t (&e)[3], PixelRange columns) {
  std::int64_t first = 0, last = columns.last - columns.first;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t value = e[k] + edges[k].bias, step = edges[k].step_x;
    if (step < 0) {
      last = std::min(last, value < 0 ? -1 : value / -step);
    } else if (value < 0) {
      first = step == 0 ? last + 1 : std::max(first, (-value + step - 1) / step);
    }
  }
  return {columns.first + static_cast<std::int32_t>(std::min(first, last + 1)),
          columns.first + static_cast<std::int32_t>(last)};
}

void draw_triangle(const ScreenSoup& soup, const ScreenTriangle& t, std::int32_t band, VisibilityBuffer& buffer) {
  const auto [low_x, high_x] = std::minmax({t.v[0].x, t.v[1].x, t.v[2].x});
  const auto [low_y, high_y] = std::minmax({t.v[0].y, t.v[1].y, t.v[2].y});
  const PixelRange columns = pixels_between(low_x, high_x, buffer.width);
  const PixelRange rows = rows_of_band(pixels_between(low_y, high_y, buffer.height), band);
  // Edge k is opposite to vertex k, so its function is the weight of that vertex.
  const Edge edges[3] = {{t.v[1], t.v[2]}, {t.v[2], t.v[0]}, {t.v[0], t.v[1]}};
  const std::int64_t area = doubled_area(t.v[0], t.v[1], t.v[2]);
  for (std::int32_t y = rows.first; y <= rows.last; ++y) {
    std::int64_t e[3] = {edges[0].at(columns.first, y), edges[1].at(columns.first, y), edges[2].at(columns.first, y)};
    const std::size_t row = static_cast<std::size_t>(y) * buffer.width;
    PixelRange within = columns;
    if (columns.last - columns.first > kFewColumns) {
      within = columns_within(edges, e, columns);
      for (int k = 0; k < 3; ++k) e[k] += edges[k].step_x * (within.first - columns.first);
    }
    for (std::int32_t x = within.first; x <= within.last; ++x) {
      // The sign bit of the union is set iff one of them is negative.
      if (((e[0] + edges[0].bias) | (e[1] + edges[1].bias) | (e[2] + edges[2].bias)) >= 0) {
        put_pixel(soup, buffer, row + static_cast<std::size_t>(x), interpolate_depth(t, e, area), t.key);
      }
      for (int k = 0; k < 3; ++k) e[k] += edges[k].step_x;
    }
  }
}

/// A clipped polygon: triangles (0, i, i + 1) with the sign of their areas. A pixel is covered iff the signed sum is
/// positive; its depth is that of the first positive triangle that covers it.
void draw_polygon(const ScreenSoup& soup, const ScreenPolygon& polygon, std::int32_t band, VisibilityBuffer& buffer) {
  struct Part {
    ScreenTriangle triangle;
    Edge edges[3];
    std::int64_t area = 0;
    int sign = 0;
  };
  std::array<Part, ScreenPolygon::kMaxVertices - 2> parts;
  std::size_t part_count = 0;
  std::int32_t low_x = polygon.v[0].x, high_x = low_x, low_y = polygon.v[0].y, high_y = low_y;
  for (std::uint32_t i = 1; i < polygon.count; ++i) {
    low_x = std::min(low_x, polygon.v[i].x);
    high_x = std::max(high_x, polygon.v[i].x);
    low_y = std::min(low_y, polygon.v[i].y);
    high_y = std::max(high_y, polygon.v[i].y);
    if (i + 1 == polygon.count) continue;
    Part part;
    part.triangle = {{polygon.v[0], polygon.v[i], polygon.v[i + 1]}, polygon.key};
    part.area = doubled_area(part.triangle.v[0], part.triangle.v[1], part.triangle.v[2]);
    if (part.area == 0) continue;
    part.sign = part.area > 0 ? 1 : -1;
    if (part.area < 0) {
      std::swap(part.triangle.v[1], part.triangle.v[2]);
      part.area = -part.area;
    }
    const auto& v = part.triangle.v;
    part.edges[0] = {v[1], v[2]};
    part.edges[1] = {v[2], v[0]};
    part.edges[2] = {v[0], v[1]};
    parts[part_count++] = part;
  }
  const PixelRange columns = pixels_between(low_x, high_x, buffer.width);
  const PixelRange rows = rows_of_band(pixels_between(low_y, high_y, buffer.height), band);
  for (std::int32_t y = rows.first; y <= rows.last; ++y) {
    for (std::int32_t x = columns.first; x <= columns.last; ++x) {
      int winding = 0;
      bool has_depth = false;
      std::uint32_t depth = 0;
      for (std::size_t p = 0; p < part_count; ++p) {
        const Part& part = parts[p];
        const std::int64_t e[3] = {part.edges[0].at(x, y), part.edges[1].at(x, y), part.edges[2].at(x, y)};
        const bool is_inside =
            ((e[0] + part.edges[0].bias) | (e[1] + part.edges[1].bias) | (e[2] + part.edges[2].bias)) >= 0;
        if (!is_inside) continue;
        winding += part.sign;
        if (part.sign > 0 && !has_depth) {
          depth = interpolate_depth(part.triangle, e, part.area);
          has_depth = true;
        }
      }
      const std::size_t pixel = static_cast<std::size_t>(y) * buffer.width + static_cast<std::size_t>(x);
      if (winding > 0) put_pixel(soup, buffer, pixel, depth, polygon.key);
    }
  }
}

/// Which entries touch which band: entries[first[b] … first[b + 1]) belong to band b.
struct Bands {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> entries;
};

template <class Entries, class Rows>
Bands sort_into_bands(const Entries& entries, std::size_t band_count, const Rows& rows_of) {
  Bands bands;
  bands.first.assign(band_count + 1, 0);
  const auto for_each_band = [&](const auto& entry, const auto& body) {
    const PixelRange rows = rows_of(entry);
    if (rows.is_empty()) return;
    for (std::int32_t band = rows.first / kBandRows; band <= rows.last / kBandRows; ++band) {
      body(static_cast<std::size_t>(band));
    }
  };
  for (const auto& entry : entries) for_each_band(entry, [&](std::size_t band) { ++bands.first[band + 1]; });
  for (std::size_t band = 0; band < band_count; ++band) bands.first[band + 1] += bands.first[band];
  bands.entries.resize(bands.first.back());
  std::vector<std::uint32_t> next(bands.first.begin(), bands.first.end() - 1);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    for_each_band(entries[i], [&](std::size_t band) { bands.entries[next[band]++] = static_cast<std::uint32_t>(i); });
  }
  return bands;
}

}  // namespace

std::uint32_t interpolate_depth(const ScreenTriangle& triangle, const std::int64_t (&weights)[3], std::int64_t area) {
  std::uint64_t w[3];
  for (int k = 0; k < 3; ++k) w[k] = static_cast<std::uint64_t>(weights[k]);
  const auto whole = static_cast<std::uint64_t>(area);
  if (whole < (std::uint64_t{1} << 32)) {  // the sum is below area · 2^32
    const std::uint64_t sum = w[0] * triangle.v[0].depth + w[1] * triangle.v[1].depth + w[2] * triangle.v[2].depth;
    return static_cast<std::uint32_t>(sum / whole);
  }
  const Wide sum =
      Wide{w[0]} * triangle.v[0].depth + Wide{w[1]} * triangle.v[1].depth + Wide{w[2]} * triangle.v[2].depth;
  return static_cast<std::uint32_t>(sum / whole);
}

void draw_soup(const ScreenSoup& soup, VisibilityBuffer& buffer) {
  const std::size_t band_count = (std::size_t{buffer.height} + kBandRows - 1) / kBandRows;
  const Bands triangles = sort_into_bands(soup.triangles, band_count, [&](const ScreenTriangle& t) {
    return pixels_between(std::min({t.v[0].y, t.v[1].y, t.v[2].y}), std::max({t.v[0].y, t.v[1].y, t.v[2].y}),
                          buffer.height);
  });
  const Bands polygons = sort_into_bands(soup.polygons, band_count, [&](const ScreenPolygon& p) {
    std::int32_t low = p.v[0].y, high = p.v[0].y;
    for (std::uint32_t i = 1; i < p.count; ++i) {
      low = std::min(low, p.v[i].y);
      high = std::max(high, p.v[i].y);
    }
    return pixels_between(low, high, buffer.height);
  });
  parallel_for_each_index(band_count, 1, [&](std::size_t band) {
    const auto rows = static_cast<std::int32_t>(band);
    for (std::uint32_t i = triangles.first[band]; i < triangles.first[band + 1]; ++i) {
      draw_triangle(soup, soup.triangles[triangles.entries[i]], rows, buffer);
    }
    for (std::uint32_t i = polygons.first[band]; i < polygons.first[band + 1]; ++i) {
      draw_polygon(soup, soup.polygons[polygons.entries[i]], rows, buffer);
    }
  });
}

}  // namespace meshlode::draw
