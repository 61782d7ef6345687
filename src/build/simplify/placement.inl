// SPDX-License-Identifier: GPL-3.0-or-later
// Where the vertex of a collapsed edge goes, what its attributes become there, and what both cost.
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode::build {

/// Whether the locked wedges that would become one have one value.
template <std::size_t C>
bool GroupSimplifier<C>::agree(const WedgeClass& joined) const {
  return std::all_of(joined.members.begin(), joined.members.end(), [&](std::uint32_t w) {
    return w == joined.fixed || locks_.is_wedge_locked[w] == 0 || value_[w] == value_[joined.fixed];
  });
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
  const bool is_place_given = locks_.is_vertex_locked[a] != 0 || locks_.is_vertex_locked[b] != 0;
  const Vec3d given = locks_.is_vertex_locked[a] != 0 ? pa : pb;
  classes_.collect(mesh_, locks_, star_);
  for (const WedgeClass& c : classes_.classes()) {
    Wedge joined = wedge_[c.members[0]];
    for (std::size_t k = 1; k < c.members.size(); ++k) joined.add(wedge_[c.members[k]], attribute_count_);
    if (c.fixed != WedgeClass::kNone) {
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
