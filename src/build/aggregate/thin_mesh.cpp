// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/thin_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "build/aggregate/blocks.h"
#include "build/aggregate/candidates.h"
#include "build/aggregate/coverage_error.h"
#include "build/aggregate/noise_budget.h"

namespace meshlode::build {

namespace {

constexpr double kMostInAView = 0.75;        // more or less: a level that shows a view so much else stands for nothing
constexpr std::size_t kFewestTriangles = 8;  // a level below would be a handful of cards across the whole mesh
constexpr std::size_t kFewCards = 512;       // of a whole mesh: they are seen from more directions
constexpr std::size_t kFewGroups = 1;        // so many are hardly out of step: levels lie closer together
// What single views may show more or less where a mesh is at least so many pixels across. From 37 directions some show
// half as much again as the worst of thirteen.
constexpr double kMostViewShift = 0.10, kViewsHeldFrom = 30.0;
constexpr double kFinestPixels = 110.0;  // pixels along the mesh's longest side: below, levels are not told apart

MeshFrame frame_of(const PreparedMesh& mesh) {
  Vec3d low = mesh.exact_positions[mesh.exact_triangles[0][0]], high = low;
  for (const auto& triangle : mesh.exact_triangles) {
    for (const std::uint32_t p : triangle) {
      low = glm::min(low, mesh.exact_positions[p]);
      high = glm::max(high, mesh.exact_positions[p]);
    }
  }
  const Vec3d size = high - low;
  return {0.5 * (low + high), 0.5 * glm::length(size), std::max({size.x, size.y, size.z})};
}

/// Pieces in leaves, and the lists that follow from it.
struct Leaves {
  int depth = 0;
  ByPiece triangles;                      ///< of the source, by leaf
  std::vector<std::uint32_t> first_card;  ///< by leaf, into `cards`
  std::vector<std::uint32_t> cards;       ///< of PieceCards, in the order of leaves

  /// Before each leaf, how many triangles the leaves so far have in the first level: a card each, and of single
  /// triangles, which are one card already, half as many.
  std::vector<std::size_t> first_level;

  [[nodiscard]] std::size_t size() const { return triangles.size(); }
  [[nodiscard]] std::span<const std::uint32_t> cards_of(std::uint32_t first_leaf, std::uint32_t end_leaf) const {
    return {cards.data() + first_card[first_leaf], first_card[end_leaf] - first_card[first_leaf]};
  }
  [[nodiscard]] std::size_t triangle_count(std::uint32_t first_leaf, std::uint32_t end_leaf) const {
    return triangles.first[end_leaf] - triangles.first[first_leaf];
  }
};

Leaves make_leaves(const PreparedMesh& mesh, const ByPiece& pieces, const PieceCards& cards,
                   std::uint32_t leaf_triangles) {
  std::vector<Vec3d> centers(pieces.size());
  std::vector<std::uint32_t> weights(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    Vec3d sum(0.0);
    for (const std::uint32_t t : pieces.of(p)) {
      for (const std::uint32_t v : mesh.exact_triangles[t]) sum += mesh.exact_positions[v];
    }
    weights[p] = static_cast<std::uint32_t>(pieces.of(p).size());
    centers[p] = sum / (3.0 * weights[p]);
  }
  Leaves leaves;
  while ((mesh.triangles.size() >> static_cast<unsigned>(leaves.depth)) > leaf_triangles) ++leaves.depth;
  const Blocks blocks = split_by_weight(centers, weights, leaves.depth);
  leaves.triangles.first.push_back(0);
  leaves.first_card.push_back(0);
  leaves.first_level.push_back(0);
  for (std::size_t leaf = 0; leaf < blocks.size(); ++leaf) {
    const auto in_leaf = blocks.of(leaf);
    std::vector<Vec3d> points;
    for (const std::uint32_t p : in_leaf) points.push_back(centers[p]);
    const Blocks order = points.empty() ? Blocks{} : split_evenly(points, points.size());
    for (const std::uint32_t place : order.order) {
      const std::uint32_t p = in_leaf[place];
      const auto triangles = pieces.of(p);
      leaves.triangles.items.insert(leaves.triangles.items.end(), triangles.begin(), triangles.end());
      for (std::uint32_t c = cards.first[p]; c < cards.first[p + 1]; ++c) leaves.cards.push_back(c);
    }
    leaves.triangles.first.push_back(static_cast<std::uint32_t>(leaves.triangles.items.size()));
    leaves.first_card.push_back(static_cast<std::uint32_t>(leaves.cards.size()));
    const std::size_t cards_of_leaf = leaves.first_card[leaf + 1] - leaves.first_card[leaf];
    const std::size_t half = (leaves.triangles.of(leaf).size() + 1) / 2;
    leaves.first_level.push_back(leaves.first_level.back() + std::min(cards_of_leaf, half));
  }
  return leaves;
}

/// How samples are looked at to find factors.
struct Sampling {
  std::span<const View> views;
  std::size_t counted = 0;  ///< of the views, the first ones: those over which as much is to be covered
  double spacing = 0.0;     ///< of the source's; cards that are larger need fewer samples
  double samples_each = 0.0;

  [[nodiscard]] double sum(const Covered& covered) const {
    double all = 0.0;
    for (std::size_t v = 0; v < counted; ++v) all += static_cast<double>(covered[v]);
    return all;
  }
  /// For so many cards of an area together: so many samples each, and as many as a mean over all of them asks for.
  [[nodiscard]] double spacing_of(double area, std::size_t cards) const {
    constexpr double kFewestSamples = 8192.0;
    const double samples = std::max(kFewestSamples, samples_each * static_cast<double>(cards));
    return std::max(spacing, std::sqrt(area / samples));
  }
};

/// A way of thinning out that covers as much, or none.
struct Fitted {
  Splats splats;
  std::vector<Corners> triangles;
  double worst_view = 0.0;  ///< what a single view's sum changes by at most
  bool is_there = false;
  bool is_fair = false;  ///< is there, and changes single views no more than other ways do
};

/// Seen along a field of grass, cards rise out of it: ways that do are left out where there are others.
void leave_out_unfair(std::span<Fitted> ways) {
  constexpr double kFineView = 0.10, kNearlyAsGood = 1.1;
  double fairest = std::numeric_limits<double>::infinity();
  for (const Fitted& way : ways) {
    if (way.is_there) fairest = std::min(fairest, way.worst_view);
  }
  for (Fitted& way : ways) {
    way.is_fair = way.is_there && way.worst_view <= std::max(kFineView, kNearlyAsGood * fairest);
  }
}

/// Finds the factor for which the splats, which have an area, cover as much as the source, over all views. It begins
/// with the one given.
void fit_factor(const MeshFrame& frame, const Covered& covered, const Sampling& sampling, double area, double& factor,
                Fitted& way) {
  constexpr double kCloseEnough = 0.004;
  constexpr int kFactorSteps = 12;
  const double spacing = sampling.spacing_of(area, way.splats.splats.size());
  const double weight = spacing * spacing / (sampling.spacing * sampling.spacing);  // in samples of the source
  const double wanted = sampling.sum(covered);
  if (!(wanted > 0.0)) return;
  double low = 0.0, low_count = 0.0, high = 0.0, high_count = 0.0;
  Covered now;
  for (int step = 0; step < kFactorSteps; ++step) {
    way.triangles.clear();
    for (const Splat& splat : way.splats.splats) way.triangles.push_back(splat.corners(factor));
    now = covered_samples(frame, way.triangles, spacing, sampling.views);
    const double count = weight * sampling.sum(now);
    if (std::fabs(count - wanted) <= kCloseEnough * wanted) break;
    if (count < wanted) {
      low = factor;
      low_count = count;
    } else {
      high = factor;
      high_count = count;
    }
    if (high > 0.0 && high_count - low_count > 0.0) {
      const double share = std::clamp((wanted - low_count) / (high_count - low_count), 0.1, 0.9);
      factor = low + (high - low) * share;
    } else {
      // Nothing covers more so far: further than in proportion, since cards come to hide each other.
      const double more = wanted / std::max(count, 1.0);
      factor *= std::min(2.0, more * more);
    }
  }
  for (std::size_t v = 0; v < now.size(); ++v) {
    if (covered[v] == 0) continue;
    const double share = weight * static_cast<double>(now[v]) / static_cast<double>(covered[v]);
    way.worst_view = std::max(way.worst_view, std::fabs(share - 1.0));
  }
  way.is_there =
      std::fabs(weight * sampling.sum(now) - wanted) <= kMostCoverageShift * wanted && way.worst_view <= kMostInAView;
}

/// Where a block has few members, what stays in place is nearest to the picture; where it has many, what is spread. A
/// way that is not tried where another is better takes no time.
bool is_worth_trying(Thinning thinning, double members) {
  switch (thinning) {
    case Thinning::kInPlace: return members < 3.0;
    case Thinning::kMoved: return true;
    case Thinning::kNeedle: return members > 3.0;
    case Thinning::kMerged: return members > 7.0;
  }
  return false;
}

/// How a level is made from the finest one.
struct LevelPlan {
  std::uint32_t run = 1;  ///< leaves of a group
  double members = 1.0;   ///< cards of a block, about
};

/// Half as many cards each and groups of twice as many leaves; where groups are few, half of that way.
std::vector<LevelPlan> plan_levels(std::size_t leaves, std::size_t cards) {
  constexpr int kMostLevels = 80;
  std::vector<LevelPlan> levels;
  LevelPlan next;
  bool is_between = false;
  while (static_cast<double>(cards) / next.members >= static_cast<double>(kFewestTriangles) &&
         levels.size() < kMostLevels) {
    levels.push_back(next);
    is_between = leaves / next.run <= kFewGroups && !is_between;
    next.members *= leaves / next.run <= kFewGroups ? std::sqrt(2.0) : 2.0;
    if (!is_between) next.run = std::min(2 * next.run, static_cast<std::uint32_t>(leaves));
  }
  return levels;
}

class Thinner {
 public:
  Thinner(const PreparedMesh& mesh, std::span<const SourceMaterial> materials, const ThinOptions& options)
      : materials_(materials),
        stride_(mesh.layout.stride()),
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
    for (const LevelPlan& level : plan_levels(leaves_.size(), leaves_.first_level.back())) {
      const bool is_whole = level.run == leaves_.size();
      const double cards = static_cast<double>(leaves_.first_level.back()) / level.members;
      if (is_whole && seen_by_many_.empty() && cards <= static_cast<double>(kFewCards)) {
        if (!fitted.empty()) look_from_many_views(fitted.back());
        if (seen_by_many_.empty()) {
          const std::array<std::uint32_t, 1> all{static_cast<std::uint32_t>(leaves_.size())};
          seen_by_many_ = covered_samples(source_, frame_, leaves_.triangles, few_.spacing, few_.views, all)[0][0];
        }
      }
      fitted.push_back(fit_level(level));
      if (is_whole && seen_by_many_.empty()) look_from_many_views(fitted.back());
      proposals.push_back(proposals_of(level, fitted.back()));
    }
    measure_proposals(source_, frame_, leaves_.triangles, frame_.longest / kFinestPixels, proposals);
    ThinMesh out;
    const std::vector<std::vector<NoiseUse>> uses = uses_of(proposals);
    for (std::size_t l = 0; l < proposals.size(); ++l) out.levels.push_back(choose(proposals[l], fitted[l], uses[l]));
    out.leaf_triangles = std::move(leaves_.triangles);
    return out;
  }

 private:
  /// What many cards cover stands for what the pieces do, if there is a way for each group: such a sum hangs on no
  /// card's direction, and the pieces of a large mesh need not be drawn so often. Together they cover a little more or
  /// less, as they hide each other and no factor is exact: how much, the usual views tell.
  void look_from_many_views(std::span<const std::vector<Fitted>> groups) {
    std::vector<Corners> all;
    for (const std::vector<Fitted>& ways : groups) {
      const auto way = std::find_if(ways.begin(), ways.end(), [](const Fitted& f) { return f.is_there; });
      if (way == ways.end()) return;
      all.insert(all.end(), way->triangles.begin(), way->triangles.end());
    }
    const double seen = fit_.sum(covered_samples(frame_, all, fit_.spacing, fit_.views));
    const double wanted = fit_.sum(covered_.back().front());
    if (!(seen > 0.0)) return;
    seen_by_many_ = covered_samples(frame_, all, few_.spacing, few_.views);
    for (std::uint64_t& count : seen_by_many_) {
      count = static_cast<std::uint64_t>(std::llround(static_cast<double>(count) * wanted / seen));
    }
  }

  /// Group by group, every way of thinning it out.
  [[nodiscard]] std::vector<std::vector<Fitted>> fit_level(const LevelPlan& level) const {
    std::vector<std::vector<Fitted>> fitted(leaves_.size() / level.run);
    parallel_for_each_index(fitted.size(), 1, [&](std::size_t g) {
      const auto first = static_cast<std::uint32_t>(g * level.run);
      fitted[g] = fit_group(level, first, first + level.run);
    });
    return fitted;
  }

  [[nodiscard]] std::vector<Fitted> fit_group(const LevelPlan& level, std::uint32_t first, std::uint32_t end) const {
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
    const Covered& covered = covered_[static_cast<std::size_t>(std::countr_zero(level.run))][first / level.run];
    double area = 0.0;
    for (const std::uint32_t c : chosen) area += cards_.cards.cards[c].area;
    double factor = 1.0;  // what one way needs is near what another does
    for (Fitted& way : ways) {
      const bool is_few = !seen_by_many_.empty() && way.splats.splats.size() <= kFewCards;
      fit_factor(frame_, is_few ? seen_by_many_ : covered, is_few ? few_ : fit_, area, factor, way);
    }
    leave_out_unfair(ways);
    return ways;
  }

  /// Half as many as the level before, but for regions out of step: if all kept a half, all would be replaced at once.
  [[nodiscard]] std::size_t splat_count(double members, std::size_t cards, std::uint32_t first,
                                        std::uint32_t end) const {
    const std::size_t most = leaves_.first_level[end] - leaves_.first_level[first];
    if (members <= 1.0) return most;
    const double place = 0.5 * (first + end) / static_cast<double>(leaves_.size());
    const double share = 1.3 - 0.6 * place;
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
        if (way.is_fair) groups[g].proposals.push_back({way.triangles, {}, {}});
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
          group.ways.push_back({&proposal.noise, proposal.shifts, proposal.triangles.size()});
        levels[l].push_back(std::move(group));
      }
    }
    return share_out_noise(levels, {kMostCoverageError, kMostViewShift, frame_.longest / kViewsHeldFrom});
  }

  [[nodiscard]] std::vector<ThinGroup> choose(std::span<const GroupProposals> proposals,
                                              std::span<const std::vector<Fitted>> fitted,
                                              std::span<const NoiseUse> uses) const {
    std::vector<ThinGroup> groups(proposals.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
      ThinGroup& group = groups[g];
      group.first_leaf = proposals[g].first_leaf;
      group.end_leaf = proposals[g].end_leaf;
      group.pixel_size = uses[g].pixel_size;
      if (!(group.pixel_size < std::numeric_limits<double>::infinity())) continue;
      std::size_t p = 0;  // only fair ways are proposed
      for (const Fitted& way : fitted[g]) {
        if (!way.is_fair || p++ != uses[g].way) continue;
        group.triangles = way.triangles;
        group.attributes = way.splats.attributes;
        for (const Splat& splat : way.splats.splats) group.material.push_back(materials_[splat.material].coarse);
      }
    }
    return groups;
  }

  std::span<const SourceMaterial> materials_;
  std::size_t stride_;
  MeshFrame frame_;
  ByPiece pieces_;
  PieceCards cards_;
  SourceSurface source_;
  Leaves leaves_;
  double drawn_area_ = 0.0;
  Sampling fit_;  ///< that factors are found by
  std::vector<std::vector<Covered>>
      covered_;           ///< what the groups' pieces cover so, by level; the last for all later ones
  Sampling few_;          ///< the same where cards are few
  Covered seen_by_many_;  ///< what the whole mesh covers so; empty before few cards stand for it
};

}  // namespace

ThinMesh thin_mesh(const PreparedMesh& mesh, std::span<const SourceMaterial> materials, const ThinOptions& options) {
  return Thinner(mesh, materials, options).run();
}

}  // namespace meshlode::build
