// SPDX-License-Identifier: GPL-3.0-or-later
// Which collapses are refused: those that would break a shared border, the topology, or turn a triangle over.
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode::build {

/// I6. An edge between two locked vertices may be one that another group's triangle leans on, so that its uses here stay
/// what they are. A triangle (locked, moved, tip) goes with the collapse of its edge to `locked`: where its tip is locked
/// too, the triangles across (moved, tip) must inherit the edge (locked, tip). On an open border there may be none: such an
/// ear stays. And an open edge (moved, tip) that comes to lie on (locked, tip) may not close that one's border.
/// `around` are the corners at the moved vertex, `at_locked` those at the locked one.
template <std::size_t C>
bool GroupSimplifier<C>::keeps_shared_edges(std::uint32_t locked, const std::vector<std::uint32_t>& at_locked,
                                            const std::vector<std::uint32_t>& around) const {
  // How often a triangle runs from its vertex `tip` to its vertex `to`: 1, or -1 for the other way, 0 where it does not.
  const auto uses = [&](std::uint32_t t, std::uint32_t tip, std::uint32_t to) {
    int sum = 0;
    for (std::uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      const std::uint32_t from = mesh_.vertex(corner), next = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
      sum += from == tip && next == to ? 1 : from == to && next == tip ? -1 : 0;
    }
    return sum;
  };
  const auto keeps_edge_to = [&](std::uint32_t tip, std::uint32_t moved) {
    int lost = 0, inherited = 0;
    bool is_covered = false;  // by a triangle that goes
    for (const std::uint32_t corner : around) {
      const int going = uses(corner / 3, tip, locked);
      lost += going;
      is_covered |= going != 0;
      if (going == 0) inherited += uses(corner / 3, tip, moved);
    }
    if (is_covered) return lost == inherited;
    if (inherited == 0) return true;
    int kept = 0;
    for (const std::uint32_t corner : at_locked) kept += uses(corner / 3, tip, locked);
    return kept == 0 || (kept > 0) == (inherited > 0);
  };
  for (const std::uint32_t corner : around) {
    const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
    for (const std::uint32_t tip : {mesh_.vertex(next), mesh_.vertex(CollapseMesh::next_in_triangle(next))}) {
      if (tip != locked && is_locked_[tip] != 0 && !keeps_edge_to(tip, mesh_.vertex(corner))) return false;
    }
  }
  return true;
}

/// I3 for attributes. A triangle (locked, moved, c) with c locked goes; the triangle across (moved, c) inherits the edge
/// (locked, c), which may lie on the group's border. If another group shades that edge with the same wedges, the heir
/// must bring them: (moved, c) may not be a crease. And no border edge gets a corner with attributes that nothing had
/// there. `around` are the corners at the moved vertex.
template <std::size_t C>
bool GroupSimplifier<C>::keeps_shared_corners(std::uint32_t locked,
                                              const std::vector<std::uint32_t>& around) const {
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
  for (const std::uint32_t corner : around) {
    const std::uint32_t t = corner / 3;
    const std::uint32_t at_locked = corner_in(t, locked);
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
    for (const std::uint32_t other : around) {
      const std::uint32_t heir = other / 3;
      if (heir == t || corner_in(heir, locked) != CollapseMesh::kEnd) continue;
      const std::uint32_t heir_tip = corner_in(heir, mesh_.vertex(at_tip));
      if (heir_tip == CollapseMesh::kEnd) continue;
      if (is_locked_shared && mesh_.wedge(other) != mesh_.wedge(corner)) return false;
      if (is_tip_shared && mesh_.wedge(heir_tip) != mesh_.wedge(at_tip)) return false;
    }
  }
  return true;
}

/// The link condition (Dey et al. 1999): common neighbours are exactly the tips of the triangles on the edge, no two
/// triangles become one, and two border vertices join along the border only.
template <std::size_t C>
bool GroupSimplifier<C>::keeps_topology(std::uint32_t a, std::uint32_t b) {
  neighbors_a_.clear();
  neighbors_b_.clear();
  std::uint32_t shared = 0;
  for (const std::uint32_t corner : corners_a_) {
    const std::uint32_t x = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
    const std::uint32_t y = mesh_.vertex(CollapseMesh::next_in_triangle(CollapseMesh::next_in_triangle(corner)));
    shared += x == b || y == b ? 1 : 0;
    neighbors_a_.push_back(x);
    neighbors_a_.push_back(y);
  }
  for (const std::uint32_t corner : corners_b_) {
    neighbors_b_.push_back(mesh_.vertex(CollapseMesh::next_in_triangle(corner)));
    neighbors_b_.push_back(mesh_.vertex(CollapseMesh::next_in_triangle(CollapseMesh::next_in_triangle(corner))));
  }
  if (shared >= 2 && is_border_[a] != 0 && is_border_[b] != 0) return false;
  if (shared == 0) return false;
  std::vector<std::uint32_t>& na = neighbors_a_;
  std::vector<std::uint32_t>& nb = neighbors_b_;
  std::sort(na.begin(), na.end());
  na.erase(std::unique(na.begin(), na.end()), na.end());
  std::sort(nb.begin(), nb.end());
  nb.erase(std::unique(nb.begin(), nb.end()), nb.end());
  std::uint32_t common[3];
  std::uint32_t common_count = 0;
  for (std::size_t i = 0, j = 0; i < na.size() && j < nb.size();) {
    if (na[i] == nb[j]) {
      if (common_count == shared || common_count == 3) return false;
      common[common_count++] = na[i];
      ++i;
      ++j;
    } else if (na[i] < nb[j]) {
      ++i;
    } else {
      ++j;
    }
  }
  if (common_count != shared) return false;
  if (common_count < 2) return true;
  // (a, c, d) and (b, c, d) would lie on each other.
  const auto has_tip_edge = [&](const std::vector<std::uint32_t>& corners) {
    for (const std::uint32_t corner : corners) {
      const std::uint32_t x = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
      const std::uint32_t y = mesh_.vertex(CollapseMesh::next_in_triangle(CollapseMesh::next_in_triangle(corner)));
      if (std::find(common, common + common_count, x) != common + common_count &&
          std::find(common, common + common_count, y) != common + common_count) {
        return true;
      }
    }
    return false;
  };
  return !(has_tip_edge(corners_a_) && has_tip_edge(corners_b_));
}

template <std::size_t C>
bool GroupSimplifier<C>::turns_over(std::uint32_t moved, std::uint32_t other, const std::vector<std::uint32_t>& corners,
                                    const Vec3d& target) const {
  for (const std::uint32_t corner : corners) {
    const std::uint32_t x = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
    const std::uint32_t y = mesh_.vertex(CollapseMesh::next_in_triangle(CollapseMesh::next_in_triangle(corner)));
    if (x == other || y == other) continue;
    const Vec3d edge = position_[y] - position_[x];
    const Vec3d before = glm::cross(edge, position_[moved] - position_[x]);
    const Vec3d after = glm::cross(edge, target - position_[x]);
    const double before2 = glm::dot(before, before);
    const double after2 = glm::dot(after, after);
    if (!(before2 > 0.0)) continue;  // had no area: any change is for the better
    const double dot = glm::dot(before, after);
    if (!(dot > 0.0) || dot * dot < kFlipCosine * kFlipCosine * before2 * after2) return true;
  }
  return false;
}

}  // namespace meshlode::build
