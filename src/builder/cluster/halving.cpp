// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/halving.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdlib>
#include <limits>

#include "builder/symmetric.h"

namespace meshlode::builder {

namespace {

constexpr std::int32_t kTolerance = 2;  ///< node weight, of a half against its share: half a quad
constexpr std::int32_t kSlack = 4;      ///< on the way to a better cut: a quad
constexpr int kPasses = 4;
constexpr std::size_t kPatience = 16;  ///< moves in a row that bring no better cut
/// How far the directions of the cuts that are tried lean from the principal axis to the second. Of the dragon, the
/// bunny and data/terrain.glb the first alone leaves borders 2 to 4% longer; eight save nothing more.
constexpr std::array kTilts{0.0F, 0.5F, -0.5F, 1.0F, -1.0F};

/// Of two nodes the one with the greater gain has the greater rank, of equals the first. One number, so that a search
/// for the best has no branch: which node is better than all before it is a toss.
std::int64_t rank_of(std::int32_t gain, std::uint32_t node) {
  return std::int64_t{gain} * (std::int64_t{1} << 32U) + static_cast<std::int64_t>(~node);
}
constexpr std::int64_t kNoRank = std::numeric_limits<std::int64_t>::min();
std::uint32_t node_of(std::int64_t rank) {
  return ~static_cast<std::uint32_t>(static_cast<std::uint64_t>(rank));
}

/// A float as a number that sorts like it. \pre it is no NaN
std::uint64_t ordered_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits >> 31U) != 0 ? ~bits : bits | 1U << 31U;
}

}  // namespace

void Halving::take(std::span<const std::uint32_t> nodes) {
  const auto count = static_cast<std::uint32_t>(nodes.size());
  for (std::uint32_t i = 0; i < count; ++i) local_[nodes[i]] = i;
  start_.clear();
  edges_.clear();
  weight_.clear();
  around_.clear();
  for (const std::uint32_t node : nodes) {
    start_.push_back(static_cast<std::uint32_t>(edges_.size()));
    weight_.push_back(graph_.node_weight.empty() ? 1 : graph_.node_weight[node]);
    around_.push_back(0);
    for (auto i = static_cast<std::size_t>(graph_.row_start[node]);
         i < static_cast<std::size_t>(graph_.row_start[node + 1]); ++i) {
      const std::uint32_t other = local_[static_cast<std::size_t>(graph_.neighbor[i])];
      if (other == kNoId) continue;
      edges_.emplace_back(other, graph_.edge_weight[i]);
      around_.back() += graph_.edge_weight[i];
    }
  }
  start_.push_back(static_cast<std::uint32_t>(edges_.size()));
  for (const std::uint32_t node : nodes) local_[node] = kNoId;
}

void Halving::move(std::uint32_t node) {
  const bool was_right = is_right_[node] != 0;
  is_right_[node] = was_right ? 0 : 1;
  left_ += was_right ? weight_[node] : -weight_[node];
  cut_ -= gain_[node];
  gain_[node] = -gain_[node];
  for (std::uint32_t i = start_[node]; i < start_[node + 1]; ++i) {
    const auto [other, weight] = edges_[i];
    gain_[other] += is_right_[other] == is_right_[node] ? -2 * weight : 2 * weight;
    if (is_listed_[other] == 0) border_.push_back(other);
    is_listed_[other] = 1;
  }
}

/// Where the nodes lie along the first two of their principal axes.
void Halving::project(std::span<const std::uint32_t> nodes) {
  Vec3d mean(0.0);
  for (const std::uint32_t node : nodes) mean += Vec3d(centers_[node]);
  mean /= static_cast<double>(nodes.size());
  Mat3d covariance(0.0);
  for (const std::uint32_t node : nodes) {
    const Vec3d d = Vec3d(centers_[node]) - mean;
    covariance += outer(d, d);
  }
  const Axes axes = axes_of(covariance);
  along_.clear();
  for (const std::uint32_t node : nodes) {
    const Vec3d d = Vec3d(centers_[node]) - mean;
    along_.emplace_back(glm::dot(axes.direction[0], d), glm::dot(axes.direction[1], d));
  }
}

/// The left half is what comes first in a direction, up to its share of the weight.
void Halving::sweep(float tilt) {
  const auto count = static_cast<std::uint32_t>(along_.size());
  order_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    order_.push_back(ordered_bits(along_[i].x + tilt * along_[i].y) << 32U | i);
  }
  std::sort(order_.begin(), order_.end());
  is_right_.assign(count, 1);
  left_ = cut_ = 0;
  for (const std::uint64_t key : order_) {
    const auto node = static_cast<std::uint32_t>(key);
    if (left_ > 0 && std::abs(left_ + weight_[node] - target_) > std::abs(left_ - target_)) return;
    left_ += weight_[node];
    cut_ += around_[node];
    is_right_[node] = 0;
    for (std::uint32_t i = start_[node]; i < start_[node + 1]; ++i) {
      const auto [other, weight] = edges_[i];
      cut_ -= is_right_[other] != 0 ? 0 : 2 * weight;
    }
  }
}

/// Goes on with a cut that was left for others.
void Halving::take_up(const std::vector<std::uint8_t>& is_right) {
  is_right_ = is_right;
  gain_.resize(weight_.size());
  left_ = cut_ = 0;
  for (std::uint32_t node = 0; node < weight_.size(); ++node) {
    std::int32_t out = 0;
    for (std::uint32_t i = start_[node]; i < start_[node + 1]; ++i) {
      if (is_right_[edges_[i].first] != is_right_[node]) out += edges_[i].second;
    }
    gain_[node] = 2 * out - around_[node];
    if (is_right_[node] == 0) left_ += weight_[node];
    if (is_right_[node] == 0) cut_ += out;
  }
}

std::int32_t Halving::imbalance() const {
  return std::max(0, std::abs(left_ - target_) - kTolerance);
}

/// One pass: the node of the border whose move gains most, then the next, each once, also at a loss; what came after
/// the best cut is taken back. False where the cut is the one that was.
bool Halving::refine_once() {
  const auto count = static_cast<std::uint32_t>(weight_.size());
  is_moved_.assign(count, 0);
  is_listed_.assign(count, 0);
  border_.clear();
  for (std::uint32_t node = 0; node < count; ++node) {
    if (gain_[node] == -around_[node]) continue;
    is_listed_[node] = 1;
    border_.push_back(node);
  }
  moves_.clear();
  std::size_t best_moves = 0;
  std::int32_t best_imbalance = imbalance(), best_cut = cut_;
  while (moves_.size() < count && moves_.size() < best_moves + kPatience) {
    std::int64_t best_rank = kNoRank;
    const std::int32_t over = left_ - target_;
    const std::int32_t most = std::max(kSlack, std::abs(over) - 1);  // off the share, afterwards
    for (const std::uint32_t node : border_) {
      const std::int32_t after = std::abs(over + (is_right_[node] != 0 ? weight_[node] : -weight_[node]));
      const bool is_allowed = (after <= most) & (is_moved_[node] == 0);
      best_rank = std::max(best_rank, is_allowed ? rank_of(gain_[node], node) : kNoRank);
    }
    if (best_rank == kNoRank) break;
    const std::uint32_t best = node_of(best_rank);
    move(best);
    is_moved_[best] = 1;
    moves_.push_back(best);
    if (imbalance() > best_imbalance || (imbalance() == best_imbalance && cut_ >= best_cut)) continue;
    best_imbalance = imbalance();
    best_cut = cut_;
    best_moves = moves_.size();
  }
  for (; moves_.size() > best_moves; moves_.pop_back()) move(moves_.back());
  return best_moves > 0;
}

void Halving::cut(std::span<std::uint32_t> nodes, std::uint32_t parts, std::uint32_t first_label,
                  std::vector<std::uint32_t>& labels) {
  if (parts == 1 || nodes.size() <= parts) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      labels[nodes[i]] = first_label + (parts == 1 ? 0 : static_cast<std::uint32_t>(i));
    }
    return;
  }
  take(nodes);
  std::int32_t total = 0;
  for (const std::int32_t weight : weight_) total += weight;
  target_ = static_cast<std::int32_t>(std::int64_t{total} * (parts / 2) / parts);
  project(nodes);
  std::int32_t best_cut = 0;
  best_.clear();
  for (const float tilt : kTilts) {
    sweep(tilt);
    if (!best_.empty() && cut_ >= best_cut) continue;
    best_cut = cut_;
    best_ = is_right_;
  }
  take_up(best_);
  for (int pass = 0; pass < kPasses && refine_once(); ++pass) {
  }
  // Both halves in the order of their nodes, and with a node at least for each of their parts.
  std::vector<std::uint32_t>&left = left_nodes_, &right = right_nodes_;
  left.clear();
  right.clear();
  for (std::size_t i = 0; i < nodes.size(); ++i) (is_right_[i] != 0 ? right : left).push_back(nodes[i]);
  for (; left.size() < parts / 2; right.pop_back()) left.push_back(right.back());
  for (; right.size() < parts - parts / 2; left.pop_back()) right.push_back(left.back());
  std::copy(right.begin(), right.end(), std::copy(left.begin(), left.end(), nodes.begin()));
  const std::size_t middle = left.size();
  cut(nodes.first(middle), parts / 2, first_label, labels);
  cut(nodes.subspan(middle), parts - parts / 2, first_label + parts / 2, labels);
}

}  // namespace meshlode::builder
