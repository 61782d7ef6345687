// SPDX-License-Identifier: GPL-3.0-or-later
// Which wedges become one in a collapse: those that meet in a triangle on its edge. Seams part them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/group_locks.h"

namespace meshlode::builder {

/// The wedges at both ends of an edge, each with its class. A class is named by the place of its first wedge.
class WedgeClasses {
 public:
  static constexpr std::uint32_t kMost = 2 * Ring::kMost;

  void collect(const CollapseMesh& mesh, const GroupLocks& locks, const Ring& a, const Ring& b);
  /// The one class of two vertices with a single wedge each: as collect(), without a look at their triangles.
  void set_pair(const GroupLocks& locks, std::uint32_t x, std::uint32_t y);
  void clear() { count_ = 0; }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] std::uint32_t wedge(std::uint32_t i) const { return wedge_[i]; }
  /// The class of the i-th wedge: the least place that one of its class has.
  [[nodiscard]] std::uint32_t class_of(std::uint32_t i) const { return class_[i]; }
  [[nodiscard]] bool is_first(std::uint32_t i) const { return class_[i] == i; }
  /// The least wedge of the class that is locked, whose values rule, or kNoId. \pre is_first(of)
  [[nodiscard]] std::uint32_t fixed(std::uint32_t of) const { return fixed_[of]; }
  /// The one that stays. \pre is_first(of)
  [[nodiscard]] std::uint32_t keeper(std::uint32_t of) const { return fixed_[of] != kNoId ? fixed_[of] : wedge_[of]; }
  /// The place of the wedge, or count().
  [[nodiscard]] std::uint32_t find(std::uint32_t wedge) const {
    std::uint32_t i = 0;
    while (i < count_ && wedge_[i] != wedge) ++i;
    return i;
  }
  /// Whether the wedge takes on the values of a locked one.
  [[nodiscard]] bool joins_locked(std::uint32_t wedge) const {
    const std::uint32_t i = find(wedge);
    return i < count_ && fixed_[class_[i]] != kNoId;
  }

 private:
  std::uint32_t add(std::uint32_t wedge);
  void join(std::uint32_t i, std::uint32_t j);
  void find_fixed(const GroupLocks& locks);

  std::uint32_t count_ = 0;
  std::array<std::uint32_t, kMost> wedge_, class_, fixed_;
};

/// At the corners of the ring, all members of each class become its keeper.
void relabel_wedges(CollapseMesh& mesh, const Ring& ring, const WedgeClasses& classes);

/// Which vertices have a single wedge: most have, and then no triangle need be asked.
class OnlyWedges {
 public:
  explicit OnlyWedges(const CollapseMesh& mesh);

  /// kNoId: several.
  [[nodiscard]] std::uint32_t operator[](std::uint32_t vertex) const { return only_[vertex]; }
  [[nodiscard]] bool has_seams() const { return has_seams_; }
  /// What stands around the vertex has changed.
  void update(const CollapseMesh& mesh, std::uint32_t vertex);

 private:
  std::vector<std::uint32_t> only_;
  bool has_seams_ = false;  ///< at the start
};

}  // namespace meshlode::builder
