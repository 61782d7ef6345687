// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/cut_meter.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/parallel.h"

namespace meshlode::builder {

namespace {

constexpr std::size_t kCutSize = 1;  // of the two of an octave: a pixel of so many blocks
constexpr double kCutBlocks = 2.0 * static_cast<double>(kPixelBlocks[kCutSize]);

}  // namespace

CutMeter::CutMeter(const SourceSurface& source, const MeshFrame& frame, const ByPiece& leaf_triangles,
                   std::span<const View> views, double smallest, std::size_t count, double grain, double finest)
    : source_(source), leaf_triangles_(leaf_triangles), views_(views) {
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
    sizes_.push_back({static_cast<unsigned>(halvings), i + most - halvings});  // one halving more a size at most
    coarsest = std::max(coarsest, sizes_.back().lattice);
  }
  const double spacing = std::ldexp(smallest / kCutBlocks, -static_cast<int>(most));
  lattices_.emplace_back(frame.center, frame.radius, std::ldexp(spacing, static_cast<int>(coarsest)));
  while (lattices_.size() <= coarsest) lattices_.push_back(lattices_.back().finer());
  if (views_.size() <= kViews) leaves_.resize(views_.size());
  for (std::size_t v = 0; v < leaves_.size(); ++v) {
    leaves_[v] = draw_leaves(source, leaf_triangles, lattices_.back(), views_[v], 0, lattices_.size());
    std::reverse(leaves_[v].begin(), leaves_[v].end());
  }
  std::reverse(lattices_.begin(), lattices_.end());
}

SampleMask CutMeter::draw(std::size_t view, std::size_t lattice, std::span<const std::uint32_t> leaves) const {
  if (leaves_.empty()) {
    std::vector<std::uint32_t> triangles;
    for (const std::uint32_t leaf : leaves) {
      const auto of_leaf = leaf_triangles_.of(leaf);
      triangles.insert(triangles.end(), of_leaf.begin(), of_leaf.end());
    }
    return source_mask(source_, lattices_[lattice], views_[view], triangles);
  }
  MaskBox box;
  for (const std::uint32_t leaf : leaves) box.include(leaves_[view][lattice][leaf].box());
  SampleMask cover(box);
  for (const std::uint32_t leaf : leaves) cover.add(leaves_[view][lattice][leaf]);
  return cover;
}

CutChange CutMeter::measure(const ThinnedCut& cut, std::size_t size) const {
  const std::size_t lattice = sizes_[size].lattice;
  const unsigned halvings = sizes_[size].halvings;
  struct Seen {
    double whole = 0.0;
    Change change;
  };
  std::vector<Seen> seen(views_.size());
  parallel_for_each_index(seen.size(), 1, [&](std::size_t v) {
    const SampleMask all = draw(v, lattice, cut.source_leaves);
    const SampleMask as_they_are = draw(v, lattice, cut.leaves),
                     instead = mask_of(lattices_[lattice], views_[v], cut.triangles);
    MaskBox box = as_they_are.box();
    box.include(instead.box());
    SampleMask drawn(box);
    drawn.add(as_they_are);
    drawn.add(instead);
    seen[v] = {static_cast<double>(squares_of_all(all, 1, halvings)[kCutSize]), change_of(all, drawn, {}, 1, halvings)};
  });
  double whole = 0.0, change = 0.0, before = 0.0, after = 0.0;
  for (const Seen& view : seen) {
    whole += view.whole;
    change += static_cast<double>(view.change.squares[kCutSize]);
    before += static_cast<double>(view.change.before);
    after += static_cast<double>(view.change.after);
  }
  if (!(whole > 0.0 && before > 0.0)) return {};
  return {std::sqrt(change / whole), (after / cut.luck - before) / before, before};
}

}  // namespace meshlode::builder
