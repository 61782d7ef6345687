// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/coverage_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace meshlode::builder {

namespace {

/// Of a level with so many groups each is looked at in every other view, its neighbours in the others: there the views
/// of a group differ by less than its neighbours do, and most of the triangles are in such levels.
constexpr std::size_t kManyGroups = 8;

/// A proposal on its way from coarse pixels to fine ones.
struct Trial {
  std::size_t level = 0, group = 0, proposal = 0;
  std::size_t first_step = 0;  ///< the first spacing that is fine enough for its pieces
  bool is_one_of_many = false;
  bool is_open = true;

  [[nodiscard]] bool is_seen_in(std::size_t view) const { return !is_one_of_many || (view + group) % 2 == 0; }

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

ViewResult look(std::span<const SampleMask> leaves, const Lattice& lattice, std::size_t v,
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
      const CoverCount cover = cover_of(masks);
      parallel_for_each_index(end - first, 1, [&](std::size_t i) {
        const Trial& trial = trials[first + i];
        const std::size_t octaves = trial.octaves_at(step);
        if (octaves == 0 || !trial.is_seen_in(v)) return;
        const std::span<const Corners> triangles = levels[level][trial.group].proposals[trial.proposal].triangles;
        result.change[first + i] =
            change_of(masks[trial.group], mask_of(lattice, views()[v], triangles), cover, octaves);
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
        Trial trial{.level = l, .group = g, .proposal = p, .is_one_of_many = levels[l].size() >= kManyGroups};
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
    parallel_for_each_index(
        kViews, 1, [&](std::size_t v) { of_view[v] = look(leaves[v][step], lattices[step], v, levels, trials, step); });
    for (std::size_t i = 0; i < trials.size(); ++i) {
      Trial& trial = trials[i];
      const std::size_t octaves = trial.octaves_at(step);
      const double share = levels[trial.level][trial.group].share;
      Proposal& proposal = levels[trial.level][trial.group].proposals[trial.proposal];
      double before = 0.0, after = 0.0, all = 0.0;
      for (std::size_t v = 0; v < kViews && octaves > 0; ++v) {
        proposal.shifts[v] = 0.0;
        if (!trial.is_seen_in(v)) continue;  // its neighbours stand for it
        const double groups = trial.is_one_of_many ? 2.0 : 1.0;
        const Change& change = of_view[v].change[i];
        const auto covered = static_cast<double>(of_view[v].covered);
        if (covered > 0.0) proposal.shifts[v] = groups * static_cast<double>(change.after - change.before) / covered;
        before += static_cast<double>(change.before);
        after += static_cast<double>(change.after);
        all += covered;
      }
      if (all > 0.0) proposal.sum_shift = (after / proposal.luck - before) / all;
      for (std::size_t s = 0; s < 2 * octaves && trial.is_open; ++s) {
        double whole = 0.0, change = 0.0;
        for (std::size_t v = 0; v < kViews; ++v) {
          if (!trial.is_seen_in(v)) continue;
          whole += static_cast<double>(of_view[v].whole[2 * (step + 1 - octaves) + s]);
          change += static_cast<double>(of_view[v].change[i].squares[s]);
        }
        const double size = pixel_size(spacing, octaves, s);
        const double error = whole > 0.0 && share > 0.0 ? std::sqrt(change / (share * whole)) : 0.0;
        proposal.noise.points.push_back({size, error});
        trial.is_open = error <= kLoosestNoise && size > proposal.noise.finest;
      }
    }
    close_worse_ways(levels, trials);
  }
}

}  // namespace meshlode::builder
