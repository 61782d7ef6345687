// SPDX-License-Identifier: MIT
// Selection where only some pages are there: the frontier rule, and which pages a view wants.
//
// A group is *reached* iff it does not pass, its page is resident, and every group is reached that holds a cluster made
// from it. A cluster is drawn iff its coarser group is reached and its own is not. A reached group has all coarser ones
// reached, so that on any path from level 0 to a root the answers read no … no yes … yes: what is drawn covers each
// path exactly once where the root's page is there, and not at all elsewhere. With all pages resident, reached is "does
// not pass", and the cut is that of select.h. docs/reference/selection.md, "What is resident".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "run/select/open_groups.h"
#include "run/select/select.h"

namespace meshlode::run {

struct PageRequest {
  std::uint32_t page;
  float priority;  ///< see ResidentSelector::page_priorities()
  constexpr auto operator<=>(const PageRequest&) const = default;
};

struct ResidentQuery {
  Camera camera;
  double pixel_error = 1.0;
  std::span<const std::uint32_t> resident;  ///< page p: bit p % 32 of word p / 32; pages behind its end are not there
  const Frustum* frustum = nullptr;         ///< null: nothing is culled
};

/// The links of the DAG that the rule needs, and the memory of a search. One per thread.
class ResidentSelector {
 public:
  /// Takes all memory that select() needs.
  explicit ResidentSelector(const SelectTables& tables);

  /// Writes what is drawn, ascending, as far as `items` has room. Less what has its culling sphere outside the frustum.
  /// Allocates nothing.
  /// \param tables  meshes, groups, clusters and nodes as they were given to the constructor, but for their errors;
  ///                instances may be others
  /// \return the number of items of the cut
  [[nodiscard]] std::size_t select(const SelectTables& tables, const ResidentQuery& query,
                                   std::span<ClusterInstance> items);

  /// Of the last query, per page: how much is lost without it. The largest projected error, in pixels, of its groups
  /// that do not pass and have a member, or a cluster made from them, inside the frustum; and of the groups finer than
  /// those. 0 if there is none, else between 2^-126 and 2^126. Of a page with a terminal group of a mesh that is drawn,
  /// wherever it is, kInfiniteError.
  [[nodiscard]] std::span<const float> page_priorities() const { return page_priorities_; }
  /// The pages with a priority that are not resident, by falling priority, then ascending. So pages come behind those
  /// that they are of no use without.
  [[nodiscard]] std::span<const PageRequest> requests() const { return requests_; }

 private:
  enum State : std::uint8_t { kOpen = 1, kReached = 2, kWanted = 4 };
  [[nodiscard]] bool has(std::uint32_t group, State state) const { return (states_[group] & state) != 0; }
  template <class IsResident>
  void mark_groups(const SelectTables& tables, const InstanceView& view, const IsResident& is_resident);
  void rank_pages(const SelectTables& tables, const InstanceView& view, double pixel_error);
  void mark_roots(std::uint32_t mesh);
  [[nodiscard]] std::span<const std::uint32_t> coarser_than(std::uint32_t group) const {
    return std::span(coarser_).subspan(first_coarser_[group], first_coarser_[group + 1] - first_coarser_[group]);
  }

  // Of group g: the groups that hold a cluster made from it, coarser_[first_coarser_[g]] up to first_coarser_[g + 1].
  std::vector<std::uint32_t> first_coarser_, coarser_;
  // Of mesh m: the pages of its terminal groups, the same way.
  std::vector<std::uint32_t> first_root_, root_pages_;
  std::vector<std::uint8_t> is_mesh_drawn_;  // per mesh
  std::vector<std::uint8_t> states_;         // per group, bits of State; all 0 between instances
  std::vector<float> priorities_;            // per group; all 0 between instances
  std::vector<float> page_priorities_;
  std::vector<PageRequest> requests_;
  OpenGroups open_;
};

}  // namespace meshlode::run
