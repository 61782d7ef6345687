// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/hold_to_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "builder/aggregate/cut_meter.h"

namespace meshlode::builder {

namespace {

// What whole cuts may have. From other directions they have some percent more noise.
constexpr double kMostCutNoise = 0.21, kMostCutShift = 0.017;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Uses = std::vector<std::vector<NoiseUse>>;

/// How finely whole cuts are looked at, from where, and how much more or less they may cover.
struct Scrutiny {
  std::span<const View> views;
  double grain, finest;  ///< as CutMeter's
  double closest;        ///< as `finest`, where fewer samples than these see anything
  double fewest_seen;
  double most_shift;

  [[nodiscard]] bool may_be_closer() const { return finest > closest; }
  void be_closer() {
    grain *= 0.5;
    finest *= 0.5;
  }
};

/// `finest`: pixels that measure_proposals() looked at.
Scrutiny scrutiny_of(const ThinnedWays& ways, double finest) {
  double piece = kInfinity;
  for (const std::vector<GroupProposals>& level : ways.proposals) {
    for (const GroupProposals& group : level) piece = group.grain > 0.0 ? std::min(piece, group.grain) : piece;
  }
  // Wider samples find the sums of thin blades by luck, to some percent.
  const double grain = 0.25 * piece;
  // Of few triangles some are large, and what a handful covers, and how much noise it has, hangs on the directions that
  // it is looked at from. They are looked at from many, in 256 to 1,024 samples across, and not in so many where pieces
  // are so small that these miss them too, unless so few see anything that a sum has more than half a percent of luck.
  // If it has even so, nothing can be told of needles like these.
  constexpr double kFewestSeen = 40'000.0;
  constexpr std::size_t kFewTriangles = 4096, kAHandful = 1024;
  constexpr double kMostFewShift = 0.015, kFewPixels = 128.0, kFewestAcross = 256.0, kMostAcross = 4096.0;
  const std::size_t triangles = ways.leaves.triangles.items.size();
  if (triangles > kFewTriangles) return {std::span(views()).first(kViews), grain, finest, finest, 0.0, kMostCutShift};
  const std::span<const View> from =
      triangles > kAHandful ? std::span<const View>(many_views()) : std::span<const View>(most_views());
  const double longest = ways.frame.longest;
  return {from,
          std::min(grain, longest / kFewestAcross),
          longest / (grain >= longest / kMostAcross ? kFewPixels : 0.5 * kFewPixels),
          longest / kFewPixels,
          kFewestSeen,
          kMostFewShift};
}

/// Of each leaf whether something replaces it, at whatever size.
std::vector<std::uint8_t> ever_replaced(const ThinnedWays& ways, const Uses& uses) {
  std::vector<std::uint8_t> is_ever(ways.leaves.size(), 0);
  for (std::size_t l = 0; l < uses.size(); ++l) {
    for (std::size_t g = 0; g < uses[l].size(); ++g) {
      const GroupProposals& group = ways.proposals[l][g];
      if (uses[l][g].pixel_size < kInfinity)
        std::fill(is_ever.begin() + group.first_leaf, is_ever.begin() + group.end_leaf, std::uint8_t{1});
    }
  }
  return is_ever;
}

/// What a cut at a pixel size draws, and by what luck the views show more of it.
ThinnedCut cut_at(const ThinnedWays& ways, std::span<const View> views, const Uses& uses, double pixel_size) {
  ThinnedCut cut;
  ShownArea shown, source;
  std::vector<std::uint8_t> is_replaced(ways.leaves.size(), 0);
  const std::vector<std::uint8_t> is_ever = ever_replaced(ways, uses);
  for (std::size_t l = uses.size(); l-- > 0;) {
    for (std::size_t g = 0; g < uses[l].size(); ++g) {
      const GroupProposals& group = ways.proposals[l][g];
      if (uses[l][g].pixel_size > pixel_size || is_replaced[group.first_leaf] != 0) continue;
      std::fill(is_replaced.begin() + group.first_leaf, is_replaced.begin() + group.end_leaf, std::uint8_t{1});
      const Fitted& way = ways.fitted[l][g][way_of(ways.fitted[l][g], uses[l][g].way)];
      cut.triangles.insert(cut.triangles.end(), way.triangles.begin(), way.triangles.end());
      for (const Corners& c : way.triangles) {
        const Vec3d twice = glm::cross(c[1] - c[0], c[2] - c[0]);
        const double length = glm::length(twice);
        if (length > 0.0) shown.add(views, twice / length, 0.5 * length);
      }
    }
  }
  for (std::uint32_t leaf = 0; leaf < is_replaced.size(); ++leaf) {
    if (is_ever[leaf] == 0) continue;
    cut.source_leaves.push_back(leaf);
    if (is_replaced[leaf] == 0) cut.leaves.push_back(leaf);
    for (const std::uint32_t c : ways.leaves.cards_of(leaf, leaf + 1)) {
      const Card& card = ways.cards.cards[c];
      source.add(views, card.normal(), card.area);
      if (is_replaced[leaf] == 0) shown.add(views, card.normal(), card.area);
    }
  }
  cut.luck = shown.luck() / source.luck();
  return cut;
}

/// Whether there are leaves that nothing replaces.
bool is_any_kept(const ThinnedWays& ways, const Uses& uses) {
  const std::vector<std::uint8_t> is_ever = ever_replaced(ways, uses);
  for (std::uint32_t leaf = 0; leaf < is_ever.size(); ++leaf) {
    if (is_ever[leaf] == 0 && !ways.leaves.triangles.of(leaf).empty()) return true;
  }
  return false;
}

/// Whether something comes between two pixel sizes, the larger one included.
bool is_any_between(const Uses& uses, double low, double high) {
  return std::any_of(uses.begin(), uses.end(), [&](const std::vector<NoiseUse>& level) {
    return std::any_of(level.begin(), level.end(),
                       [&](const NoiseUse& use) { return use.pixel_size > low && use.pixel_size <= high; });
  });
}

void move_all_between(Uses& uses, double low, double high, double to) {
  for (std::vector<NoiseUse>& level : uses) {
    for (NoiseUse& use : level) {
      if (use.pixel_size > low && use.pixel_size <= high) use.pixel_size = to;
    }
  }
}

/// The coarsest of what comes between never does.
void drop_coarsest_between(Uses& uses, double low, double high) {
  for (std::size_t l = uses.size(); l-- > 0;) {
    bool is_any = false;
    for (NoiseUse& use : uses[l]) {
      if (!(use.pixel_size > low && use.pixel_size <= high)) continue;
      use.pixel_size = kInfinity;
      is_any = true;
    }
    if (is_any) return;
  }
}

/// From small pixels to large ones. False: all is to be looked at again, since some groups never come any more, and
/// leaves that nothing replaces are not compared with; or more closely than so far.
bool are_held(const ThinnedWays& ways, Scrutiny& how, Uses& uses) {
  double smallest = kInfinity, largest = 0.0;
  for (const std::vector<NoiseUse>& level : uses) {
    for (const NoiseUse& use : level) {
      if (!(use.pixel_size < kInfinity)) continue;
      smallest = std::min(smallest, use.pixel_size);
      largest = std::max(largest, use.pixel_size);
    }
  }
  if (!(largest > 0.0)) return true;
  std::size_t count = 1;
  double size = largest;
  for (; 0.5 * size >= smallest; size *= 0.5) ++count;
  const CutMeter meter(ways.source, ways.frame, ways.leaves.triangles, how.views, size, count, how.grain, how.finest);
  // What is kept has no part of the noise, which was shared out as if it did: of the rest it is more in smaller pixels.
  const bool is_for_all = !is_any_kept(ways, uses);
  double held = 0.0;  // cuts up to there are as they should be
  for (std::size_t i = 0; i < count; ++i, size *= 2.0) {
    const bool is_last = i + 1 == count;
    bool is_held = true, is_dropped = false;
    // What is drawn in larger pixels too has less noise there, and covers as much.
    while (is_any_between(uses, held, size)) {
      const CutChange change = meter.measure(cut_at(ways, how.views, uses, size), i);
      if (change.samples < how.fewest_seen && how.may_be_closer()) {
        how.be_closer();
        return false;
      }
      is_held = change.noise <= kMostCutNoise && std::fabs(change.sum_shift) <= how.most_shift &&
                change.samples >= how.fewest_seen;
      if (is_held || !is_last) break;
      // There are no larger pixels to wait for: what is finer may do.
      drop_coarsest_between(uses, held, size);
      is_dropped = true;
    }
    if (is_dropped) return false;
    if (is_held) {
      if (!is_for_all) move_all_between(uses, held, size, size);
      held = size;
    } else {
      move_all_between(uses, held, 2.0 * size, 2.0 * size);
    }
  }
  return true;
}

}  // namespace

void hold_to_pictures(const ThinnedWays& ways, double finest, std::vector<std::vector<NoiseUse>>& uses) {
  constexpr int kPasses = 24;
  Scrutiny how = scrutiny_of(ways, finest);
  for (int pass = 0; pass < kPasses; ++pass) {
    if (are_held(ways, how, uses)) return;
  }
  for (std::vector<NoiseUse>& level : uses) level.assign(level.size(), {});  // no way to tell what is seen
}

}  // namespace meshlode::builder
