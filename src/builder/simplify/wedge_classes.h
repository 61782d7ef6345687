// SPDX-License-Identifier: GPL-3.0-or-later
// Which wedges become one in a collapse: those that meet in a triangle on its edge. Seams part them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_locks.h"

namespace meshlode::builder {

/// Wedges that become one attribute value.
struct WedgeClass {
  std::vector<std::uint32_t> members;  ///< ascending
  std::uint32_t fixed = kNoId;         ///< the first locked one, whose values rule, if any

  /// The one that stays.
  [[nodiscard]] std::uint32_t keeper() const { return fixed != kNoId ? fixed : members[0]; }
};

/// The one class of two vertices with a single wedge each.
struct WedgePair {
  std::uint32_t least, greatest;
  std::uint32_t fixed;  ///< as WedgeClass::fixed
};

/// Knows of each vertex whether it has a single wedge: most have, and then no triangle need be asked.
class WedgeClasses {
 public:
  /// Without wedges (of a mesh without attributes) there are no classes. \pre `start` is called
  WedgeClasses(std::size_t wedge_count, std::size_t vertex_count);

  /// Before the first collapse.
  void start(const CollapseMesh& mesh);
  /// What stands around the vertex has changed. \pre its corners are gathered
  void update(const CollapseMesh& mesh, const StarEnd& end);

  /// Whether `collect` reads the corners of a star between these two.
  [[nodiscard]] bool needs_corners(std::uint32_t a, std::uint32_t b) const {
    return !class_of_.empty() && (only_wedge_[a] == kSeveral || only_wedge_[b] == kSeveral);
  }
  /// \pre there are wedges, and !needs_corners(a, b)
  [[nodiscard]] WedgePair pair_of(const GroupLocks& locks, std::uint32_t a, std::uint32_t b) const {
    const auto [least, greatest] = std::minmax(only_wedge_[a], only_wedge_[b]);
    const std::uint32_t locked = locks.is_wedge_locked[greatest] != 0 ? greatest : kNoId;
    return {least, greatest, locks.is_wedge_locked[least] != 0 ? least : locked};
  }
  /// The classes of a collapse.
  void collect(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star);

  /// Of the collapse collected last.
  [[nodiscard]] std::span<const WedgeClass> classes() const { return {classes_.data(), count_}; }
  /// Whether the wedge takes on the values of a locked one.
  [[nodiscard]] bool joins_locked(std::uint32_t wedge) const;

 private:
  static constexpr std::uint32_t kSeveral = 0xFFFFFFFFU;

  WedgeClass& add_class();
  std::uint32_t find_class(std::uint32_t wedge);
  void join_along_edge(const CollapseMesh& mesh, const CollapseStar& star);
  void join(std::uint32_t i, std::uint32_t j);

  std::vector<std::uint32_t> only_wedge_;  ///< per vertex, or kSeveral
  std::vector<WedgeClass> classes_;        ///< count_ of them; those behind keep their memory
  std::size_t count_ = 0;
  std::uint64_t stamp_ = 0;  ///< what is marked with it was marked in this search
  std::vector<std::uint64_t> wedge_stamp_;
  std::vector<std::uint32_t> class_of_;  ///< per wedge, where its stamp is the search's
};

/// In the star, all members of the class become its keeper.
void relabel_wedges(CollapseMesh& mesh, const CollapseStar& star, const WedgeClass& joined);

}  // namespace meshlode::builder
