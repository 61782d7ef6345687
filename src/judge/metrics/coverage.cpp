// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/coverage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/box.h"
#include "base/parallel.h"
#include "base/try.h"
#include "draw/textures/texture_image.h"
#include "run/decode/decode.h"
#include "run/unpack/unpack.h"

namespace meshlode::judge {

namespace {

constexpr std::size_t kDirections = 37, kCloserDirections = 149;
constexpr std::size_t kFewestSamples = 8;  // of a pixel, each way
constexpr double kMostSide = 8192.0;
// Pixels start so many times a pixel; more often where a mesh is few pixels across: how they lie there is luck, by
// which noise is a quarter more or less.
constexpr std::size_t kSteps = 2, kStepsOfFew = 4;
constexpr double kFewPixels = 8.0;
// Of needles that few samples see: as many samples as triangles may reach, in a picture of one direction.
constexpr double kMostFineSide = 131072.0, kMostReach = kMostSide * kMostSide;
// Samples of triangles that hide nothing of each other, in all directions together.
constexpr double kFewestCovered = 50000.0, kFewestMasked = 400000.0;
// Samples that are covered in fact, whatever hides what and whatever masks let through: a percent of luck.
constexpr double kFewestSeen = 10000.0;

struct Picture {
  Vec3d right, up;
};

Picture picture_of(std::size_t direction, std::size_t count) {
  const double z = 1.0 - (static_cast<double>(direction) + 0.5) / static_cast<double>(count);
  const double around = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(direction) + 1.7;
  const double out = std::sqrt(1.0 - z * z);
  const Vec3d view(out * std::cos(around), z, out * std::sin(around));
  const Vec3d helper = std::abs(view.y) < 0.9 ? Vec3d(0.0, 1.0, 0.0) : Vec3d(1.0, 0.0, 0.0);
  const Vec3d a = glm::normalize(glm::cross(helper, view)), b = glm::cross(view, a);
  const double turn = 1.1 + 0.83 * static_cast<double>(direction);
  return {std::cos(turn) * a + std::sin(turn) * b, std::cos(turn) * b - std::sin(turn) * a};
}

bool texel_passes(const draw::AlphaMasks& masks, const CoveringTriangle& triangle, const Vec2d& uv) {
  const draw::AlphaMask& mask = masks.masks[triangle.mask];
  std::uint32_t alpha = 255;
  if (mask.image != format::kNone) {
    const draw::AlphaImage& image = masks.images[mask.image];
    const auto texel = [&](const std::array<double, 3>& row, std::uint32_t count, draw::Wrap wrap) {
      return draw::texel_at(row[0] * uv.x + row[1] * uv.y + row[2], count, wrap);
    };
    const std::size_t x = texel(mask.row_u, image.width, mask.wrap[0]);
    const std::size_t y = texel(mask.row_v, image.height, mask.wrap[1]);
    alpha = image.texels[y * image.width + x];
  }
  return alpha * 255U >= mask.threshold;
}

using Places = std::array<Vec2d, 3>;

/// Samples of one picture, a byte each: 1 where something covers. They are in the middle of their cells, and of a row
/// there are those that some triangle may reach.
class Samples {
 public:
  /// Between two corners of the picture; pixels start at the lower one, so often a pixel, and two pixels of nothing are
  /// on each side.
  Samples(const Vec2d& low, const Vec2d& high, double spacing, std::size_t samples_a_pixel, std::size_t steps)
      : low_(low),
        spacing_(spacing),
        steps_(steps),
        step_(samples_a_pixel / steps),
        squares_wide_(squares(high.x - low.x)),
        squares_high_(squares(high.y - low.y)),
        rows_(step_ * (squares_high_ - 2 * before())) {}

  /// For all that will be drawn, before anything is.
  void make_room_for(std::span<const std::span<const CoveringTriangle>> sets, const Picture& picture) {
    for (const auto& triangles : sets) {
      for (const CoveringTriangle& triangle : triangles) {
        for_each_row(places(triangle, picture), [](Row& row, std::size_t, std::size_t first, std::size_t end) {
          row.first = std::min(row.first, first);
          row.end = std::max(row.end, end);
        });
      }
    }
    for (Row& row : rows_) {
      row.at = reach_;
      if (row.end > row.first) reach_ += row.end - row.first;
    }
  }
  [[nodiscard]] std::size_t reach() const { return reach_; }  ///< samples that there is room for

  /// The share of each pixel that the triangles cover, for pixels a step apart.
  [[nodiscard]] std::vector<double> draw(std::span<const CoveringTriangle> triangles, const Picture& picture,
                                         const draw::AlphaMasks& masks) {
    covered_.assign(reach_, 0);
    for (const CoveringTriangle& triangle : triangles) draw(triangle, places(triangle, picture), masks);
    return pixels();
  }

 private:
  [[nodiscard]] std::size_t before() const { return 2 * steps_; }  ///< squares of nothing

  struct Row {
    std::size_t first = std::numeric_limits<std::size_t>::max(), end = 0;  ///< columns
    std::size_t at = 0;                                                    ///< of `first` in covered_
  };

  static double cross(const Vec2d& a, const Vec2d& b) { return a.x * b.y - a.y * b.x; }
  [[nodiscard]] std::size_t squares(double extent) const {
    return static_cast<std::size_t>(std::ceil(extent / spacing_)) / step_ + 1 + 2 * before();
  }

  [[nodiscard]] Places places(const CoveringTriangle& triangle, const Picture& picture) const {
    Places p;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& corner = triangle.corners[k];
      p[k] = (Vec2d(glm::dot(corner, picture.right), glm::dot(corner, picture.up)) - low_) / spacing_;
    }
    return p;
  }

  /// Where the sides of a triangle cross a row: from the first to the last; nowhere, the wrong way round.
  [[nodiscard]] static std::pair<double, double> crossing(const Places& p, double y) {
    double from = std::numeric_limits<double>::max(), to = -from;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2d &a = p[k], &b = p[(k + 1) % 3];
      if (a.y == b.y || std::min(a.y, b.y) > y || std::max(a.y, b.y) < y) continue;
      const double x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
      from = std::min(from, x);
      to = std::max(to, x);
    }
    return {from, to};
  }

  /// body(row, y, first, end): of each row the columns that a triangle with area may cover.
  template <class Body>
  void for_each_row(const Places& p, const Body& body) {
    if (cross(p[1] - p[0], p[2] - p[0]) == 0.0) return;
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [bottom, top] = std::minmax({p[0].y, p[1].y, p[2].y});
    const auto first = [](double low) { return static_cast<std::size_t>(std::max(0.0, std::ceil(low - 0.5))); };
    const auto end = [](double high, std::size_t most) {
      return std::min(most, static_cast<std::size_t>(std::max(0.0, std::floor(high - 0.5) + 1.0)));
    };
    const std::size_t columns = step_ * (squares_wide_ - 2 * before());
    for (std::size_t y = first(bottom); y < end(top, rows_.size()); ++y) {
      // Of a sliver across the picture few samples of a row are near it: a sample more on both sides, for rounding.
      const auto [from, to] = crossing(p, static_cast<double>(y) + 0.5);
      if (from > to) continue;
      const std::size_t x = first(std::max(left, from - 1.0)), x_end = end(std::min(right, to + 1.0), columns);
      if (x < x_end) body(rows_[y], y, x, x_end);
    }
  }

  void draw(const CoveringTriangle& triangle, const Places& p, const draw::AlphaMasks& masks) {
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    for_each_row(p, [&](const Row& row, std::size_t y, std::size_t first, std::size_t end) {
      for (std::size_t x = first; x < end; ++x) {
        std::uint8_t& covered = covered_[row.at + (x - row.first)];
        if (covered != 0) continue;
        const Vec2d at(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        const double b = cross(at - p[0], p[2] - p[0]) / area, c = cross(p[1] - p[0], at - p[0]) / area;
        if (b < 0.0 || c < 0.0 || b + c > 1.0) continue;
        const Vec2d uv = (1.0 - b - c) * triangle.uv[0] + b * triangle.uv[1] + c * triangle.uv[2];
        if (triangle.mask == format::kNone || texel_passes(masks, triangle, uv)) covered = 1;
      }
    });
  }

  [[nodiscard]] std::vector<double> pixels() const {
    std::vector<std::uint32_t> squares(squares_wide_ * squares_high_, 0);
    for (std::size_t y = 0; y < rows_.size(); ++y) {
      const Row& row = rows_[y];
      std::uint32_t* const in_row = &squares[(before() + y / step_) * squares_wide_ + before()];
      for (std::size_t x = row.first; x < row.end; ++x) in_row[x / step_] += covered_[row.at + (x - row.first)];
    }
    // A pixel is steps_ × steps_ squares.
    const double all = static_cast<double>(steps_ * steps_) * static_cast<double>(step_ * step_);
    std::vector<double> out;
    out.reserve((squares_wide_ - steps_ + 1) * (squares_high_ - steps_ + 1));
    for (std::size_t y = 0; y + steps_ <= squares_high_; ++y) {
      for (std::size_t x = 0; x + steps_ <= squares_wide_; ++x) {
        std::uint32_t sum = 0;
        for (std::size_t k = 0; k < steps_; ++k) {
          const std::uint32_t* at = &squares[(y + k) * squares_wide_ + x];
          sum = std::accumulate(at, at + steps_, sum);
        }
        out.push_back(sum / all);
      }
    }
    return out;
  }

  Vec2d low_;
  double spacing_;
  std::size_t steps_;  ///< of a pixel
  std::size_t step_;   ///< samples along it
  std::size_t squares_wide_, squares_high_;
  std::vector<Row> rows_;
  std::size_t reach_ = 0;
  std::vector<std::uint8_t> covered_;
};

/// Sums over the pixels of one direction.
struct Sums {
  double source = 0.0, cut = 0.0, source_squares = 0.0, cut_squares = 0.0, change_squares = 0.0, pixels = 0.0;
  double reach = 0.0;  ///< samples
};

Sums look(std::span<const CoveringTriangle> source, std::span<const CoveringTriangle> cut,
          const draw::AlphaMasks& masks, double spacing, std::size_t samples_a_pixel, std::size_t steps,
          const Picture& picture) {
  Vec2d low(std::numeric_limits<double>::max()), high(-std::numeric_limits<double>::max());
  for (const auto set : {source, cut}) {
    for (const CoveringTriangle& triangle : set) {
      for (const Vec3d& corner : triangle.corners) {
        const Vec2d at(glm::dot(corner, picture.right), glm::dot(corner, picture.up));
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
    }
  }
  Samples samples(low, high, spacing, samples_a_pixel, steps);
  const std::array sets{source, cut};
  samples.make_room_for(sets, picture);
  const std::vector<double> f = samples.draw(source, picture, masks), c = samples.draw(cut, picture, masks);
  Sums sums;
  sums.reach = static_cast<double>(samples.reach());
  for (std::size_t i = 0; i < f.size(); ++i) {
    sums.source += f[i];
    sums.cut += c[i];
    sums.source_squares += f[i] * f[i];
    sums.cut_squares += c[i] * c[i];
    sums.change_squares += (c[i] - f[i]) * (c[i] - f[i]);
  }
  // The contrast is that of pixels that either covers: how much nothing there is around them is no matter.
  for (std::size_t i = 0; i < f.size(); ++i) sums.pixels += f[i] > 0.0 || c[i] > 0.0 ? 1.0 : 0.0;
  return sums;
}

}  // namespace

std::optional<CoverageDrift> measure_coverage(std::span<const CoveringTriangle> source,
                                              std::span<const CoveringTriangle> cut, const draw::AlphaMasks& masks,
                                              double pixel_size, double closer) {
  if (source.empty() || !(pixel_size > 0.0)) return std::nullopt;
  Box3d box;
  for (const auto set : {source, cut}) {
    for (const CoveringTriangle& triangle : set) {
      for (const Vec3d& corner : triangle.corners) box.add(corner);
    }
  }
  // Samples that are farther apart than triangles are wide would find them by luck, and a few of them what a mask lets
  // through.
  double area = 0.0;
  for (const CoveringTriangle& triangle : source) {
    const auto& [a, b, c] = triangle.corners;
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  const double width = std::sqrt(area / static_cast<double>(source.size()));
  const bool has_masks =
      std::any_of(source.begin(), source.end(), [](const CoveringTriangle& t) { return t.mask != format::kNone; });
  const std::size_t directions = closer > 1.0 ? kCloserDirections : kDirections;
  const double fewest = closer * (has_masks ? kFewestMasked : kFewestCovered);
  const double few = std::sqrt(0.5 * area * static_cast<double>(directions) / fewest);
  std::size_t samples_a_pixel = kFewestSamples;
  const auto side = [&] { return glm::length(box.size()) / pixel_size * static_cast<double>(samples_a_pixel); };
  while (pixel_size > std::min(0.5 * width, few) * static_cast<double>(samples_a_pixel) && 2.0 * side() <= kMostSide)
    samples_a_pixel *= 2;
  if (side() > kMostSide) return std::nullopt;
  const std::size_t steps = glm::length(box.size()) < kFewPixels * pixel_size ? kStepsOfFew : kSteps;
  std::vector<Sums> of_direction(directions);
  for (;; samples_a_pixel *= 2) {
    const double spacing = pixel_size / static_cast<double>(samples_a_pixel);
    parallel_for_each_index(directions, 1, [&](std::size_t d) {
      of_direction[d] = look(source, cut, masks, spacing, samples_a_pixel, steps, picture_of(d, directions));
    });
    double seen = 0.0, reach = 0.0;
    for (const Sums& sums : of_direction) {
      seen += sums.source / static_cast<double>(steps * steps);  // in each of the pixels that have it
      reach = std::max(reach, sums.reach);
    }
    seen *= static_cast<double>(samples_a_pixel * samples_a_pixel);
    if (seen >= closer * kFewestSeen || 2.0 * side() > kMostFineSide || 4.0 * reach > kMostReach) break;
  }
  Sums all;
  CoverageDrift drift;
  double source_variance = 0.0, cut_variance = 0.0;
  for (const Sums& sums : of_direction) {
    all.source += sums.source;
    all.cut += sums.cut;
    all.source_squares += sums.source_squares;
    all.change_squares += sums.change_squares;
    if (sums.source > 0.0) {
      drift.worst_direction = std::max(drift.worst_direction, std::abs(sums.cut / sums.source - 1.0));
      source_variance += sums.source_squares - sums.source * sums.source / sums.pixels;
      cut_variance += sums.cut_squares - sums.cut * sums.cut / sums.pixels;
    }
  }
  if (!(all.source > 0.0)) return std::nullopt;
  drift.rms = std::sqrt(all.change_squares / all.source_squares);
  drift.mean = all.cut / all.source - 1.0;
  drift.contrast = source_variance > 0.0 ? std::sqrt(std::max(0.0, cut_variance) / source_variance) : 1.0;
  return drift;
}

Result<std::vector<CoveringTriangle>> covering_triangles(const run::Asset& asset, const draw::AlphaMasks& masks,
                                                         MeshId mesh, std::span<const ClusterId> clusters) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  std::vector<CoveringTriangle> out;
  std::uint32_t loaded = format::kNone;
  std::optional<run::PageBytes> page;
  run::DecodedCluster decoded;
  run::ClusterAttributes attributes;
  for (const ClusterId cluster : clusters) {
    const std::uint32_t id = asset.groups()[asset.clusters()[cluster.value].coarser_group].page;
    if (id != loaded) {
      TRY_LET(next, run::load_page(asset, PageId{id}));
      page.emplace(std::move(*next));
      loaded = id;
    }
    run::decode_cluster(asset, *page, cluster, decoded);
    run::decode_attributes(record, decoded, attributes);
    const double step = std::ldexp(static_cast<double>(record.grid.mantissa), record.grid.log2);
    for (std::size_t t = 0; t < decoded.triangles.size(); ++t) {
      CoveringTriangle triangle;
      triangle.mask = masks.of_material.empty() ? format::kNone : masks.of_material[decoded.triangle_material[t]];
      std::uint32_t set = format::kMaxUvSets;
      for (std::uint32_t k = 0; triangle.mask != format::kNone && k < record.uv_set_count; ++k) {
        if (record.uv_set_source[k] == masks.masks[triangle.mask].uv_set) set = k;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint8_t v = decoded.triangles[t][k];
        triangle.corners[k] = Vec3d(decoded.position(v)) * step;
        if (set < format::kMaxUvSets) triangle.uv[k] = Vec2d(attributes.uvs[set][v]);
      }
      out.push_back(triangle);
    }
  }
  return out;
}

bool has_aggregates(const run::Asset& asset, MeshId mesh) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  const auto groups = asset.groups().subspan(record.first_group, record.group_count);
  return std::any_of(groups.begin(), groups.end(),
                     [](const format::GroupRecord& group) { return (group.flags & format::kGroupAggregate) != 0; });
}

std::vector<ClusterId> clusters_of_aggregates(const run::Asset& asset, std::span<const ClusterId> clusters) {
  const auto is_aggregate = [&](std::uint32_t group) {
    return group != format::kNone && (asset.groups()[group].flags & format::kGroupAggregate) != 0;
  };
  std::vector<ClusterId> out;
  for (const ClusterId id : clusters) {
    const format::ClusterRecord& cluster = asset.clusters()[id.value];
    if (is_aggregate(cluster.own_group) || is_aggregate(cluster.coarser_group)) out.push_back(id);
  }
  return out;
}

std::vector<double> coverage_sizes(const run::Asset& asset, MeshId mesh, std::uint32_t count) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  double low = std::numeric_limits<double>::max(), high = 0.0;
  for (std::uint32_t g = record.first_group; g < record.first_group + record.group_count; ++g) {
    const format::GroupRecord& group = asset.groups()[g];
    if ((group.flags & format::kGroupAggregate) == 0 || !(group.error > 0.0F)) continue;
    low = std::min(low, double{group.error});
    high = std::max(high, double{group.error});
  }
  std::vector<double> sizes;
  if (!(high > 0.0)) return sizes;
  high = std::max(low, std::min(1.1 * high, record.diagonal));
  for (std::uint32_t i = 0; i < count; ++i) {
    const double t = count < 2 ? 0.5 : static_cast<double>(i) / (count - 1);
    sizes.push_back(low * std::pow(high / low, t) * (1.0 + 1e-12));
  }
  return sizes;
}

}  // namespace meshlode::judge
