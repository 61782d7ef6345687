// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/pictures.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "builder/aggregate/block_counts.h"

namespace meshlode::builder {

namespace {

Squares squares_of(BlockCounts counts, std::size_t octaves) {
  Squares squares(2 * octaves);
  for (std::size_t octave = octaves; octave-- > 0;) {
    for (std::size_t s = 0; s < 2; ++s) squares[2 * octave + s] = counts.sum_of_squares(kPixelBlocks[s]);
    if (octave > 0) counts.halve();
  }
  return squares;
}

using Places = std::array<Vec2d, 3>;

/// A box around many triangles, as far as they are in a picture of `side` samples.
class PlaceBounds {
 public:
  explicit PlaceBounds(int side) : side_(side) {}
  void include(const Places& at) {
    const auto [a, b, c] = at;
    const Vec2d low(std::min(std::min(a.x, b.x), c.x), std::min(std::min(a.y, b.y), c.y));
    const Vec2d high(std::max(std::max(a.x, b.x), c.x), std::max(std::max(a.y, b.y), c.y));
    if (high.x < 0.0 || high.y < 0.0 || low.x >= side_ || low.y >= side_) return;
    low_ = {std::min(low_.x, low.x), std::min(low_.y, low.y)};
    high_ = {std::max(high_.x, high.x), std::max(high_.y, high.y)};
  }
  /// Empty if nothing was included.
  [[nodiscard]] MaskBox box() const {
    MaskBox all;
    if (low_.x <= high_.x) all.include(std::array<Vec2d, 2>{low_, high_}, side_);
    return all;
  }

 private:
  int side_;
  Vec2d low_{std::numeric_limits<double>::max()}, high_{-std::numeric_limits<double>::max()};
};

}  // namespace

double pixel_size(double spacing, std::size_t octaves, std::size_t index) {
  double size = 2.0 * static_cast<double>(kPixelBlocks[index % 2]) * spacing;
  for (std::size_t octave = index / 2 + 1; octave < octaves; ++octave) size *= 2.0;
  return size;
}

SampleMask source_mask(const SourceSurface& source, const Lattice& lattice, const View& view,
                       std::span<const std::uint32_t> triangles) {
  std::vector<Places> places;
  places.reserve(triangles.size());
  PlaceBounds bounds(lattice.side());
  std::vector<std::uint32_t> seen;
  seen.reserve(triangles.size());
  for (const std::uint32_t t : triangles) {
    const Places at = lattice.places(view, source.corners(t));
    // What a closed piece's back covers its front does.
    if (source.is_closed(t) && (at[1].x - at[0].x) * (at[2].y - at[0].y) < (at[1].y - at[0].y) * (at[2].x - at[0].x))
      continue;
    seen.push_back(t);
    places.push_back(at);
    bounds.include(at);
  }
  SampleMask mask(bounds.box());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto& covers = source.material(seen[i]).covers;
    if (!covers) {
      mask.add_triangle(places[i]);
      continue;
    }
    mask.add_triangle(places[i], source.uvs(seen[i]), covers);
  }
  return mask;
}

SampleMask mask_of(const Lattice& lattice, const View& view, std::span<const Corners> triangles) {
  std::vector<Places> places;
  places.reserve(triangles.size());
  PlaceBounds bounds(lattice.side());
  for (const Corners& corners : triangles) {
    places.push_back(lattice.places(view, corners));
    bounds.include(places.back());
  }
  SampleMask mask(bounds.box());
  for (const Places& corners : places) mask.add_triangle(corners);
  return mask;
}

CoverCount cover_of(std::span<const SampleMask> groups) {
  MaskBox box;
  for (const SampleMask& group : groups) box.include(group.box());
  CoverCount cover{SampleMask(box), SampleMask(box)};
  for (const SampleMask& group : groups) {
    const MaskBox& own = group.box();
    if (own.is_empty()) continue;
    for (int y = own.first_row; y < own.end_row; ++y) {
      const std::uint64_t* from = group.row(y);
      std::uint64_t* once = cover.once.row(y) + (own.first_word - box.first_word);
      std::uint64_t* twice = cover.twice.row(y) + (own.first_word - box.first_word);
      for (int x = 0; x < own.words(); ++x) {
        twice[x] |= once[x] & from[x];
        once[x] |= from[x];
      }
    }
  }
  return cover;
}

Change change_of(const SampleMask& before, const SampleMask& after, const CoverCount& cover, std::size_t octaves,
                 unsigned halvings) {
  MaskBox box = before.box();
  box.include(after.box());
  if (box.is_empty()) return {Squares(2 * octaves, 0), 0, 0};
  BlockCounts counts(box, halvings);
  Change change;
  for (int y = box.first_row; y < box.end_row; y += 2) {
    for (int x = box.first_word; x < box.end_word; ++x) {
      std::array<std::uint64_t, 2> gone{}, come{};
      for (int k = 0; k < 2; ++k) {
        const std::uint64_t old = before.word(x, y + k), now = after.word(x, y + k);
        // Covered by others: twice where the group itself covers it, once where it does not.
        const std::uint64_t others = (old & cover.twice.word(x, y + k)) | (~old & cover.once.word(x, y + k));
        gone[static_cast<std::size_t>(k)] = old & ~now & ~others;
        come[static_cast<std::size_t>(k)] = now & ~old & ~others;
        change.before += std::popcount(old & ~others);
        change.after += std::popcount(now & ~others);
      }
      const auto word = static_cast<std::size_t>(x - box.first_word);
      const auto row = static_cast<std::size_t>(y - box.first_row) / 2;
      counts.add_word(word, row, gone[0], gone[1], -1);
      counts.add_word(word, row, come[0], come[1], 1);
    }
  }
  change.squares = squares_of(std::move(counts), octaves);
  return change;
}

Squares squares_of_all(const SampleMask& all, std::size_t octaves, unsigned halvings) {
  if (all.box().is_empty()) return Squares(2 * octaves, 0);
  BlockCounts counts(all.box(), halvings);
  for (int y = all.box().first_row; y < all.box().end_row; y += 2) {
    for (int x = 0; x < all.box().words(); ++x) {
      counts.add_word(static_cast<std::size_t>(x), static_cast<std::size_t>(y - all.box().first_row) / 2, all.row(y)[x],
                      all.row(y + 1)[x], 1);
    }
  }
  return squares_of(std::move(counts), octaves);
}

LeafMasks draw_leaves(const SourceSurface& source, const ByPiece& leaf_triangles, const Lattice& finest,
                      const View& view, std::size_t first_step, std::size_t steps) {
  LeafMasks masks(steps, std::vector<SampleMask>(leaf_triangles.size()));
  parallel_for_each_index(leaf_triangles.size(), 1, [&](std::size_t leaf) {
    masks[steps - 1][leaf] = source_mask(source, finest, view, leaf_triangles.of(leaf));
    for (std::size_t step = steps - 1; step-- > first_step;) masks[step][leaf] = masks[step + 1][leaf].even_samples();
  });
  return masks;
}

}  // namespace meshlode::builder
