// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/guards.h"

#include <algorithm>
#include <array>

namespace meshlode::builder {

namespace {

constexpr double kFlipCosine = 0.2;  ///< of 78 degrees

/// How often a triangle runs from its vertex `tip` to its vertex `to`: 1, or -1 for the other way, 0 where it does not.
int count_uses(const CollapseMesh& mesh, std::uint32_t triangle, std::uint32_t tip, std::uint32_t to) {
  int sum = 0;
  for (std::uint32_t corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
    const std::uint32_t from = mesh.vertex(corner), next = mesh.vertex(CollapseMesh::next_in_triangle(corner));
    sum += from == tip && next == to ? 1 : from == to && next == tip ? -1 : 0;
  }
  return sum;
}

bool keeps_edge_to(const CollapseMesh& mesh, std::uint32_t tip, const StarEnd& locked, const StarEnd& moved) {
  int lost = 0, inherited = 0;
  bool is_covered = false;  // by a triangle that goes
  for (const std::uint32_t corner : moved.corners) {
    const int going = count_uses(mesh, corner / 3, tip, locked.vertex);
    lost += going;
    is_covered |= going != 0;
    if (going == 0) inherited += count_uses(mesh, corner / 3, tip, moved.vertex);
  }
  if (is_covered) return lost == inherited;
  if (inherited == 0) return true;
  int kept = 0;
  for (const std::uint32_t corner : locked.corners) kept += count_uses(mesh, corner / 3, tip, locked.vertex);
  return kept == 0 || (kept > 0) == (inherited > 0);
}

/// What keeps_edge_to() counts, of one tip.
struct EdgeUsesOfTip {
  std::uint32_t tip = 0;
  int lost = 0, inherited = 0, kept = 0;
  bool is_covered = false;
};

/// Of every locked tip around the star, by tip: one search of the star instead of one for each tip.
std::vector<EdgeUsesOfTip> count_uses_by_tip(const CollapseMesh& mesh, const GroupLocks& locks, const StarEnd& locked,
                                             const StarEnd& moved) {
  std::vector<EdgeUsesOfTip> uses;
  const auto for_tips = [&](const StarEnd& end, const StarEnd& other, const auto& count) {
    for (const std::uint32_t corner : end.corners) {
      const auto [x, y] = mesh.others(corner);
      for (const std::uint32_t tip : {x, y}) {
        if (tip != other.vertex && locks.is_vertex_locked[tip] != 0) uses.push_back(count(corner / 3, tip));
        if (x == y) break;
      }
    }
  };
  for_tips(moved, locked, [&](std::uint32_t triangle, std::uint32_t tip) {
    const int going = count_uses(mesh, triangle, tip, locked.vertex);
    const int inherited = going == 0 ? count_uses(mesh, triangle, tip, moved.vertex) : 0;
    return EdgeUsesOfTip{tip, going, inherited, 0, going != 0};
  });
  for_tips(locked, moved, [&](std::uint32_t triangle, std::uint32_t tip) {
    return EdgeUsesOfTip{tip, 0, 0, count_uses(mesh, triangle, tip, locked.vertex), false};
  });
  std::sort(uses.begin(), uses.end(), [](const EdgeUsesOfTip& a, const EdgeUsesOfTip& b) { return a.tip < b.tip; });
  return uses;
}

bool keeps_shared_edges_of_hub(const CollapseMesh& mesh, const GroupLocks& locks, const StarEnd& locked,
                               const StarEnd& moved) {
  const std::vector<EdgeUsesOfTip> uses = count_uses_by_tip(mesh, locks, locked, moved);
  for (std::size_t i = 0; i < uses.size();) {
    EdgeUsesOfTip sum{uses[i].tip};
    for (; i < uses.size() && uses[i].tip == sum.tip; ++i) {
      sum.lost += uses[i].lost;
      sum.inherited += uses[i].inherited;
      sum.kept += uses[i].kept;
      sum.is_covered |= uses[i].is_covered;
    }
    if (sum.is_covered ? sum.lost != sum.inherited
                       : sum.inherited != 0 && sum.kept != 0 && (sum.kept > 0) != (sum.inherited > 0)) {
      return false;
    }
  }
  return true;
}

/// For both ends of the edge, with the locked one first.
bool keeps_shared_edges_of(const CollapseMesh& mesh, const GroupLocks& locks, const StarEnd& locked,
                           const StarEnd& moved) {
  constexpr std::size_t kHub = 64;  // so many corners are looked at for each tip
  if (moved.corners.size() > kHub) return keeps_shared_edges_of_hub(mesh, locks, locked, moved);
  for (const std::uint32_t corner : moved.corners) {
    for (const std::uint32_t tip : mesh.others(corner)) {
      if (tip == locked.vertex || locks.is_vertex_locked[tip] == 0) continue;
      if (!keeps_edge_to(mesh, tip, locked, moved)) return false;
    }
  }
  return true;
}

std::uint32_t corner_in(const CollapseMesh& mesh, std::uint32_t triangle, std::uint32_t vertex) {
  for (std::uint32_t corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
    if (mesh.vertex(corner) == vertex) return corner;
  }
  return CollapseMesh::kEnd;
}

/// A triangle that will stand on the locked vertex, with its corner at the moved one.
bool stands_well(const CollapseMesh& mesh, const GroupLocks& locks, const WedgeClasses& classes, std::uint32_t corner) {
  const auto is_locked = [&](std::uint32_t c) { return locks.is_vertex_locked[mesh.vertex(c)] != 0; };
  const auto is_newcomer = [&](std::uint32_t c) { return is_locked(c) && locks.is_wedge_locked[mesh.wedge(c)] == 0; };
  const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
  const std::uint32_t previous = CollapseMesh::next_in_triangle(next);
  // If it has another locked one, their edge may be the border.
  const bool may_be_border = is_locked(next) || is_locked(previous);
  if (may_be_border && !classes.joins_locked(mesh.wedge(corner))) return false;
  // Nor may the other end bring attributes that came to it with a vertex that was joined into it.
  return !is_newcomer(next) && !is_newcomer(previous);
}

/// A triangle that goes, by its corners at the moved vertex and at the locked one.
bool have_heirs_its_wedges(const CollapseMesh& mesh, const GroupLocks& locks, const StarEnd& moved,
                           std::uint32_t corner, std::uint32_t at_locked) {
  const std::uint32_t t = corner / 3;
  const std::uint32_t at_tip = 3 * t + (3 - corner % 3 - at_locked % 3);
  if (locks.is_vertex_locked[mesh.vertex(at_tip)] == 0) return true;
  const bool is_locked_shared = locks.is_wedge_shared[mesh.wedge(at_locked)] != 0;
  const bool is_tip_shared = locks.is_wedge_shared[mesh.wedge(at_tip)] != 0;
  if (!is_locked_shared && !is_tip_shared) return true;
  for (const std::uint32_t other : moved.corners) {
    const std::uint32_t heir = other / 3;
    if (heir == t || corner_in(mesh, heir, mesh.vertex(at_locked)) != CollapseMesh::kEnd) continue;
    const std::uint32_t heir_tip = corner_in(mesh, heir, mesh.vertex(at_tip));
    if (heir_tip == CollapseMesh::kEnd) continue;
    if (is_locked_shared && mesh.wedge(other) != mesh.wedge(corner)) return false;
    if (is_tip_shared && mesh.wedge(heir_tip) != mesh.wedge(at_tip)) return false;
  }
  return true;
}

/// What two vertices have beside them both; more than three are not told.
struct CommonNeighbors {
  std::array<std::uint32_t, 3> vertex{};
  std::uint32_t count = 0;
  bool are_too_many = false;

  [[nodiscard]] bool has(std::uint32_t v) const {
    const auto end = vertex.begin() + count;
    return std::find(vertex.begin(), end, v) != end;
  }
};

/// The neighbours of one end are those that are marked.
CommonNeighbors common_neighbors(const VertexMarks& marks, const StarEnd& other, std::uint32_t most) {
  CommonNeighbors common;
  for (const std::uint32_t v : other.neighbors) {
    if (!marks.is_marked(v)) continue;
    if (common.count == most || common.count == common.vertex.size()) {
      common.are_too_many = true;
      return common;
    }
    common.vertex[common.count++] = v;
  }
  return common;
}

bool turns_over_at(const CollapseMesh& mesh, const GroupPlaces& places, const StarEnd& moved, std::uint32_t other,
                   const Vec3d& target) {
  for (const std::uint32_t corner : moved.corners) {
    const auto [x, y] = mesh.others(corner);
    if (x == other || y == other) continue;
    const Vec3d edge = places[y] - places[x];
    const Vec3d before = glm::cross(edge, places[moved.vertex] - places[x]);
    const Vec3d after = glm::cross(edge, target - places[x]);
    const double before2 = glm::dot(before, before);
    const double after2 = glm::dot(after, after);
    if (!(before2 > 0.0)) continue;
    const double dot = glm::dot(before, after);
    if (!(dot > 0.0) || dot * dot < kFlipCosine * kFlipCosine * before2 * after2) return true;
  }
  return false;
}

}  // namespace

bool keeps_shared_edges(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star) {
  const auto is_kept = [&](const StarEnd& locked, const StarEnd& moved) {
    return locks.is_vertex_locked[locked.vertex] == 0 || keeps_shared_edges_of(mesh, locks, locked, moved);
  };
  return is_kept(star.a, star.b) && is_kept(star.b, star.a);
}

bool falls_together(const CollapseMesh& mesh, const GroupLocks& locks, const GroupPlaces& places,
                    const CollapseStar& star) {
  const std::uint32_t a = star.a.vertex, b = star.b.vertex;
  const bool is_end_locked = locks.is_vertex_locked[a] != 0 || locks.is_vertex_locked[b] != 0;
  const auto is_there = [&](std::uint32_t vertex) {
    return vertex != a && vertex != b && (is_end_locked || locks.is_vertex_locked[vertex] != 0) &&
           places[vertex] == star.target;
  };
  const auto has_one = [&](const StarEnd& end) {
    return std::any_of(end.corners.begin(), end.corners.end(), [&](std::uint32_t corner) {
      const auto [x, y] = mesh.others(corner);
      return is_there(x) || is_there(y);
    });
  };
  return has_one(star.a) || has_one(star.b);
}

bool keeps_shared_corners(const CollapseMesh& mesh, const GroupLocks& locks, const WedgeClasses& classes,
                          const CollapseStar& star) {
  const auto is_kept = [&](const StarEnd& locked, const StarEnd& moved) {
    if (locks.is_vertex_locked[locked.vertex] == 0) return true;
    return std::all_of(moved.corners.begin(), moved.corners.end(), [&](std::uint32_t corner) {
      const std::uint32_t at_locked = corner_in(mesh, corner / 3, locked.vertex);
      return at_locked == CollapseMesh::kEnd ? stands_well(mesh, locks, classes, corner)
                                             : have_heirs_its_wedges(mesh, locks, moved, corner, at_locked);
    });
  };
  return is_kept(star.a, star.b) && is_kept(star.b, star.a);
}

bool keeps_topology(const CollapseMesh& mesh, const std::vector<std::uint8_t>& is_border, VertexMarks& marks,
                    CollapseStar& star) {
  const std::uint32_t b = star.b.vertex;
  std::uint32_t shared = 0;
  for (const std::uint32_t corner : star.a.corners) {
    const auto [x, y] = mesh.others(corner);
    shared += x == b || y == b ? 1 : 0;
  }
  if (shared >= 2 && is_border[star.a.vertex] != 0 && is_border[b] != 0) return false;
  if (shared == 0) return false;
  gather_neighbors(mesh, marks, star.a);
  gather_neighbors(mesh, marks, star.b);
  const CommonNeighbors common = common_neighbors(marks, star.a, shared);
  if (common.are_too_many || common.count != shared) return false;
  if (common.count < 2) return true;
  // (a, c, d) and (b, c, d) would lie on each other.
  const auto has_tip_edge = [&](const StarEnd& end) {
    return std::any_of(end.corners.begin(), end.corners.end(), [&](std::uint32_t corner) {
      const auto [x, y] = mesh.others(corner);
      return common.has(x) && common.has(y);
    });
  };
  return !(has_tip_edge(star.a) && has_tip_edge(star.b));
}

bool turns_over(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star) {
  return turns_over_at(mesh, places, star.a, star.b.vertex, star.target) ||
         turns_over_at(mesh, places, star.b, star.a.vertex, star.target);
}

}  // namespace meshlode::builder
