// SPDX-License-Identifier: GPL-3.0-or-later
// Whether corners that another group shades too keep their attributes.
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode::build {

/// I3 for attributes. A triangle (locked, moved, c) with c locked goes; the triangle across (moved, c) inherits the edge
/// (locked, c), which may lie on the group's border. If another group shades that edge with the same wedges, the heir
/// must bring them: (moved, c) may not be a crease. And no border edge gets a corner with attributes that nothing had
/// there.
template <std::size_t C>
bool GroupSimplifier<C>::keeps_shared_corners(const StarEnd& locked, const StarEnd& moved) const {
  if (attribute_count_ == 0) return true;
  const auto corner_in = [&](std::uint32_t t, std::uint32_t vertex) {
    for (std::uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      if (mesh_.vertex(corner) == vertex) return corner;
    }
    return CollapseMesh::kEnd;
  };
  const auto joins_locked_wedge = [&](std::uint32_t wedge) {
    return std::any_of(classes_.begin(), classes_.begin() + static_cast<std::ptrdiff_t>(class_count_), [&](const WedgeClass& c) {
      return c.fixed != kSeveralWedges && std::find(c.members.begin(), c.members.end(), wedge) != c.members.end();
    });
  };
  const auto is_newcomer = [&](std::uint32_t corner) {
    return is_locked_[mesh_.vertex(corner)] != 0 && is_wedge_locked_[mesh_.wedge(corner)] == 0;
  };
  for (const std::uint32_t corner : moved.corners) {
    const std::uint32_t t = corner / 3;
    const std::uint32_t at_locked = corner_in(t, locked.vertex);
    if (at_locked == CollapseMesh::kEnd) {
      // The triangle will stand on the locked vertex. If it has another locked one, their edge may be the border.
      const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
      const bool may_be_border = is_locked_[mesh_.vertex(next)] != 0 ||
                                 is_locked_[mesh_.vertex(CollapseMesh::next_in_triangle(next))] != 0;
      if (may_be_border && !joins_locked_wedge(mesh_.wedge(corner))) return false;
      // Nor may the other end bring attributes that came to it with a vertex that was joined into it.
      if (is_newcomer(next) || is_newcomer(CollapseMesh::next_in_triangle(next))) return false;
      continue;
    }
    const std::uint32_t at_tip = 3 * t + (3 - corner % 3 - at_locked % 3);
    if (is_locked_[mesh_.vertex(at_tip)] == 0) continue;
    const bool is_locked_shared = input_.is_wedge_shared[mesh_.wedge(at_locked)] != 0;
    const bool is_tip_shared = input_.is_wedge_shared[mesh_.wedge(at_tip)] != 0;
    if (!is_locked_shared && !is_tip_shared) continue;
    for (const std::uint32_t other : moved.corners) {
      const std::uint32_t heir = other / 3;
      if (heir == t || corner_in(heir, locked.vertex) != CollapseMesh::kEnd) continue;
      const std::uint32_t heir_tip = corner_in(heir, mesh_.vertex(at_tip));
      if (heir_tip == CollapseMesh::kEnd) continue;
      if (is_locked_shared && mesh_.wedge(other) != mesh_.wedge(corner)) return false;
      if (is_tip_shared && mesh_.wedge(heir_tip) != mesh_.wedge(at_tip)) return false;
    }
  }
  return true;
}

}  // namespace meshlode::build
