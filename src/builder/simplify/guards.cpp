// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/guards.h"

#include <algorithm>

namespace meshlode::builder {

namespace {

constexpr float kFlipCosine = 0.2F;  ///< of 78 degrees

/// How often the corner's triangle runs from `tip` to the corner's vertex: 1, or -1 for the other way, 0 where it has
/// no such edge.
int count_uses(const CollapseMesh& mesh, std::uint32_t corner, std::uint32_t tip) {
  const auto [next, previous] = mesh.others(corner);
  return (previous == tip ? 1 : 0) - (next == tip ? 1 : 0);
}

bool keeps_edge_to(const CollapseMesh& mesh, std::uint32_t tip, const Ring& locked, const Ring& moved) {
  int lost = 0, inherited = 0;
  bool is_covered = false;  // by a triangle that goes
  for (const std::uint32_t corner : moved.corners()) {
    const int uses = count_uses(mesh, corner, tip);
    if (!mesh.has(corner / 3, locked.vertex)) {
      inherited += uses;
    } else if (uses != 0) {  // with (tip, moved) it has (locked, tip)
      lost -= uses;
      is_covered = true;
    }
  }
  if (is_covered) return lost == inherited;
  if (inherited == 0) return true;
  int kept = 0;
  for (const std::uint32_t corner : locked.corners()) kept += count_uses(mesh, corner, tip);
  return kept == 0 || (kept > 0) == (inherited > 0);
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

/// A triangle that goes, by its corner at the moved vertex.
bool have_heirs_its_wedges(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star,
                           std::uint32_t corner) {
  const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
  const std::uint32_t previous = CollapseMesh::next_in_triangle(next);
  const bool is_next_locked = mesh.vertex(next) == star.a.vertex;
  const std::uint32_t at_locked = is_next_locked ? next : previous, at_tip = is_next_locked ? previous : next;
  const std::uint32_t tip = mesh.vertex(at_tip);
  if (locks.is_vertex_locked[tip] == 0) return true;
  const bool is_locked_shared = locks.is_wedge_shared[mesh.wedge(at_locked)] != 0;
  const bool is_tip_shared = locks.is_wedge_shared[mesh.wedge(at_tip)] != 0;
  if (!is_locked_shared && !is_tip_shared) return true;
  for (const std::uint32_t other : star.b.corners()) {
    if (mesh.has(other / 3, star.a.vertex) || !mesh.has(other / 3, tip)) continue;
    const std::uint32_t beside = CollapseMesh::next_in_triangle(other);
    const std::uint32_t heir_tip = mesh.vertex(beside) == tip ? beside : CollapseMesh::next_in_triangle(beside);
    if (is_locked_shared && mesh.wedge(other) != mesh.wedge(corner)) return false;
    if (is_tip_shared && mesh.wedge(heir_tip) != mesh.wedge(at_tip)) return false;
  }
  return true;
}

}  // namespace

bool keeps_shared_edges(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star) {
  if (locks.is_vertex_locked[star.a.vertex] == 0) return true;
  return std::all_of(star.b.corners().begin(), star.b.corners().end(), [&](std::uint32_t corner) {
    const auto [x, y] = mesh.others(corner);
    const auto is_kept = [&](std::uint32_t tip) {
      return tip == star.a.vertex || locks.is_vertex_locked[tip] == 0 || keeps_edge_to(mesh, tip, star.a, star.b);
    };
    return is_kept(x) && is_kept(y);
  });
}

bool falls_together(const GroupLocks& locks, const GroupPlaces& places, const CollapseStar& star) {
  const bool is_end_locked = locks.is_vertex_locked[star.a.vertex] != 0;
  const auto is_there = [&](std::uint32_t vertex) {
    return places[vertex] == star.target && (is_end_locked || locks.is_vertex_locked[vertex] != 0);
  };
  return std::any_of(star.tips.begin(), star.tips.begin() + star.on_edge, is_there) ||
         std::any_of(star.outer().begin(), star.outer().end(),
                     [&](const CollapseStar::OuterEdge& edge) { return is_there(edge.x) || is_there(edge.y); });
}

bool keeps_shared_corners(const CollapseMesh& mesh, const GroupLocks& locks, const WedgeClasses& classes,
                          const CollapseStar& star) {
  if (locks.is_vertex_locked[star.a.vertex] == 0) return true;
  return std::all_of(star.b.corners().begin(), star.b.corners().end(), [&](std::uint32_t corner) {
    return mesh.has(corner / 3, star.a.vertex) ? have_heirs_its_wedges(mesh, locks, star, corner)
                                               : stands_well(mesh, locks, classes, corner);
  });
}

bool keeps_topology(const std::vector<std::uint8_t>& is_border, const CollapseStar& star) {
  constexpr std::uint32_t kMostTips = 3;
  if (star.on_edge >= 2 && is_border[star.a.vertex] != 0 && is_border[star.b.vertex] != 0) return false;
  // (a, c, d) and (b, c, d) would lie on each other.
  return star.common_neighbors == star.on_edge && star.on_edge <= kMostTips && !star.has_tip_edges;
}

bool turns_over(const CollapseStar& star) {
  LaneMask turned = mask_lanes(0);
  for (std::size_t i = 0; i < star.block_count(); ++i) {
    const Vec3Lanes before = load3(star.old[i].terms.normal), after = load3(star.fresh[i].terms.normal);
    const Lanes before2 = load_lanes(star.old[i].terms.normal2.data());
    const Lanes after2 = load_lanes(star.fresh[i].terms.normal2.data());
    const Lanes along = dot(before, after);
    // Of quotients, because products of four lengths squared leave the range of floats.
    const LaneMask is_wide = (along / before2) * (along / after2) < lanes(kFlipCosine * kFlipCosine);
    turned |= ((along <= lanes(0.0F)) | is_wide) & (before2 > lanes(0.0F));
  }
  return any_lane(turned);
}

}  // namespace meshlode::builder
