// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/resident_judge.h"

#include <algorithm>
#include <limits>

namespace meshlode::judge {

namespace {

/// Priorities are floats, made from doubles that are rounded up by 2^-20: a few of their last bits.
constexpr double kPrioritySlack = 1e-5;
/// As large as a finite priority gets, and as small (docs/reference/selection.md, "What is resident").
constexpr double kLargest = 0x1p126, kSmallest = 0x1p-126;

bool is_below(float priority, double low) {
  return double{priority} < std::clamp(low * (1.0 - kPrioritySlack), 0.0, kLargest);
}

}  // namespace

ResidentJudge::ResidentJudge(const run::Asset& asset, const MeshJudge& judge, const format::InstanceRecord& instance,
                             const JudgedView& view)
    : asset_(asset),
      judge_(judge),
      weighed_(judge.surface.group_count),
      is_blocked_(judge.surface.group_count),
      is_drawn_(judge.surface.cluster_count),
      least_requested_(judge.surface.group_count) {
  for (std::uint32_t k = 0; k < weighed_.size(); ++k) {
    weighed_[k] = weigh(view, instance, asset.meshes()[instance.mesh], group(k));
  }
}

/// The groups that hold a cluster made from group k, some more than once.
template <class Visit>
void ResidentJudge::for_each_coarser(std::uint32_t k, const Visit& visit) const {
  const MeshSurface& surface = judge_.surface;
  for (const std::uint32_t c : surface.made[k]) {
    visit(asset_.clusters()[surface.first_cluster + c].coarser_group - surface.first_group);
  }
}

void ResidentJudge::find_blocked(const Residency& residency) {
  for (auto k = judge_.group_order.rbegin(); k != judge_.group_order.rend(); ++k) {  // coarse to fine
    std::uint8_t blocked = residency.has(group(*k).page) ? 0 : 1;
    for_each_coarser(*k, [&](std::uint32_t coarser) { blocked |= is_blocked_[coarser]; });
    is_blocked_[*k] = blocked;
  }
}

/// The fewest and the most drawn on a path up to a group, from fine to coarse; at a root they are those of whole paths.
std::string ResidentJudge::find_coverage_fault(const Residency& residency) const {
  const MeshSurface& surface = judge_.surface;
  struct Range {
    std::uint32_t least = std::numeric_limits<std::uint32_t>::max(), most = 0;
  };
  std::vector<Range> up_to(surface.group_count);
  for (const std::uint32_t k : judge_.group_order) {
    const format::GroupRecord& record = group(k);
    for (std::uint32_t c = record.first_cluster; c < record.first_cluster + record.cluster_count; ++c) {
      const format::ClusterRecord& cluster = asset_.clusters()[c];
      const Range below = cluster.own_group == format::kNone ? Range{0, 0} : up_to[own_of(cluster)];
      const std::uint32_t here = is_drawn_[c - surface.first_cluster];
      up_to[k].least = std::min(up_to[k].least, below.least + here);
      up_to[k].most = std::max(up_to[k].most, below.most + here);
    }
    if (up_to[k].most > 1) return place("group", surface.first_group + k) + ": a piece of surface is drawn twice";
    if ((record.flags & format::kGroupTerminal) == 0) continue;
    const bool is_rooted = residency.has(record.page);
    if (is_rooted && up_to[k].least == 0) {
      return place("group", surface.first_group + k) + ": the cut is open, a piece of surface below it is not drawn";
    }
    if (!is_rooted && up_to[k].most > 0) {
      return place("group", surface.first_group + k) +
             ": its page is missing, and a piece of surface below it is drawn";
    }
  }
  return {};
}

std::string ResidentJudge::find_fault(const Residency& residency, std::span<const run::ClusterInstance> items) {
  const MeshSurface& surface = judge_.surface;
  std::fill(is_drawn_.begin(), is_drawn_.end(), std::uint8_t{0});
  for (const run::ClusterInstance& item : items) {
    const std::uint32_t c = item.cluster.value - surface.first_cluster;
    if (c >= surface.cluster_count) return place("cluster", item.cluster.value) + " is another mesh's";
    if (is_drawn_[c] != 0) return place("cluster", item.cluster.value) + " is drawn twice";
    is_drawn_[c] = 1;
    const std::uint32_t page = asset_.groups()[asset_.clusters()[item.cluster.value].coarser_group].page;
    if (!residency.has(page)) {
      return place("cluster", item.cluster.value) + " is drawn, and its " + place("page", page) + " is not resident";
    }
  }
  if (std::string fault = find_coverage_fault(residency); !fault.empty()) return fault;
  find_blocked(residency);
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset_.clusters()[surface.first_cluster + c];
    // Errors grow along the DAG (I4): where a group surely fails, so do all groups above.
    const auto surely_reached = [&](std::uint32_t k) {
      return weighed_[k].answer == Answer::kFails && is_blocked_[k] == 0;
    };
    const auto surely_not = [&](std::uint32_t k) {
      return weighed_[k].answer == Answer::kPasses || is_blocked_[k] != 0;
    };
    const std::uint32_t coarser = cluster.coarser_group - surface.first_group;
    const bool is_finest = cluster.own_group == format::kNone;
    if (is_drawn_[c] == 0 && surely_reached(coarser) && (is_finest || surely_not(own_of(cluster)))) {
      return place("cluster", surface.first_cluster + c) + " is not drawn";
    }
    if (is_drawn_[c] == 0) continue;
    if (surely_not(coarser)) return place("cluster", surface.first_cluster + c) + " is finer than allowed";
    if (!is_finest && surely_reached(own_of(cluster))) {
      return place("cluster", surface.first_cluster + c) + " is coarser than the resident pages allow";
    }
  }
  return {};
}

bool ResidentJudge::does_naive_rule_fail(const Residency& residency) {
  const MeshSurface& surface = judge_.surface;
  const auto is_open = [&](std::uint32_t k) {
    return weighed_[k].answer != Answer::kPasses && residency.has(group(k).page);
  };
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset_.clusters()[surface.first_cluster + c];
    is_drawn_[c] = is_open(cluster.coarser_group - surface.first_group) &&
                           (cluster.own_group == format::kNone || !is_open(own_of(cluster)))
                       ? 1
                       : 0;
  }
  return !find_coverage_fault(residency).empty();
}

void ResidentJudge::raise_weights(std::span<PageWeight> weights) const {
  std::vector<PageWeight> of_group(weighed_.size());
  for (const std::uint32_t k : judge_.group_order) {  // fine to coarse: what a finer group needs is handed on
    PageWeight& own = of_group[k];
    if (weighed_[k].answer == Answer::kFails) own.low = std::max(own.low, weighed_[k].low_px);
    if (weighed_[k].answer != Answer::kPasses) own.high = std::max({own.high, weighed_[k].high_px, kSmallest});
    for_each_coarser(k, [&](std::uint32_t coarser) {
      of_group[coarser].low = std::max(of_group[coarser].low, own.low);
      of_group[coarser].high = std::max(of_group[coarser].high, own.high);
    });
    PageWeight& page = weights[group(k).page];
    page.low = std::max(page.low, own.low);
    page.high = std::max(page.high, own.high);
  }
}

std::string ResidentJudge::find_unexplained(const Residency& residency, std::span<const run::ClusterInstance> items,
                                            std::span<const float> requested) {
  for (auto k = judge_.group_order.rbegin(); k != judge_.group_order.rend(); ++k) {  // coarse to fine
    const std::uint32_t page = group(*k).page;
    float least = residency.has(page) ? format::kInfiniteError : requested[page];
    for_each_coarser(*k, [&](std::uint32_t coarser) { least = std::min(least, least_requested_[coarser]); });
    least_requested_[*k] = least;
  }
  for (const run::ClusterInstance& item : items) {
    const format::ClusterRecord& cluster = asset_.clusters()[item.cluster.value];
    if (cluster.own_group == format::kNone) continue;
    const std::uint32_t own = own_of(cluster);
    if (weighed_[own].answer != Answer::kFails || !is_below(least_requested_[own], weighed_[own].low_px)) continue;
    return place("cluster", item.cluster.value) + differs(" shows an error in pixels", weighed_[own].low_px,
                                                          "a page in the way of a finer one is requested by",
                                                          double{least_requested_[own]});
  }
  return {};
}

std::string find_request_fault(const Residency& residency, std::span<const run::PageRequest> requests,
                               std::span<const PageWeight> weights) {
  std::vector<float> requested(weights.size());
  const run::PageRequest* last = nullptr;
  for (const run::PageRequest& request : requests) {
    if (request.page >= weights.size()) return place("page", request.page) + " is requested and does not exist";
    if (residency.has(request.page)) return place("page", request.page) + " is requested and resident";
    const bool is_behind = last == nullptr || request.priority < last->priority ||
                           (request.priority == last->priority && request.page > last->page);
    if (!is_behind || !(request.priority > 0.0F)) return place("page", request.page) + " is requested out of order";
    if (double{request.priority} > weights[request.page].high * (1.0 + kPrioritySlack)) {
      return place("page", request.page) + differs(" is requested by", double{request.priority},
                                                   "its largest error in pixels", weights[request.page].high);
    }
    requested[request.page] = request.priority;
    last = &request;
  }
  for (std::uint32_t page = 0; page < weights.size(); ++page) {
    if (residency.has(page) || !is_below(requested[page], weights[page].low)) continue;
    return place("page", page) +
           differs(" is requested by", double{requested[page]}, "its largest error in pixels", weights[page].low);
  }
  return {};
}

}  // namespace meshlode::judge
