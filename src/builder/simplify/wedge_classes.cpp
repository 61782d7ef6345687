// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/wedge_classes.h"

#include <algorithm>

namespace meshlode::builder {

std::uint32_t WedgeClasses::add(std::uint32_t wedge) {
  const std::uint32_t i = find(wedge);
  if (i == count_) {
    wedge_[i] = wedge;
    class_[i] = i;
    ++count_;
  }
  return i;
}

void WedgeClasses::join(std::uint32_t i, std::uint32_t j) {
  const auto [low, high] = std::minmax({class_[i], class_[j]});
  for (std::uint32_t k = high; k < count_; ++k) {
    if (class_[k] == high) class_[k] = low;
  }
}

void WedgeClasses::find_fixed(const GroupLocks& locks) {
  for (std::uint32_t i = 0; i < count_; ++i) {
    fixed_[i] = kNoId;
    if (locks.is_wedge_locked[wedge_[i]] != 0) fixed_[class_[i]] = std::min(fixed_[class_[i]], wedge_[i]);
  }
}

void WedgeClasses::collect(const CollapseMesh& mesh, const GroupLocks& locks, const Ring& a, const Ring& b) {
  count_ = 0;
  for (const Ring* end : {&a, &b}) {
    for (const std::uint32_t corner : end->corners()) (void)add(mesh.wedge(corner));
  }
  for (const std::uint32_t corner : a.corners()) {
    const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
    const std::uint32_t previous = CollapseMesh::next_in_triangle(next);
    const std::uint32_t other = mesh.vertex(next) == b.vertex ? next : previous;
    if (mesh.vertex(other) == b.vertex) join(find(mesh.wedge(corner)), find(mesh.wedge(other)));
  }
  find_fixed(locks);
}

void WedgeClasses::set_pair(const GroupLocks& locks, std::uint32_t x, std::uint32_t y) {
  count_ = 0;
  (void)add(x);
  class_[add(y)] = 0;
  find_fixed(locks);
}

void relabel_wedges(CollapseMesh& mesh, const Ring& ring, const WedgeClasses& classes) {
  for (const std::uint32_t corner : ring.corners()) {
    mesh.set_wedge(corner, classes.keeper(classes.class_of(classes.find(mesh.wedge(corner)))));
  }
}

OnlyWedges::OnlyWedges(const CollapseMesh& mesh) : only_(mesh.vertex_count(), kNoId) {
  std::vector<std::uint8_t> is_met(only_.size(), 0);
  for (std::uint32_t corner = 0; corner < 3 * mesh.triangle_count(); ++corner) {
    if (!mesh.is_alive(corner / 3)) continue;
    const std::uint32_t v = mesh.vertex(corner);
    if (is_met[v] == 0) only_[v] = mesh.wedge(corner);
    is_met[v] = 1;
    if (only_[v] == mesh.wedge(corner)) continue;
    only_[v] = kNoId;
    has_seams_ = true;
  }
}

void OnlyWedges::update(const CollapseMesh& mesh, std::uint32_t vertex) {
  only_[vertex] = kNoId;
  std::uint32_t first = kNoId;
  const bool has_several = mesh.any_corner(vertex, [&](std::uint32_t corner) {
    if (first == kNoId) first = mesh.wedge(corner);
    return mesh.wedge(corner) != first;
  });
  if (!has_several) only_[vertex] = first;
}

}  // namespace meshlode::builder
