// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/thin_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/box.h"
#include "base/parallel.h"
#include "builder/aggregate/blocks.h"
#include "builder/aggregate/candidates.h"
#include "builder/aggregate/coverage_error.h"
#include "builder/aggregate/covered_samples.h"
#include "builder/aggregate/fit_factor.h"
#include "builder/aggregate/hold_to_pictures.h"
#include "builder/aggregate/leaves.h"
#include "builder/aggregate/noise_budget.h"
#include "builder/aggregate/settle.h"

namespace meshlode::builder {

namespace {

constexpr std::size_t kFewestTriangles = 8;  // a level below would be a handful of cards across the whole mesh
// Of a whole mesh: they are seen from more directions, and moved to where they have less noise. So many are looked at
// from there.
constexpr std::size_t kFewCards = 512, kSomeCards = 1024;
// In pictures of so many pixels along the longest side, and of so many times the root of how many there are: in finer
// ones they have more noise than can be settled, most of them, and such pictures take room.
constexpr double kSettlingPixels = 55.0, kPixelsOfCard = 3.0;
// What all views together may show more or less: groups that cover as much as their pieces do alone may hide more or
// less of each other.
constexpr double kMostSumShift = 0.012;
// And single views, where a mesh is at least so many pixels across. From 37 directions some show half as much again as
// the worst of thirteen.
constexpr double kMostViewShift = 0.10, kViewsHeldFrom = 30.0;
// Few cards are seen from 48, and more of these: what is seen of a thin wall along itself few directions tell.
constexpr double kMostOfManyViews = 0.08;
// Cards that have settled cover as much as they should however large they are, but one comes to see how they are
// shaded. Pixels, of a card in the mean.
constexpr double kMostCardArea = 25.0;
constexpr double kFinestPixels = 110.0;  // pixels along the mesh's longest side: below, levels are not told apart

MeshFrame frame_of(const PreparedMesh& mesh) {
  Box3d box;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Vec3d& corner : corners_of(mesh, t)) box.add(corner);
  }
  const Vec3d size = box.size();
  return {0.5 * (box.low + box.high), 0.5 * glm::length(size), std::max({size.x, size.y, size.z})};
}

/// Where a block has few members, what stays in place is nearest to the picture; where it has many, what is spread. A
/// way that is not fair where another is better takes no time.
bool is_worth_trying(Thinning thinning, double members) {
  switch (thinning) {
    case Thinning::kInPlace: return members < 3.0;
    case Thinning::kMoved: return true;
    case Thinning::kNeedle: return members > 3.0;
    case Thinning::kMerged: return members > 6.0;
  }
  return false;
}

/// How a level is made from the first one.
struct LevelPlan {
  std::uint32_t run = 1;  ///< leaves of a group
  double members = 1.0;   ///< triangles of the first level that become one, about
};

/// Half as many triangles each, in groups of twice as many leaves; once all are in one group, which is out of step with
/// nothing, half of that way. `triangles`: of the first level.
std::vector<LevelPlan> plan_levels(std::size_t leaves, std::size_t triangles) {
  constexpr int kMostLevels = 80;
  std::vector<LevelPlan> levels;
  LevelPlan next;
  while (static_cast<double>(triangles) / next.members >= static_cast<double>(kFewestTriangles) &&
         levels.size() < kMostLevels) {
    levels.push_back(next);
    next.members *= next.run == leaves ? std::sqrt(2.0) : 2.0;
    next.run = std::min(2 * next.run, static_cast<std::uint32_t>(leaves));
  }
  return levels;
}

class Thinner {
 public:
  Thinner(const PreparedMesh& mesh, std::span<const SourceMaterial> materials, const ThinOptions& options)
      : materials_(materials),
        stride_(mesh.layout.stride()),
        grid_(mesh.grid),
        frame_(frame_of(mesh)),
        pieces_(find_pieces(mesh)),
        cards_(make_cards(mesh, pieces_, materials)),
        source_(mesh, materials, cards_.is_closed),
        leaves_(make_leaves(mesh, pieces_, cards_, options.leaf_triangles)) {
    for (const Card& card : cards_.cards.cards) drawn_area_ += card.area;
    // Four samples a card are enough: the errors of so many of them, from all views, cancel.
    const double width = std::sqrt(drawn_area_ / static_cast<double>(std::max<std::size_t>(1, cards_.cards.size())));
    fit_ = {views(), kViews, std::max(0.5 * width, frame_.longest / 4096.0), 8.0};
    std::vector<std::uint32_t> runs;
    for (int doublings = 0; doublings <= leaves_.depth; ++doublings)
      runs.push_back(1U << static_cast<unsigned>(doublings));
    covered_ = covered_samples(source_, frame_, leaves_.triangles, fit_.spacing, fit_.views, runs);
    // Of a few thousand cards more samples.
    const double finer = std::min(1.0, std::sqrt(static_cast<double>(cards_.cards.size()) / 4096.0));
    few_ = {many_views(), kManyViews, std::max(0.5 * width * finer, frame_.longest / 2048.0), 64.0};
  }

  ThinMesh run() {
    std::vector<std::vector<GroupProposals>> proposals;
    std::vector<std::vector<std::vector<Fitted>>> fitted;
    std::vector<LevelPlan> plans;
    for (const LevelPlan& level : plan_levels(leaves_.size(), leaves_.first_level.back())) {
      const double cards = static_cast<double>(leaves_.first_level.back()) / level.members;
      if (is_whole(level) && seen_by_many_.empty() && cards <= static_cast<double>(kFewCards)) {
        if (!fitted.empty()) look_from_many_views(fitted.back());
        if (seen_by_many_.empty()) {
          seen_by_many_ = seen_in_fact_.empty() ? seen_from(few_) : seen_in_fact_;
          luck_of_many_ = luck_of_cards(few_, leaves_.cards);
        }
      }
      std::span<const std::vector<Fitted>> finer;
      if (!fitted.empty()) {
        if (!is_of_few(fitted.back())) forget_splats(fitted.back());
        finer = fitted.back();
      }
      fitted.push_back(fit_level(level, finer));
      if (is_whole(level) && cards > static_cast<double>(kFewCards) && cards <= static_cast<double>(kSomeCards))
        hold_to_many_views(fitted.back().front());
      if (is_whole(level) && seen_by_many_.empty()) look_from_many_views(fitted.back());
      plans.push_back(level);
    }
    settle_levels(fitted);
    for (std::size_t l = 0; l < fitted.size(); ++l) {
      forget_splats(fitted[l]);
      proposals.push_back(proposals_of(plans[l], fitted[l]));
    }
    measure_proposals(source_, frame_, leaves_.triangles, frame_.longest / kFinestPixels, proposals);
    ThinMesh out;
    std::vector<std::vector<NoiseUse>> uses = uses_of(proposals);
    hold_to_pictures({source_, frame_, leaves_, cards_.cards, proposals, fitted}, frame_.longest / kFinestPixels, uses);
    leave_out_undrawn(uses);
    for (std::size_t l = 0; l < proposals.size(); ++l)
      out.levels.push_back(choose_and_free(proposals[l], fitted[l], uses[l]));
    out.leaf_triangles = std::move(leaves_.triangles);
    return out;
  }

 private:
  /// What many cards cover stands for what the pieces do, if there is a way for each group: such a sum hangs on no
  /// card's direction, and the pieces of a large mesh need not be drawn so often. Together they cover a little more or
  /// less, as they hide each other and no factor is exact: how much, the usual views tell.
  void look_from_many_views(std::span<const std::vector<Fitted>> groups) {
    std::vector<Corners> all;
    ShownArea shown, shown_to_many;
    for (const std::vector<Fitted>& ways : groups) {
      const auto way = std::find_if(ways.begin(), ways.end(), [](const Fitted& f) { return f.is_there; });
      if (way == ways.end()) return;
      all.insert(all.end(), way->triangles.begin(), way->triangles.end());
      shown.add(way->shown);
      shown_to_many.add(shown_by(few_.counted_views(), way->splats));
    }
    const double seen = fit_.sum(covered_samples(frame_, all, fit_.spacing, fit_.views)) / shown.luck();
    const double wanted = fit_.sum(covered_.back().front()) / luck_of_cards(fit_, leaves_.cards);
    if (!(seen > 0.0)) return;
    seen_by_many_ = covered_samples(frame_, all, few_.spacing, few_.views);
    luck_of_many_ = shown_to_many.luck();
    for (std::uint64_t& count : seen_by_many_) {
      count = static_cast<std::uint64_t>(std::llround(static_cast<double>(count) * wanted / seen));
    }
  }

  /// As fit_few() does, of some more cards.
  void hold_to_many_views(std::span<Fitted> ways) {
    if (seen_in_fact_.empty()) seen_in_fact_ = seen_from(few_);
    for (Fitted& way : ways) {
      if (!way.is_there) continue;
      const double spacing = few_.spacing_of(drawn_area_, way.triangles.size());
      const Covered now = covered_samples(frame_, way.triangles, spacing, few_.views);
      const double worst = worst_view(seen_in_fact_, now, spacing * spacing / (few_.spacing * few_.spacing));
      if (worst > kMostOfManyViews) way.finest = frame_.longest / kViewsHeldFrom;
    }
  }

  /// What the whole mesh covers.
  [[nodiscard]] Covered seen_from(const Sampling& sampling) const {
    const std::array<std::uint32_t, 1> all{static_cast<std::uint32_t>(leaves_.size())};
    return covered_samples(source_, frame_, leaves_.triangles, sampling.spacing, sampling.views, all)[0][0];
  }

  static void forget_splats(std::span<std::vector<Fitted>> level) {
    for (std::vector<Fitted>& ways : level) {
      for (Fitted& way : ways) way.forget_splats();
    }
  }

  [[nodiscard]] double luck_of_cards(const Sampling& sampling, std::span<const std::uint32_t> chosen) const {
    ShownArea shown;
    for (const std::uint32_t c : chosen)
      shown.add(sampling.counted_views(), cards_.cards.cards[c].normal(), cards_.cards.cards[c].area);
    return shown.luck();
  }

  /// Group by group, every way of thinning it out. `finer`: the level before.
  [[nodiscard]] std::vector<std::vector<Fitted>> fit_level(const LevelPlan& level,
                                                           std::span<const std::vector<Fitted>> finer) const {
    std::vector<std::vector<Fitted>> fitted(leaves_.size() / level.run);
    parallel_for_each_index(fitted.size(), 1, [&](std::size_t g) {
      const auto first = static_cast<std::uint32_t>(g * level.run);
      double factor = 1.0;  // what one way needs is near what another does, or the group before
      if (!finer.empty()) {
        for (const Fitted& way : finer[g * finer.size() / fitted.size()]) factor = way.is_there ? way.factor : factor;
      }
      fitted[g] = fit_group(level, first, first + level.run, factor);
    });
    return fitted;
  }

  [[nodiscard]] std::vector<Fitted> fit_group(const LevelPlan& level, std::uint32_t first, std::uint32_t end,
                                              double factor) const {
    const auto chosen = leaves_.cards_of(first, end);
    std::vector<Fitted> ways;
    if (chosen.empty()) return ways;
    const std::size_t count = splat_count(level.members, chosen.size(), first, end);
    if (count == chosen.size()) {
      ways.emplace_back().splats = splats_of(cards_.cards, chosen, stride_);
    } else {
      std::vector<Vec3d> centers;
      for (const std::uint32_t c : chosen) centers.push_back(cards_.cards.cards[c].center);
      const Blocks blocks = split_evenly(centers, count);
      const double members = static_cast<double>(chosen.size()) / static_cast<double>(count);
      for (const Thinning thinning : kThinnings) {
        if (!is_worth_trying(thinning, members)) continue;
        ways.emplace_back().splats = thin_out(cards_.cards, chosen, blocks, thinning, stride_);
      }
    }
    const double luck = luck_of_cards(fit_, chosen);
    const bool is_few = is_whole(level) && !seen_by_many_.empty() && count <= kFewCards;
    const Covered& covered = covered_[static_cast<std::size_t>(std::countr_zero(level.run))][first / level.run];
    double area = 0.0;
    for (const std::uint32_t c : chosen) area += cards_.cards.cards[c].area;
    for (Fitted& way : ways) {
      if (is_few) {
        fit_few(luck, factor, way);
      } else {
        fit({covered, fit_, area, luck}, luck, factor, way);
      }
      if (way.is_there) factor = way.factor;
    }
    leave_out_unfair(ways);
    return ways;
  }

  /// `luck`: of the cards that it stands for.
  void fit(const Target& target, double luck, double start, Fitted& way) const {
    way.shown = shown_by(fit_.counted_views(), way.splats);
    way.luck = way.shown.luck() / luck;
    fit_factor(frame_, grid_, target, start, way);
  }
  void fit_few(double luck, double start, Fitted& way) const {
    fit({seen_by_many_, few_, drawn_area_, luck_of_many_}, luck, start, way);
    way.finest = way.worst_view > kMostOfManyViews ? frame_.longest / kViewsHeldFrom : 0.0;
  }

  [[nodiscard]] bool is_whole(const LevelPlan& level) const { return level.run == leaves_.size(); }
  /// Whether few cards stand for the whole mesh, and fewer than it has.
  [[nodiscard]] bool is_of_few(std::span<const std::vector<Fitted>> level) const {
    if (level.size() != 1 || level.front().empty()) return false;
    const std::size_t count = level.front().front().splats.splats.size();  // 0: forgotten
    return count > 0 && count <= kFewCards && count < leaves_.cards.size();
  }

  void settle_levels(std::span<std::vector<std::vector<Fitted>>> levels) const {
    std::vector<std::size_t> few;
    for (std::size_t l = 0; l < levels.size(); ++l) {
      if (is_of_few(levels[l])) few.push_back(l);
    }
    if (few.empty()) return;
    const SourcePictures pictures(source_, frame_, leaves_.triangles, frame_.longest / kSettlingPixels);
    const double luck = luck_of_cards(fit_, leaves_.cards);
    parallel_for_each_index(few.size(), 1, [&](std::size_t i) {
      std::vector<Fitted>& ways = levels[few[i]].front();
      if (auto settled = settled_way(pictures, luck, ways)) {
        ways.clear();
        ways.push_back(std::move(*settled));
      }
    });
  }

  /// Of all ways the one with least noise, with less of it; none where it does not cover as much any more.
  [[nodiscard]] std::optional<Fitted> settled_way(const SourcePictures& pictures, double luck,
                                                  std::span<const Fitted> ways) const {
    std::vector<const Fitted*> fair;
    double most_area = 0.0, count = 1.0;
    for (const Fitted& way : ways) {
      if (!way.is_fair) continue;
      fair.push_back(&way);
      double area = 0.0;
      for (const Splat& splat : way.splats.splats) area += way.factor * splat.area;
      count = static_cast<double>(way.splats.splats.size());
      most_area = std::max(most_area, area / count);
    }
    if (fair.empty()) return std::nullopt;
    std::vector<WayToSettle> unsettled;
    unsettled.reserve(fair.size());
    for (const Fitted* way : fair) unsettled.push_back({way->splats, way->factor});
    const double finest = std::sqrt(most_area / kMostCardArea);
    const std::size_t best =
        settle(pictures, std::max(finest, frame_.longest / (kPixelsOfCard * std::sqrt(count))), unsettled);
    Fitted settled = *fair[best];
    settled.splats = std::move(unsettled[best].splats);
    fit_few(luck, settled.factor, settled);
    if (!settled.is_there) return std::nullopt;
    settled.finest = std::max(settled.finest, finest);
    return settled;
  }

  /// Half as many as the level before, but for regions out of step: if all kept a half, all would be replaced at once.
  [[nodiscard]] std::size_t splat_count(double members, std::size_t cards, std::uint32_t first,
                                        std::uint32_t end) const {
    const std::size_t most = leaves_.first_level[end] - leaves_.first_level[first];
    if (members <= 1.0) return most;
    const double place = 0.5 * (first + end) / static_cast<double>(leaves_.size());
    const double share = kMostOfLeaf - 2.0 * (kMostOfLeaf - 1.0) * place;
    const double count = share * static_cast<double>(most) / members;
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::floor(count + 0.5)), 1, cards);
  }

  [[nodiscard]] std::vector<GroupProposals> proposals_of(const LevelPlan& level,
                                                         std::span<const std::vector<Fitted>> fitted) const {
    std::vector<GroupProposals> groups(fitted.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
      groups[g].first_leaf = static_cast<std::uint32_t>(g * level.run);
      groups[g].end_leaf = groups[g].first_leaf + level.run;
      double area = 0.0;
      for (const std::uint32_t c : leaves_.cards_of(groups[g].first_leaf, groups[g].end_leaf))
        area += cards_.cards.cards[c].area;
      groups[g].share = area / drawn_area_;
      const std::size_t cards = leaves_.cards_of(groups[g].first_leaf, groups[g].end_leaf).size();
      groups[g].grain = std::sqrt(area / static_cast<double>(std::max<std::size_t>(1, cards)));
      for (const Fitted& way : fitted[g]) {
        if (way.is_fair) groups[g].proposals.push_back({way.triangles, way.luck, {}, 0.0, {{}, way.finest}});
      }
    }
    return groups;
  }

  /// Which way each group is drawn, and from which pixel size on.
  [[nodiscard]] std::vector<std::vector<NoiseUse>> uses_of(
      std::span<const std::vector<GroupProposals>> proposals) const {
    std::vector<std::vector<NoisyGroup>> levels(proposals.size());
    for (std::size_t l = 0; l < levels.size(); ++l) {
      for (const GroupProposals& from : proposals[l]) {
        NoisyGroup group{from.share, leaves_.triangle_count(from.first_leaf, from.end_leaf), {}};
        for (const Proposal& proposal : from.proposals)
          group.ways.push_back({&proposal.noise, proposal.shifts, proposal.sum_shift, proposal.triangles.size()});
        levels[l].push_back(std::move(group));
      }
    }
    return share_out_noise(levels,
                           {kMostCoverageError, kMostSumShift, kMostViewShift, frame_.longest / kViewsHeldFrom});
  }

  [[nodiscard]] std::vector<ThinGroup> choose_and_free(std::span<const GroupProposals> proposals,
                                                       std::vector<std::vector<Fitted>>& fitted,
                                                       std::span<const NoiseUse> uses) const {
    std::vector<ThinGroup> groups(proposals.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
      ThinGroup& group = groups[g];
      group.first_leaf = proposals[g].first_leaf;
      group.end_leaf = proposals[g].end_leaf;
      group.pixel_size = uses[g].pixel_size;
      if (!(group.pixel_size < std::numeric_limits<double>::infinity())) continue;
      Fitted& way = fitted[g][way_of(fitted[g], uses[g].way)];
      group.triangles = std::move(way.triangles);
      group.attributes = std::move(way.splats.attributes);
      group.material = std::move(way.material);
      for (std::uint32_t& material : group.material) material = materials_[material].coarse;
    }
    fitted = {};
    return groups;
  }

  std::span<const SourceMaterial> materials_;
  std::size_t stride_;
  format::PositionGrid grid_;
  MeshFrame frame_;
  ByPiece pieces_;
  PieceCards cards_;
  SourceSurface source_;
  Leaves leaves_;
  double drawn_area_ = 0.0;
  Sampling fit_;  ///< that factors are found by
  std::vector<std::vector<Covered>>
      covered_;                ///< what the groups' pieces cover so, by level; the last for all later ones
  Sampling few_;               ///< the same where cards are few
  Covered seen_by_many_;       ///< what the whole mesh covers so; empty before few cards stand for it
  Covered seen_in_fact_;       ///< the same, of its own triangles; empty before some cards stand for it
  double luck_of_many_ = 1.0;  ///< of the cards that this is of
};

}  // namespace

ThinMesh thin_mesh(const PreparedMesh& mesh, std::span<const SourceMaterial> materials, const ThinOptions& options) {
  return Thinner(mesh, materials, options).run();
}

}  // namespace meshlode::builder
