// SPDX-License-Identifier: GPL-3.0-or-later
// Where the vertex of a collapsed edge goes, what its attributes become there, and what both cost.
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode::build {

template <std::size_t C>
void GroupSimplifier<C>::update_wedges(const StarEnd& end) {
  if (attribute_count_ == 0) return;
  std::uint32_t& only = only_wedge_[end.vertex];
  only = kSeveralWedges;
  bool is_first = true;
  for (const std::uint32_t corner : end.corners) {
    const std::uint32_t w = mesh_.wedge(corner);
    if (is_first) only = w;
    if (w != only) {
      only = kSeveralWedges;
      return;
    }
    is_first = false;
  }
}

/// Which wedges of a and b become one: those that meet in a triangle on the edge.
template <std::size_t C>
void GroupSimplifier<C>::collect_wedge_classes(std::uint32_t a, std::uint32_t b) {
  class_count_ = 0;
  if (attribute_count_ == 0) return;
  const auto new_class = [&]() -> WedgeClass& {
    if (class_count_ == classes_.size()) classes_.emplace_back();
    WedgeClass& c = classes_[class_count_++];
    c.members.clear();
    c.fixed = kSeveralWedges;
    c.is_ambiguous = false;
    return c;
  };
  if (only_wedge_[a] != kSeveralWedges && only_wedge_[b] != kSeveralWedges) {
    new_class().members = {only_wedge_[a], only_wedge_[b]};
  } else {
    // One class per wedge first, joined along the triangles on the edge. At the hub of a wheel there are thousands: each
    // wedge knows its class.
    gather_corners(mesh_, a, b, star_);
    const std::uint64_t stamp = ++stamp_;
    const auto find_class = [&](std::uint32_t w) -> std::size_t {
      if (wedge_stamp_[w] != stamp) {
        wedge_stamp_[w] = stamp;
        class_of_[w] = static_cast<std::uint32_t>(class_count_);
        new_class().members.push_back(w);
      }
      return class_of_[w];
    };
    for (const std::uint32_t corner : star_.a.corners) find_class(mesh_.wedge(corner));
    for (const std::uint32_t corner : star_.b.corners) find_class(mesh_.wedge(corner));
    for (const std::uint32_t corner : star_.a.corners) {
      const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
      const std::uint32_t previous = CollapseMesh::next_in_triangle(next);
      const std::uint32_t other = mesh_.vertex(next) == b ? next : previous;
      if (mesh_.vertex(other) != b) continue;
      const std::size_t i = find_class(mesh_.wedge(corner));
      const std::size_t j = find_class(mesh_.wedge(other));
      if (i == j) continue;
      for (const std::uint32_t w : classes_[j].members) class_of_[w] = static_cast<std::uint32_t>(i);
      classes_[i].members.insert(classes_[i].members.end(), classes_[j].members.begin(), classes_[j].members.end());
      std::swap(classes_[j], classes_[class_count_ - 1]);
      --class_count_;
      if (j == class_count_) continue;
      for (const std::uint32_t w : classes_[j].members) class_of_[w] = static_cast<std::uint32_t>(j);
    }
  }
  for (std::size_t i = 0; i < class_count_; ++i) {
    WedgeClass& c = classes_[i];
    std::sort(c.members.begin(), c.members.end());
    for (const std::uint32_t w : c.members) {
      if (is_wedge_locked_[w] == 0) continue;
      c.is_ambiguous |= c.fixed != kSeveralWedges && value_[c.fixed] != value_[w];
      if (c.fixed == kSeveralWedges) c.fixed = w;
    }
  }
}

template <std::size_t C>
typename GroupSimplifier<C>::Placement GroupSimplifier<C>::place(std::uint32_t a, std::uint32_t b) {
  Quadric total = plane_[a];
  total += plane_[b];
  const double weight = total.weight;
  total.add_scaled(border_[a], options_.border_weight);
  total.add_scaled(border_[b], options_.border_weight);
  if (!seam_.empty()) {
    total.add_scaled(seam_[a], 1.0);
    total.add_scaled(seam_[b], 1.0);
  }
  const Vec3d& pa = places_[a];
  const Vec3d& pb = places_[b];
  const Vec3d edge = pb - pa;
  const double length2 = glm::dot(edge, edge);

  double fixed_error = 0.0;  // of wedges whose values may not change; only where the place is given
  const bool is_place_given = is_locked_[a] != 0 || is_locked_[b] != 0;
  const Vec3d given = is_locked_[a] != 0 ? pa : pb;
  collect_wedge_classes(a, b);
  for (std::size_t i = 0; i < class_count_; ++i) {
    const WedgeClass& c = classes_[i];
    Wedge joined = wedge_[c.members[0]];
    for (std::size_t k = 1; k < c.members.size(); ++k) joined.add(wedge_[c.members[k]], attribute_count_);
    if (c.fixed != kSeveralWedges) {
      fixed_error += joined.evaluate(given, value_[c.fixed].data(), attribute_count_);
    } else {
      joined.add_reduced_to(total, attribute_count_);
    }
  }

  Placement placement;
  if (is_place_given) {
    placement.position = given;
  } else {
    const Vec3d middle = (pa + pb) * 0.5;
    total.add_point(middle, kRegularization * weight);
    const double reach2 = kMaxOffset * kMaxOffset * length2;
    Vec3d best;
    bool is_placed = total.minimize(best);
    if (is_placed) {
      const Vec3d offset = best - middle;
      is_placed = glm::dot(offset, offset) <= reach2;
    }
    if (!is_placed) {
      // The best point of the edge, then its ends: E along the edge is a parabola.
      const double slope = glm::dot(edge, Vec3d(total.a00 * pa.x + total.a01 * pa.y + total.a02 * pa.z + total.b0,
                                                total.a01 * pa.x + total.a11 * pa.y + total.a12 * pa.z + total.b1,
                                                total.a02 * pa.x + total.a12 * pa.y + total.a22 * pa.z + total.b2));
      const double bend = glm::dot(edge, Vec3d(total.a00 * edge.x + total.a01 * edge.y + total.a02 * edge.z,
                                               total.a01 * edge.x + total.a11 * edge.y + total.a12 * edge.z,
                                               total.a02 * edge.x + total.a12 * edge.y + total.a22 * edge.z));
      const double t = bend > 0.0 ? std::clamp(-slope / bend, 0.0, 1.0) : 0.5;
      best = pa + edge * t;
      double best_error = total.evaluate(best);
      for (const Vec3d& end : {pa, pb}) {
        const double error = total.evaluate(end);
        if (error < best_error) {
          best = end;
          best_error = error;
        }
      }
    }
    placement.position = best;
  }
  const double error = total.evaluate(placement.position) + fixed_error + kRegularization * weight * length2;
  placement.cost = weight > 0.0 ? error / std::sqrt(weight) : error;
  return placement;
}

}  // namespace meshlode::build
