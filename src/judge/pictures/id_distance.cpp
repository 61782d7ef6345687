// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/pictures/id_distance.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "base/parallel.h"

namespace meshlode::judge {

namespace {

/// A pixel is one sample of what it shows: in both pictures an edge may lie up to half a pixel's diagonal from the
/// middles of the pixels beside it. Twice that is 1.42; the rest is for where vertices are rounded.
constexpr double kSamplingPx = 1.5;
constexpr double kDepthSteps = 4294967296.0;

/// The pixels of each surface as runs in rows, so that the nearest is found row by row, exactly.
class RunsOfIds {
 public:
  explicit RunsOfIds(const IdPicture& picture) : width_(picture.width), height_(picture.height), rows_(picture.height) {
    parallel_for_each_index(rows_.size(), 16, [&](std::size_t y) {
      add_row(&picture.id[y * width_], rows_[y]);
      if (!picture.also.empty()) add_row(&picture.also[y * width_], rows_[y]);
      std::sort(rows_[y].begin(), rows_[y].end(), comes_before);
    });
    for (std::uint32_t y = 0; y < picture.height; ++y) {
      for (std::size_t i = 0; i < rows_[y].size(); ++i) {
        if (i == 0 || rows_[y][i].id != rows_[y][i - 1].id) rows_of_.emplace_back(rows_[y][i].id, y);
      }
    }
    std::sort(rows_of_.begin(), rows_of_.end());
  }

  /// From the middle of one pixel to the middle of another, pixels; infinite where there is none, or none within
  /// `limit`.
  [[nodiscard]] double distance(std::uint64_t id, std::uint32_t x, std::uint32_t y,
                                double limit = std::numeric_limits<double>::infinity()) const {
    double best2 = std::numeric_limits<double>::infinity();
    const auto first = std::lower_bound(rows_of_.begin(), rows_of_.end(), RowOf(id, 0));
    const auto last = std::upper_bound(first, rows_of_.end(), RowOf(id, height_));
    if (first == last) return best2;
    const std::uint32_t top = first->second, bottom = std::prev(last)->second;
    const auto look = [&](std::uint32_t row) {
      const double dx = distance_in_row(rows_[row], id, x), dy = double{y * 1.0} - row;
      best2 = std::min(best2, dx * dx + dy * dy);
    };
    // Outwards from the row, beginning with the nearest that may have it.
    for (std::uint32_t dy = y < top ? top - y : y > bottom ? y - bottom : 0; dy < height_; ++dy) {
      if (double{dy * 1.0} * dy >= best2 || dy > limit) break;
      if (y + dy >= top && y + dy <= bottom) look(y + dy);
      if (y >= top + dy && y <= bottom + dy) look(y - dy);
    }
    const double best = std::sqrt(best2);
    return best <= limit ? best : std::numeric_limits<double>::infinity();
  }

 private:
  struct Run {
    std::uint64_t id;
    std::uint32_t first, last;
  };
  void add_row(const std::uint64_t* id, std::vector<Run>& row) const {
    for (std::uint32_t x = 0; x < width_; ++x) {
      if (id[x] == IdPicture::kBackground) continue;
      if (x > 0 && id[x] == id[x - 1])
        row.back().last = x;
      else
        row.push_back({id[x], x, x});
    }
  }
  static bool comes_before(const Run& a, const Run& b) { return a.id != b.id ? a.id < b.id : a.first < b.first; }

  static double distance_in_row(const std::vector<Run>& row, std::uint64_t id, std::uint32_t x) {
    // The first run of the id that begins right of x, and the one before it.
    const auto right = std::upper_bound(row.begin(), row.end(), Run{id, x, x}, comes_before);
    double best = std::numeric_limits<double>::infinity();
    if (right != row.end() && right->id == id) best = right->first - x;
    if (right != row.begin() && std::prev(right)->id == id) {
      const std::uint32_t last = std::prev(right)->last;
      best = std::min(best, x > last ? double{x - last * 1.0} : 0.0);
    }
    return best;
  }

  using RowOf = std::pair<std::uint64_t, std::uint32_t>;

  std::uint32_t width_, height_;
  std::vector<std::vector<Run>> rows_;
  std::vector<RowOf> rows_of_;  ///< of each surface the rows that show it, ascending
};

/// From a pixel's surface in `from` to the same in another picture; 0 where it is within `allowed`.
double distance_beyond(const IdPicture& from, const RunsOfIds& to, std::uint32_t x, std::uint32_t y, double allowed) {
  const std::uint64_t id = from.id[std::size_t{y} * from.width + x];
  if (id == IdPicture::kBackground) return 0.0;
  const double distance = to.distance(id, x, y);
  return distance > allowed ? distance : 0.0;
}

/// Whether a pixel's surface is at most two pixels wide there, across or down.
bool is_narrow(const IdPicture& picture, std::size_t pixel) {
  const std::uint64_t id = picture.id[pixel];
  const auto is_short = [&](std::size_t at, std::size_t length, std::size_t stride) {
    std::size_t run = 1;
    for (std::size_t k = 1; k <= at && run < 3 && picture.id[pixel - k * stride] == id; ++k) ++run;
    for (std::size_t k = 1; at + k < length && run < 3 && picture.id[pixel + k * stride] == id; ++k) ++run;
    return run < 3;
  };
  return is_short(pixel % picture.width, picture.width, 1) ||
         is_short(pixel / picture.width, picture.height, picture.width);
}

}  // namespace

double AllowedPixels::at(const IdPicture& picture, std::size_t pixel) const {
  if (picture.id[pixel] == IdPicture::kBackground) return 0.0;
  const draw::Projection& p = projection_;
  // Near over distance; orthographic: 1 at the near distance, 0 at the far one.
  const double share = picture.depth[pixel] / kDepthSteps;
  const double px_per_unit = p.is_orthographic ? p.pixels_per_unit : p.pixels_per_unit * share / p.near_distance;
  double moved = std::max(pixel_error_, static_cast<double>(picture.level0[pixel]) * px_per_unit);
  const double to_near =
      (1.0 - share) * p.pixels_per_unit * (p.is_orthographic ? p.far_distance - p.near_distance : 1.0);
  if (!(moved < to_near)) return HUGE_VAL;
  if (!p.is_orthographic) {
    // Displacement in pixels is an angle times pixels_per_unit; outwards from the middle the picture stretches angles.
    const double x = static_cast<double>(pixel % picture.width) + 0.5 - 0.5 * picture.width;
    const double y = static_cast<double>(pixel / picture.width) + 0.5 - 0.5 * picture.height;
    moved *= 1.0 + (x * x + y * y) / (p.pixels_per_unit * p.pixels_per_unit);
  }
  return moved + kSamplingPx;
}

std::vector<AstrayPixel> find_astray(const IdPicture& source, const IdPicture& cut,
                                     const AllowedPixels& allowed_pixels) {
  const RunsOfIds source_runs(source), cut_runs(cut);
  std::vector<std::vector<AstrayPixel>> rows(source.height);
  parallel_for_each_index(rows.size(), 4, [&](std::size_t row) {
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < source.width; ++x) {
      const std::size_t at = row * source.width + x;
      if (source.id[at] == cut.id[at]) continue;
      const double allowed = std::max(allowed_pixels.at(source, at), allowed_pixels.at(cut, at));
      // To the nearest pixel that is not in the picture.
      const std::uint32_t to_edge = std::min({x + 1, source.width - x, y + 1, source.height - y});
      if (to_edge <= allowed) continue;
      const double of_source = distance_beyond(source, cut_runs, x, y, allowed);
      const double of_cut = distance_beyond(cut, source_runs, x, y, allowed);
      if (of_source > 0.0 || of_cut > 0.0) {
        rows[row].push_back(
            {static_cast<std::uint32_t>(at), std::max(of_source, of_cut), of_source > 0.0, of_cut > 0.0});
      }
    }
  });
  std::vector<AstrayPixel> out;
  for (const std::vector<AstrayPixel>& row : rows) out.insert(out.end(), row.begin(), row.end());
  return out;
}

void dismiss_narrow(const IdPicture& source, const IdPicture& cut, const IdPicture& finer_source,
                    const IdPicture& finer_cut, std::uint32_t finer, const AllowedPixels& allowed_pixels,
                    std::vector<AstrayPixel>& astray) {
  const RunsOfIds source_runs(finer_source), cut_runs(finer_cut);
  const auto is_there = [&](const IdPicture& picture, const RunsOfIds& other, const AstrayPixel& pixel) {
    if (!is_narrow(picture, pixel.pixel)) return false;
    const double allowed = std::max(allowed_pixels.at(source, pixel.pixel), allowed_pixels.at(cut, pixel.pixel));
    // One of the finer pixels at the middle of this one.
    const std::uint32_t x = pixel.pixel % picture.width * finer + finer / 2;
    const std::uint32_t y = pixel.pixel / picture.width * finer + finer / 2;
    return std::isfinite(other.distance(picture.id[pixel.pixel], x, y, allowed * finer));
  };
  std::vector<std::uint8_t> is_dismissed(astray.size());
  parallel_for_each_index(astray.size(), 64, [&](std::size_t i) {
    const AstrayPixel& pixel = astray[i];
    is_dismissed[i] = (!pixel.is_of_source || is_there(source, cut_runs, pixel)) &&
                              (!pixel.is_of_cut || is_there(cut, source_runs, pixel))
                          ? 1
                          : 0;
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < astray.size(); ++i) {
    if (is_dismissed[i] == 0) astray[kept++] = astray[i];
  }
  astray.resize(kept);
}

IdDistance sum_up(const IdPicture& source, const IdPicture& cut, std::span<const AstrayPixel> astray) {
  IdDistance out;
  for (std::size_t i = 0; i < source.id.size(); ++i) {
    out.pixels += source.id[i] != IdPicture::kBackground || cut.id[i] != IdPicture::kBackground ? 1 : 0;
  }
  out.astray = astray.size();
  for (const AstrayPixel& pixel : astray) out.farthest_px = std::max(out.farthest_px, pixel.distance_px);
  return out;
}

}  // namespace meshlode::judge
