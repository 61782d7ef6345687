// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/covered_samples.h"

#include "base/parallel.h"

namespace meshlode::builder {

namespace {

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

}  // namespace

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
  Covered covered(views.size());
  parallel_for_each_index(views.size(), 1,
                          [&](std::size_t v) { covered[v] = mask_of(lattice, views[v], triangles).count(); });
  return covered;
}

}  // namespace meshlode::builder
