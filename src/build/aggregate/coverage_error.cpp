// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/coverage_error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "build/aggregate/block_counts.h"
#include "build/aggregate/sample_mask.h"
#include "build/aggregate/views.h"

namespace meshlode::build {

namespace {

// Pixels are 12 and 8 samples wide, in blocks of 2 × 2, and twice, four times … as wide in blocks that are. From one
// size to the next they fall by a third or a quarter, and a pixel has at least 64 samples.
constexpr std::array<std::size_t, 2> kPixelBlocks{6, 4};

/// From large to small pixels: `octaves` times two sizes.
using Squares = std::vector<std::int64_t>;

Squares squares_of(BlockCounts counts, std::size_t octaves) {
  Squares squares(2 * octaves);
  for (std::size_t octave = octaves; octave-- > 0;) {
    for (std::size_t s = 0; s < 2; ++s) squares[2 * octave + s] = counts.sum_of_squares(kPixelBlocks[s]);
    if (octave > 0) counts.halve();
  }
  return squares;
}

/// Of squares_of() at a spacing.
double pixel_size(double spacing, std::size_t octaves, std::size_t index) {
  double size = 2.0 * static_cast<double>(kPixelBlocks[index % 2]) * spacing;
  for (std::size_t octave = index / 2 + 1; octave < octaves; ++octave) size *= 2.0;
  return size;
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

/// Which samples at least one group of a level covers, and which at least two.
struct Cover {
  SampleMask once, twice;
};

Cover cover_of(std::span<const SampleMask> groups) {
  MaskBox box;
  for (const SampleMask& group : groups) box.include(group.box());
  Cover cover{SampleMask(box), SampleMask(box)};
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

/// What one proposal changes.
struct Change {
  Squares squares;                     ///< for each pixel size
  std::int64_t before = 0, after = 0;  ///< samples that nothing else covers
};

/// `before`: the group's own samples.
Change change_of(const SampleMask& before, const SampleMask& after, const Cover& cover, std::size_t octaves) {
  MaskBox box = before.box();
  box.include(after.box());
  if (box.is_empty()) return {Squares(2 * octaves, 0), 0, 0};
  BlockCounts counts(box);
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

Squares squares_of_all(const SampleMask& all, std::size_t octaves) {
  if (all.box().is_empty()) return Squares(2 * octaves, 0);
  BlockCounts counts(all.box());
  for (int y = all.box().first_row; y < all.box().end_row; y += 2) {
    for (int x = 0; x < all.box().words(); ++x) {
      counts.add_word(static_cast<std::size_t>(x), static_cast<std::size_t>(y - all.box().first_row) / 2, all.row(y)[x],
                      all.row(y + 1)[x], 1);
    }
  }
  return squares_of(std::move(counts), octaves);
}

/// A proposal on its way from coarse pixels to fine ones.
struct Trial {
  std::size_t level = 0, group = 0, proposal = 0;
  std::size_t first_step = 0;  ///< the first spacing that is fine enough for its pieces
  bool is_open = true;

  /// How many octaves of pixel sizes are looked at in a step: all so far in the first one. 0: none.
  [[nodiscard]] std::size_t octaves_at(std::size_t step) const {
    if (!is_open || step < first_step) return 0;
    return step == first_step ? step + 1 : 1;
  }
};

/// One spacing, one view: what every open trial changes.
struct ViewResult {
  Squares whole;
  std::int64_t covered = 0;    ///< samples of the whole mesh
  std::vector<Change> change;  ///< by trial
};

/// Masks of a level's groups from those of leaves.
std::vector<SampleMask> group_masks(std::span<const SampleMask> leaves, std::span<const GroupProposals> groups) {
  std::vector<SampleMask> masks;
  masks.reserve(groups.size());
  for (const GroupProposals& group : groups) {
    MaskBox box;
    for (std::uint32_t leaf = group.first_leaf; leaf < group.end_leaf; ++leaf) box.include(leaves[leaf].box());
    SampleMask mask(box);
    for (std::uint32_t leaf = group.first_leaf; leaf < group.end_leaf; ++leaf) mask.add(leaves[leaf]);
    masks.push_back(std::move(mask));
  }
  return masks;
}

/// Of twice as many leaves each. \pre an even number of masks
std::vector<SampleMask> joined_in_pairs(std::span<const SampleMask> masks) {
  std::vector<SampleMask> joined(masks.size() / 2);
  parallel_for_each_index(joined.size(), 1, [&](std::size_t i) {
    MaskBox box = masks[2 * i].box();
    box.include(masks[2 * i + 1].box());
    joined[i] = SampleMask(box);
    joined[i].add(masks[2 * i]);
    joined[i].add(masks[2 * i + 1]);
  });
  return joined;
}

/// What the leaves cover in one view, at one spacing after the other.
using LeafMasks = std::vector<std::vector<SampleMask>>;

/// For the spacings of `first_step` to that of `finest`, which is the last one: the source is drawn once, and what it
/// covers of the coarser lattices are samples of the finest.
LeafMasks draw_leaves(const SourceSurface& source, const ByPiece& leaf_triangles, const Lattice& finest,
                      const View& view, std::size_t first_step, std::size_t steps) {
  LeafMasks masks(steps, std::vector<SampleMask>(leaf_triangles.size()));
  parallel_for_each_index(leaf_triangles.size(), 1, [&](std::size_t leaf) {
    masks[steps - 1][leaf] = source_mask(source, finest, view, leaf_triangles.of(leaf));
    for (std::size_t step = steps - 1; step-- > first_step;) masks[step][leaf] = masks[step + 1][leaf].even_samples();
  });
  return masks;
}

ViewResult look(std::span<const SampleMask> leaves, const Lattice& lattice, const View& view,
                std::span<const std::vector<GroupProposals>> levels, std::span<const Trial> trials, std::size_t step) {
  ViewResult result;
  result.change.resize(trials.size());
  const SampleMask whole = cover_of(leaves).once;
  result.whole = squares_of_all(whole, step + 1);
  result.covered = static_cast<std::int64_t>(whole.count());
  for (std::size_t level = 0, first = 0; level < levels.size(); ++level) {
    std::size_t end = first;
    bool is_any_open = false;
    for (; end < trials.size() && trials[end].level == level; ++end) {
      is_any_open = is_any_open || trials[end].octaves_at(step) > 0;
    }
    if (is_any_open) {
      const std::vector<SampleMask> masks = group_masks(leaves, levels[level]);
      const Cover cover = cover_of(masks);
      parallel_for_each_index(end - first, 1, [&](std::size_t i) {
        const Trial& trial = trials[first + i];
        const std::size_t octaves = trial.octaves_at(step);
        if (octaves == 0) return;
        const std::vector<Corners>& triangles = levels[level][trial.group].proposals[trial.proposal].triangles;
        result.change[first + i] = change_of(masks[trial.group], mask_of(lattice, view, triangles), cover, octaves);
      });
    }
    first = end;
  }
  return result;
}

/// Of a group's ways one is taken in the end. Which one shows from large pixels on: those that have clearly more noise
/// there are looked at no further.
void close_worse_ways(std::span<const std::vector<GroupProposals>> levels, std::span<Trial> trials) {
  constexpr double kClearlyMore = 1.2, kHardlyAny = 0.02;
  const auto noise_of = [&](const Trial& trial) {
    const auto& points = levels[trial.level][trial.group].proposals[trial.proposal].noise.points;
    return points.empty() ? 0.0 : points.back().noise;
  };
  for (std::size_t first = 0, end = 0; first < trials.size(); first = end) {
    double least = std::numeric_limits<double>::infinity();
    for (; end < trials.size() && trials[end].level == trials[first].level && trials[end].group == trials[first].group;
         ++end) {
      if (trials[end].is_open) least = std::min(least, noise_of(trials[end]));
    }
    for (std::size_t i = first; i < end; ++i) {
      if (trials[i].is_open && noise_of(trials[i]) > std::max(kHardlyAny, kClearlyMore * least)) {
        trials[i].is_open = false;
      }
    }
  }
}

}  // namespace

void measure_proposals(const SourceSurface& source, const MeshFrame& frame, const ByPiece& leaf_triangles,
                       double finest, std::span<std::vector<GroupProposals>> levels) {
  // Down to the finest pixel, from one that is as large as the mesh at least.
  const double smallest_pixel = 2.0 * static_cast<double>(kPixelBlocks.back());
  const double narrowest = finest / smallest_pixel;
  std::size_t steps = 1;
  double widest = narrowest;
  for (; 1.5 * smallest_pixel * widest < 2.0 * frame.radius; widest *= 2.0) ++steps;
  std::vector<Trial> trials;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    for (std::size_t g = 0; g < levels[l].size(); ++g) {
      for (std::size_t p = 0; p < levels[l][g].proposals.size(); ++p) {
        Trial trial{.level = l, .group = g, .proposal = p};
        // Samples that are much wider than pieces would find them by luck.
        double spacing = widest;
        for (; spacing > levels[l][g].grain && trial.first_step + 1 < steps; spacing *= 0.5) ++trial.first_step;
        trials.push_back(trial);
      }
    }
  }
  std::size_t first_step = steps - 1;
  for (const Trial& trial : trials) first_step = std::min(first_step, trial.first_step);
  std::vector<Lattice> lattices{Lattice(frame.center, frame.radius, widest)};
  while (lattices.size() < steps) lattices.push_back(lattices.back().finer());
  std::array<LeafMasks, kViews> leaves;
  for (std::size_t v = 0; v < kViews; ++v) {
    leaves[v] = draw_leaves(source, leaf_triangles, lattices.back(), views()[v], first_step, steps);
  }
  for (std::size_t step = first_step; step < steps; ++step) {
    if (std::none_of(trials.begin(), trials.end(), [](const Trial& trial) { return trial.is_open; })) break;
    if (std::none_of(trials.begin(), trials.end(), [&](const Trial& t) { return t.octaves_at(step) > 0; })) continue;
    const double spacing = lattices[step].spacing;
    std::array<ViewResult, kViews> of_view;
    for (std::size_t v = 0; v < kViews; ++v) {
      of_view[v] = look(leaves[v][step], lattices[step], views()[v], levels, trials, step);
    }
    for (std::size_t i = 0; i < trials.size(); ++i) {
      Trial& trial = trials[i];
      const std::size_t octaves = trial.octaves_at(step);
      const double share = levels[trial.level][trial.group].share;
      Proposal& proposal = levels[trial.level][trial.group].proposals[trial.proposal];
      double before = 0.0, after = 0.0, all = 0.0;
      for (std::size_t v = 0; v < kViews && octaves > 0; ++v) {
        const Change& change = of_view[v].change[i];
        const auto covered = static_cast<double>(of_view[v].covered);
        proposal.shifts[v] = covered > 0.0 ? static_cast<double>(change.after - change.before) / covered : 0.0;
        before += static_cast<double>(change.before);
        after += static_cast<double>(change.after);
        all += covered;
      }
      if (all > 0.0) proposal.sum_shift = (after / proposal.luck - before) / all;
      for (std::size_t s = 0; s < 2 * octaves && trial.is_open; ++s) {
        double whole = 0.0, change = 0.0;
        for (const ViewResult& result : of_view) {
          whole += static_cast<double>(result.whole[2 * (step + 1 - octaves) + s]);
          change += static_cast<double>(result.change[i].squares[s]);
        }
        const double size = pixel_size(spacing, octaves, s);
        const double error = whole > 0.0 && share > 0.0 ? std::sqrt(change / (share * whole)) : 0.0;
        proposal.noise.points.push_back({size, error});
        trial.is_open = error <= kLoosestNoise;
      }
    }
    close_worse_ways(levels, trials);
  }
}

namespace {

constexpr std::size_t kCutSize = 1;  // of the two of an octave: a pixel of so many blocks
constexpr double kCutBlocks = 2.0 * static_cast<double>(kPixelBlocks[kCutSize]);

}  // namespace

CutMeter::CutMeter(const SourceSurface& source, const MeshFrame& frame, const ByPiece& leaf_triangles, double smallest,
                   std::size_t count, double grain, double finest) {
  // Of the smallest pixels, and of each size from there: how often its samples are halved.
  const auto halvings_of = [&](double pixel_size) {
    std::size_t halvings = 0;
    for (double spacing = pixel_size / kCutBlocks; spacing > grain && spacing > finest / kCutBlocks; spacing *= 0.5)
      ++halvings;
    return halvings;
  };
  const std::size_t most = halvings_of(smallest);
  std::size_t coarsest = 0;
  double size = smallest;
  for (std::size_t i = 0; i < count; ++i, size *= 2.0) {
    const std::size_t halvings = halvings_of(size);
    sizes_.push_back({halvings + 1, i + most >= halvings ? i + most - halvings : 0});
    coarsest = std::max(coarsest, sizes_.back().lattice);
  }
  const double spacing = std::ldexp(smallest / kCutBlocks, -static_cast<int>(most));
  lattices_.emplace_back(frame.center, frame.radius, std::ldexp(spacing, static_cast<int>(coarsest)));
  while (lattices_.size() <= coarsest) lattices_.push_back(lattices_.back().finer());
  for (std::size_t v = 0; v < kViews; ++v)
    leaves_[v] = draw_leaves(source, leaf_triangles, lattices_.back(), views()[v], 0, lattices_.size());
  for (auto& of_view : leaves_) std::reverse(of_view.begin(), of_view.end());
  std::reverse(lattices_.begin(), lattices_.end());
}

CutChange CutMeter::measure(const ThinnedCut& cut, std::size_t size) const {
  const auto [octaves, lattice] = sizes_[size];
  double whole = 0.0, change = 0.0, before = 0.0, after = 0.0;
  for (std::size_t v = 0; v < kViews; ++v) {
    const std::vector<SampleMask>& leaves = leaves_[v][lattice];
    const auto cover_by = [&](std::span<const std::uint32_t> some, const SampleMask& more) {
      MaskBox box = more.box();
      for (const std::uint32_t leaf : some) box.include(leaves[leaf].box());
      SampleMask cover(box);
      cover.add(more);
      for (const std::uint32_t leaf : some) cover.add(leaves[leaf]);
      return cover;
    };
    const SampleMask all = cover_by(cut.source_leaves, SampleMask());
    const SampleMask drawn = cover_by(cut.leaves, mask_of(lattices_[lattice], views()[v], cut.triangles));
    const Change of_view = change_of(all, drawn, {}, octaves);
    whole += static_cast<double>(squares_of_all(all, octaves)[kCutSize]);
    change += static_cast<double>(of_view.squares[kCutSize]);
    before += static_cast<double>(of_view.before);
    after += static_cast<double>(of_view.after);
  }
  if (!(whole > 0.0 && before > 0.0)) return {};
  return {std::sqrt(change / whole), (after / cut.luck - before) / before};
}

std::vector<std::vector<Covered>> covered_samples(const SourceSurface& source, const MeshFrame& frame,
                                                  const ByPiece& leaf_triangles, double spacing,
                                                  std::span<const View> views,
                                                  std::span<const std::uint32_t> run_lengths) {
  const Lattice lattice(frame.center, frame.radius, spacing);
  std::vector<std::vector<Covered>> sums;
  for (const std::uint32_t run : run_lengths) sums.emplace_back(leaf_triangles.size() / run, Covered(views.size(), 0));
  for (std::size_t v = 0; v < views.size(); ++v) {
    const View& view = views[v];
    std::vector<SampleMask> masks(leaf_triangles.size());
    parallel_for_each_index(masks.size(), 1, [&](std::size_t leaf) {
      masks[leaf] = source_mask(source, lattice, view, leaf_triangles.of(leaf));
    });
    for (std::size_t r = 0; r < run_lengths.size(); ++r) {
      // Masks so far are of runs half as long, or of the same.
      while (masks.size() > sums[r].size()) masks = joined_in_pairs(masks);
      for (std::size_t g = 0; g < masks.size(); ++g) sums[r][g][v] = masks[g].count();
    }
  }
  return sums;
}

Covered covered_samples(const MeshFrame& frame, std::span<const Corners> triangles, double spacing,
                        std::span<const View> views) {
  const Lattice lattice(frame.center, frame.radius, spacing);
  Covered covered;
  for (const View& view : views) covered.push_back(mask_of(lattice, view, triangles).count());
  return covered;
}

}  // namespace meshlode::build
