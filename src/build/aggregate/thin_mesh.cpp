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
// What all views together may show more or less: groups that cover as much as their pieces do alone may hide more or
// less of each other.
constexpr double kMostSumShift = 0.012;
// And single views, where a mesh is at least so many pixels across. From 37 directions some show half as much again as
// the worst of thirteen.
constexpr double kMostViewShift = 0.10, kViewsHeldFrom = 30.0;
// What whole cuts may have, which are looked at where pixels double. From other directions they have some percent more
// noise.
constexpr double kMostCutNoise = 0.21, kMostCutShift = 0.017;
constexpr double kFinestPixels = 110.0;  // pixels along the mesh's longest side: below, levels are not told apart

MeshFrame frame_of(const PreparedMesh& mesh) {
  Vec3d low = corners_of(mesh, 0)[0], high = low;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Vec3d& corner : corners_of(mesh, t)) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
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
      for (const Vec3d& corner : corners_of(mesh, t)) sum += corner;
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
  double luck = 1.0;        ///< how much more the usual views show of it than of its pieces, of what each has
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

/// What a view shows of cards that do not hide each other, and how much that is over all directions.
class ShownArea {
 public:
  explicit ShownArea(const Sampling& sampling) : sampling_(sampling) {}
  void add(const Vec3d& normal, double area) {
    area_ += area;
    for (std::size_t v = 0; v < sampling_.counted; ++v) {
      const View& view = sampling_.views[v];
      shown_ += area * std::fabs(glm::dot(normal, glm::cross(view.right, view.up)));
    }
  }
  /// How much more the views show than as many directions do in the mean, which is half of the area: of a large plate
  /// or a handful of cards that is luck, some percent of it.
  [[nodiscard]] double luck() const {
    const double mean = 0.5 * area_ * static_cast<double>(sampling_.counted);
    return mean > 0.0 && shown_ > 0.0 ? shown_ / mean : 1.0;
  }

 private:
  const Sampling& sampling_;
  double area_ = 0.0, shown_ = 0.0;
};

/// As it will be stored: of a needle that is some steps wide much of the area.
Corners on_grid(const format::PositionGrid& grid, const Corners& corners) {
  const double most = format::kMaxGridCoordinate * grid.step();
  Corners stored;
  for (std::size_t k = 0; k < 3; ++k)
    stored[k] = grid.decode(grid.quantize(glm::clamp(corners[k], Vec3d(-most), Vec3d(most))));
  return stored;
}

double luck_of(const Sampling& sampling, const Splats& splats) {
  ShownArea shown(sampling);
  for (const Splat& splat : splats.splats) shown.add(splat.normal(), splat.area);
  return shown.luck();
}

/// Only fair ways are proposed: the one that is proposed at that place.
const Fitted& way_of(std::span<const Fitted> ways, std::size_t proposal) {
  return *std::find_if(ways.begin(), ways.end(), [&](const Fitted& way) { return way.is_fair && proposal-- == 0; });
}

/// Finds the factor for which the splats, which have an area, cover as much as the source, over all views. It begins
/// with the one given, and gives its own where there is one. `luck`: of the cards that covered so much.
void fit_factor(const MeshFrame& frame, const format::PositionGrid& grid, const Covered& covered,
                const Sampling& sampling, double area, double luck, double& near_factor, Fitted& way) {
  constexpr double kCloseEnough = 0.004;
  constexpr int kFactorSteps = 12;
  const double spacing = sampling.spacing_of(area, way.splats.splats.size());
  const double weight = spacing * spacing / (sampling.spacing * sampling.spacing);  // in samples of the source
  const double wanted = sampling.sum(covered) * luck_of(sampling, way.splats) / luck;
  if (!(wanted > 0.0)) return;
  double factor = near_factor;
  double low = 0.0, low_count = 0.0, high = 0.0, high_count = 0.0;
  Covered now;
  for (int step = 0; step < kFactorSteps; ++step) {
    way.triangles.clear();
    for (const Splat& splat : way.splats.splats) way.triangles.push_back(on_grid(grid, splat.corners(factor)));
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
  if (way.is_there) near_factor = factor;
}

/// Where a block has few members, what stays in place is nearest to the picture; where it has many, what is spread. A
/// way that is not tried where another is better takes no time.
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
    for (const LevelPlan& level : plan_levels(leaves_.size(), leaves_.first_level.back())) {
      const bool is_whole = level.run == leaves_.size();
      const double cards = static_cast<double>(leaves_.first_level.back()) / level.members;
      if (is_whole && seen_by_many_.empty() && cards <= static_cast<double>(kFewCards)) {
        if (!fitted.empty()) look_from_many_views(fitted.back());
        if (seen_by_many_.empty()) {
          const std::array<std::uint32_t, 1> all{static_cast<std::uint32_t>(leaves_.size())};
          seen_by_many_ = covered_samples(source_, frame_, leaves_.triangles, few_.spacing, few_.views, all)[0][0];
          luck_of_many_ = luck_of_cards(few_, leaves_.cards);
        }
      }
      fitted.push_back(fit_level(level));
      if (is_whole && seen_by_many_.empty()) look_from_many_views(fitted.back());
      proposals.push_back(proposals_of(level, fitted.back()));
    }
    measure_proposals(source_, frame_, leaves_.triangles, frame_.longest / kFinestPixels, proposals);
    ThinMesh out;
    std::vector<std::vector<NoiseUse>> uses = uses_of(proposals);
    hold_to_pictures(proposals, fitted, uses);
    leave_out_undrawn(uses);
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
    ShownArea shown(fit_), shown_to_many(few_);
    for (const std::vector<Fitted>& ways : groups) {
      const auto way = std::find_if(ways.begin(), ways.end(), [](const Fitted& f) { return f.is_there; });
      if (way == ways.end()) return;
      all.insert(all.end(), way->triangles.begin(), way->triangles.end());
      for (const Splat& splat : way->splats.splats) {
        shown.add(splat.normal(), splat.area);
        shown_to_many.add(splat.normal(), splat.area);
      }
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

  [[nodiscard]] double luck_of_cards(const Sampling& sampling, std::span<const std::uint32_t> chosen) const {
    ShownArea shown(sampling);
    for (const std::uint32_t c : chosen) shown.add(cards_.cards.cards[c].normal(), cards_.cards.cards[c].area);
    return shown.luck();
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
    const double luck = luck_of_cards(fit_, chosen);
    double factor = 1.0;  // what one way needs is near what another does
    for (Fitted& way : ways) {
      const bool is_few = !seen_by_many_.empty() && way.splats.splats.size() <= kFewCards;
      fit_factor(frame_, grid_, is_few ? seen_by_many_ : covered, is_few ? few_ : fit_, area,
                 is_few ? luck_of_many_ : luck, factor, way);
      way.luck = luck_of(fit_, way.splats) / luck;
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
        if (way.is_fair) groups[g].proposals.push_back({way.triangles, way.luck, {}, 0.0, {}});
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

  using Levels = std::vector<std::vector<GroupProposals>>;
  using Uses = std::vector<std::vector<NoiseUse>>;

  /// What a cut at a pixel size draws.
  [[nodiscard]] ThinnedCut cut_at(double pixel_size, const Levels& proposals,
                                  std::span<const std::vector<std::vector<Fitted>>> fitted, const Uses& uses) const {
    ThinnedCut cut;
    ShownArea shown(fit_);
    std::vector<std::uint8_t> is_replaced(leaves_.size(), 0), is_ever(leaves_.size(), 0);
    for (std::size_t l = uses.size(); l-- > 0;) {
      for (std::size_t g = 0; g < uses[l].size(); ++g) {
        const GroupProposals& group = proposals[l][g];
        const auto mark = [&](std::vector<std::uint8_t>& leaves) {
          std::fill(leaves.begin() + group.first_leaf, leaves.begin() + group.end_leaf, std::uint8_t{1});
        };
        if (uses[l][g].pixel_size < std::numeric_limits<double>::infinity()) mark(is_ever);
        if (uses[l][g].pixel_size > pixel_size || is_replaced[group.first_leaf] != 0) continue;
        mark(is_replaced);
        const Fitted& way = way_of(fitted[l][g], uses[l][g].way);
        cut.triangles.insert(cut.triangles.end(), way.triangles.begin(), way.triangles.end());
        for (const Splat& splat : way.splats.splats) shown.add(splat.normal(), splat.area);
      }
    }
    ShownArea source(fit_);
    for (std::uint32_t leaf = 0; leaf < is_replaced.size(); ++leaf) {
      if (is_ever[leaf] == 0) continue;
      cut.source_leaves.push_back(leaf);
      if (is_replaced[leaf] == 0) cut.leaves.push_back(leaf);
      for (const std::uint32_t c : leaves_.cards_of(leaf, leaf + 1)) {
        const Card& card = cards_.cards.cards[c];
        source.add(card.normal(), card.area);
        if (is_replaced[leaf] == 0) shown.add(card.normal(), card.area);
      }
    }
    cut.luck = shown.luck() / source.luck();
    return cut;
  }

  /// Groups were measured one by one: what two of them cover together neither knows of. Whole cuts are looked at, from
  /// small pixels to large ones, and where one has too much what came last waits for larger pixels. Leaves that nothing
  /// replaces after that are not compared with: then it is of less that the others have to be a part.
  void hold_to_pictures(const Levels& proposals, std::span<const std::vector<std::vector<Fitted>>> fitted,
                        Uses& uses) const {
    constexpr int kPasses = 8;
    for (int pass = 0; pass < kPasses; ++pass) {
      if (are_held(proposals, fitted, uses)) return;
    }
    for (std::vector<NoiseUse>& level : uses) level.assign(level.size(), {});  // no way to tell what is seen
  }

  /// False: some never come any more, and all is to be looked at again.
  [[nodiscard]] bool are_held(const Levels& proposals, std::span<const std::vector<std::vector<Fitted>>> fitted,
                              Uses& uses) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double smallest = kInfinity, largest = 0.0, grain = kInfinity;
    for (const std::vector<NoiseUse>& level : uses) {
      for (const NoiseUse& use : level) {
        if (!(use.pixel_size < kInfinity)) continue;
        smallest = std::min(smallest, use.pixel_size);
        largest = std::max(largest, use.pixel_size);
      }
    }
    for (const std::vector<GroupProposals>& level : proposals) {
      for (const GroupProposals& group : level) grain = group.grain > 0.0 ? std::min(grain, group.grain) : grain;
    }
    const auto move = [&](double from, double to) {
      for (std::vector<NoiseUse>& level : uses) {
        for (NoiseUse& use : level) {
          if (use.pixel_size > from && use.pixel_size < to) use.pixel_size = to;
        }
      }
    };
    if (!(largest > 0.0)) return true;
    std::size_t count = 1;
    double first = largest;
    for (; 0.5 * first >= smallest; first *= 0.5) ++count;
    const CutMeter meter(source_, frame_, leaves_.triangles, first, count, 0.25 * grain,
                         frame_.longest / kFinestPixels);
    double held = 0.0, size = first;  // cuts up to there are as they should be
    for (std::size_t i = 0; i < count; ++i, size *= 2.0) {
      const CutChange change = meter.measure(cut_at(size, proposals, fitted, uses), i);
      if (change.noise <= kMostCutNoise && std::fabs(change.sum_shift) <= kMostCutShift) {
        held = size;
      } else if (i + 1 < count) {
        move(held, 2.0 * size);
      } else {
        move(held, kInfinity);
        return false;
      }
    }
    return true;
  }

  /// Of the same leaves a level that comes no later than one below it is drawn instead of that, always.
  static void leave_out_undrawn(Uses& uses) {
    for (std::size_t l = 0; l < uses.size(); ++l) {
      for (std::size_t above = l + 1; above < uses.size() && uses[above].size() == uses[l].size(); ++above) {
        for (std::size_t g = 0; g < uses[l].size(); ++g) {
          if (uses[above][g].pixel_size <= uses[l][g].pixel_size) uses[l][g] = {};
        }
      }
    }
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
      const Fitted& way = way_of(fitted[g], uses[g].way);
      group.triangles = way.triangles;
      group.attributes = way.splats.attributes;
      for (const Splat& splat : way.splats.splats) group.material.push_back(materials_[splat.material].coarse);
    }
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
  double luck_of_many_ = 1.0;  ///< of the cards that this is of
};

}  // namespace

ThinMesh thin_mesh(const PreparedMesh& mesh, std::span<const SourceMaterial> materials, const ThinOptions& options) {
  return Thinner(mesh, materials, options).run();
}

}  // namespace meshlode::build
