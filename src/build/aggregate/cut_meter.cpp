// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/cut_meter.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/parallel.h"

namespace meshlode::build {

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
    sizes_.push_back({halvings + 1, i + most - halvings});  // one halving more a size at most
    coarsest = std::max(coarsest, sizes_.back().lattice);
  }
  const double spacing = std::ldexp(smallest / kCutBlocks, -static_cast<int>(most));
  lattices_.emplace_back(frame.center, frame.radius, std::ldexp(spacing, static_cast<int>(coarsest)));
  while (lattices_.size() <= coarsest) lattices_.push_back(lattices_.back().finer());
  for (std::size_t v = 0; v < kViews; ++v) {
    leaves_[v] = draw_leaves(source, leaf_triangles, lattices_.back(), views()[v], 0, lattices_.size());
    std::reverse(leaves_[v].begin(), leaves_[v].end());
  }
  std::reverse(lattices_.begin(), lattices_.end());
}

CutChange CutMeter::measure(const ThinnedCut& cut, std::size_t size) const {
  const std::size_t octaves = sizes_[size].octaves, lattice = sizes_[size].lattice;
  struct Seen {
    double whole = 0.0;
    Change change;
  };
  std::array<Seen, kViews> seen;
  parallel_for_each_index(kViews, 1, [&](std::size_t v) {
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
    seen[v] = {static_cast<double>(squares_of_all(all, octaves)[kCutSize]), change_of(all, drawn, {}, octaves)};
  });
  double whole = 0.0, change = 0.0, before = 0.0, after = 0.0;
  for (const Seen& view : seen) {
    whole += view.whole;
    change += static_cast<double>(view.change.squares[kCutSize]);
    before += static_cast<double>(view.change.before);
    after += static_cast<double>(view.change.after);
  }
  if (!(whole > 0.0 && before > 0.0)) return {};
  return {std::sqrt(change / whole), (after / cut.luck - before) / before};
}

}  // namespace meshlode::build
