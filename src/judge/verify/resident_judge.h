// SPDX-License-Identifier: GPL-3.0-or-later
// One instance seen by one camera with some pages resident: what may be drawn and what has to be requested, from the
// asset's tables and the rule in double precision alone. Shares nothing with the selection. Internal to the judge.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "judge/verify/cuts.h"
#include "judge/verify/judged_view.h"
#include "run/select/resident.h"

namespace meshlode::judge {

struct Residency {
  std::vector<std::uint32_t> words;  ///< as ResidentQuery::resident
  explicit Residency(std::size_t page_count) : words((page_count + 31) / 32) {}
  [[nodiscard]] bool has(std::uint32_t page) const { return (words[page / 32] >> page % 32 & 1U) != 0; }
  void add(std::uint32_t page) { words[page / 32] |= 1U << page % 32; }
};

/// Between these lies the priority of a page, in pixels. Nobody asks for the page where `high` is 0.
struct PageWeight {
  double low = 0.0, high = 0.0;
};

class ResidentJudge {
 public:
  /// \pre the arguments outlive this; the instance is drawable and `judge` is its mesh's
  ResidentJudge(const run::Asset& asset, const MeshJudge& judge, const format::InstanceRecord& instance,
                const JudgedView& view);

  /// What is wrong with a cut that is not culled, in words; empty where nothing is. Each drawn cluster's page is
  /// resident; each path from level 0 to a root whose page is resident has one drawn cluster, and each other path none;
  /// and the cut is neither coarser nor finer than the pages and the allowed error make it.
  [[nodiscard]] std::string find_fault(const Residency& residency, std::span<const run::ClusterInstance> items);
  /// Of the same cut: an edge that it leaves open and the source does not.
  [[nodiscard]] std::string find_border_fault() const { return judge::find_border_fault(judge_, is_drawn_); }
  /// Is a path not covered once by the rule that looks at each group's own page alone?
  [[nodiscard]] bool does_naive_rule_fail(const Residency& residency);

  /// Per page: raised to what this instance makes it.
  void raise_weights(std::span<PageWeight> weights) const;
  /// The drawn clusters of `items`, culled or not, that could be finer: each missing page that stands in the way is
  /// requested, by at least the error that the cluster shows. \param requested  priority per page, 0 where there is
  /// none
  [[nodiscard]] std::string find_unexplained(const Residency& residency, std::span<const run::ClusterInstance> items,
                                             std::span<const float> requested);

 private:
  [[nodiscard]] const format::GroupRecord& group(std::uint32_t k) const {
    return asset_.groups()[judge_.surface.first_group + k];
  }
  [[nodiscard]] std::uint32_t own_of(const format::ClusterRecord& cluster) const {
    return cluster.own_group - judge_.surface.first_group;
  }
  [[nodiscard]] std::string find_coverage_fault(const Residency& residency) const;
  void find_blocked(const Residency& residency);
  template <class Visit>
  void for_each_coarser(std::uint32_t k, const Visit& visit) const;

  const run::Asset& asset_;
  const MeshJudge& judge_;
  std::vector<WeighedGroup> weighed_;     ///< per group of the mesh, as all that follows of groups
  std::vector<std::uint8_t> is_blocked_;  ///< its page or that of a group above is missing
  std::vector<std::uint8_t> is_drawn_;    ///< per cluster of the mesh
  std::vector<float> least_requested_;    ///< of the missing pages of a group and of those above
};

/// What is wrong with the requests of a query that nothing is culled by; empty where nothing is: they fall, are of
/// pages that are missing, and have just the pages that somebody wants, each by its largest error.
[[nodiscard]] std::string find_request_fault(const Residency& residency, std::span<const run::PageRequest> requests,
                                             std::span<const PageWeight> weights);

}  // namespace meshlode::judge
