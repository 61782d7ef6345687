// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/wedge_classes.h"

#include <algorithm>

namespace meshlode::builder {

WedgeClasses::WedgeClasses(std::size_t wedge_count, std::size_t vertex_count)
    : only_wedge_(vertex_count, kSeveral), wedge_stamp_(wedge_count, 0), class_of_(wedge_count, 0) {}

void WedgeClasses::start(const CollapseMesh& mesh) {
  if (class_of_.empty()) return;
  std::vector<std::uint8_t> is_met(only_wedge_.size(), 0);
  for (std::uint32_t corner = 0; corner < 3 * mesh.triangle_count(); ++corner) {
    if (!mesh.is_alive(corner / 3)) continue;
    const std::uint32_t v = mesh.vertex(corner);
    if (is_met[v] == 0) only_wedge_[v] = mesh.wedge(corner);
    if (only_wedge_[v] != mesh.wedge(corner)) only_wedge_[v] = kSeveral;
    is_met[v] = 1;
  }
}

void WedgeClasses::update(const CollapseMesh& mesh, const StarEnd& end) {
  if (class_of_.empty()) return;
  std::uint32_t only = kSeveral;
  for (const std::uint32_t corner : end.corners) {
    const std::uint32_t w = mesh.wedge(corner);
    if (only == kSeveral) only = w;
    if (w == only) continue;
    only = kSeveral;
    break;
  }
  only_wedge_[end.vertex] = only;
}

WedgeClass& WedgeClasses::add_class() {
  if (count_ == classes_.size()) classes_.emplace_back();
  WedgeClass& c = classes_[count_++];
  c.members.clear();
  c.fixed = kNoId;
  return c;
}

/// A new class of its own, where the wedge has none yet.
std::uint32_t WedgeClasses::find_class(std::uint32_t wedge) {
  if (wedge_stamp_[wedge] != stamp_) {
    wedge_stamp_[wedge] = stamp_;
    class_of_[wedge] = static_cast<std::uint32_t>(count_);
    add_class().members.push_back(wedge);
  }
  return class_of_[wedge];
}

/// The last class takes the place of the j-th, which joins the i-th.
void WedgeClasses::join(std::uint32_t i, std::uint32_t j) {
  for (const std::uint32_t w : classes_[j].members) class_of_[w] = i;
  classes_[i].members.insert(classes_[i].members.end(), classes_[j].members.begin(), classes_[j].members.end());
  std::swap(classes_[j], classes_[count_ - 1]);
  --count_;
  if (j == count_) return;
  for (const std::uint32_t w : classes_[j].members) class_of_[w] = j;
}

/// One class per wedge first, joined along the triangles on the edge. At the hub of a wheel there are thousands: each
/// wedge knows its class.
void WedgeClasses::join_along_edge(const CollapseMesh& mesh, const CollapseStar& star) {
  ++stamp_;
  for (const StarEnd* end : {&star.a, &star.b}) {
    for (const std::uint32_t corner : end->corners) find_class(mesh.wedge(corner));
  }
  for (const std::uint32_t corner : star.a.corners) {
    const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
    const std::uint32_t previous = CollapseMesh::next_in_triangle(next);
    const std::uint32_t other = mesh.vertex(next) == star.b.vertex ? next : previous;
    if (mesh.vertex(other) != star.b.vertex) continue;
    const std::uint32_t i = find_class(mesh.wedge(corner));
    const std::uint32_t j = find_class(mesh.wedge(other));
    if (i != j) join(i, j);
  }
}

void WedgeClasses::collect(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star) {
  count_ = 0;
  if (class_of_.empty()) return;
  if (!needs_corners(star.a.vertex, star.b.vertex)) {
    const WedgePair pair = pair_of(locks, star.a.vertex, star.b.vertex);
    WedgeClass& c = add_class();
    c.members.assign({pair.least, pair.greatest});
    c.fixed = pair.fixed;
    return;
  }
  join_along_edge(mesh, star);
  for (std::size_t i = 0; i < count_; ++i) {
    WedgeClass& c = classes_[i];
    std::sort(c.members.begin(), c.members.end());
    const auto is_locked = [&](std::uint32_t w) { return locks.is_wedge_locked[w] != 0; };
    const auto locked = std::find_if(c.members.begin(), c.members.end(), is_locked);
    if (locked != c.members.end()) c.fixed = *locked;
  }
}

bool WedgeClasses::joins_locked(std::uint32_t wedge) const {
  return std::any_of(
      classes_.begin(), classes_.begin() + static_cast<std::ptrdiff_t>(count_), [&](const WedgeClass& c) {
        return c.fixed != kNoId && std::find(c.members.begin(), c.members.end(), wedge) != c.members.end();
      });
}

void relabel_wedges(CollapseMesh& mesh, const CollapseStar& star, const WedgeClass& joined) {
  const std::uint32_t keeper = joined.keeper();
  for (const std::uint32_t w : joined.members) {
    if (w == keeper) continue;
    for (const StarEnd* end : {&star.a, &star.b}) {
      for (const std::uint32_t corner : end->corners) {
        if (mesh.wedge(corner) == w) mesh.set_wedge(corner, keeper);
      }
    }
  }
}

}  // namespace meshlode::builder
