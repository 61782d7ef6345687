// SPDX-License-Identifier: GPL-3.0-or-later
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode {

template <std::size_t C>
GroupSimplifier<C>::GroupSimplifier(const SimplifyInput& input, const SimplifyOptions& options)
    : input_(input),
      options_(options),
      mesh_(input.triangles, input.wedge_position, input.positions.size()),
      attribute_count_(input.layout.stride()),
      grid_position_(input.positions),
      position_(input.positions.size()),
      plane_(input.positions.size()),
      border_(input.positions.size()),
      witnesses_(input.witnesses),
      merged_(input.positions.size()),
      version_(input.positions.size(), 0),
      is_locked_(input.is_locked),
      is_border_(input.positions.size(), 0),
      only_wedge_(input.positions.size(), kSeveralWedges),
      wedge_(attribute_count_ == 0 ? 0 : input.wedge_position.size()),
      value_(wedge_.size()),
      is_wedge_locked_(input.wedge_position.size(), 0) {
  set_frame();
  scale_attributes();
  add_face_quadrics();
  add_edge_quadrics();
  for (std::size_t w = 0; w < input.wedge_position.size(); ++w) {
    is_wedge_locked_[w] = is_locked_[input.wedge_position[w]];
  }
  for (std::uint32_t v = 0; v < position_.size(); ++v) update_wedges(v);
}

template <std::size_t C>
void GroupSimplifier<C>::set_frame() {
  Vec3i low(0);
  Vec3i high(0);
  for (std::size_t v = 0; v < input_.positions.size(); ++v) {
    low = v == 0 ? input_.positions[v] : glm::min(low, input_.positions[v]);
    high = v == 0 ? input_.positions[v] : glm::max(high, input_.positions[v]);
  }
  center_ = (Vec3d(low) + Vec3d(high)) * 0.5;
  const Vec3i extent = high - low;
  scale_ = std::max(1.0, 0.5 * std::max({extent.x, extent.y, extent.z}));
  inverse_scale_ = 1.0 / scale_;
  for (std::size_t v = 0; v < position_.size(); ++v) {
    position_[v] = to_frame(grid_position_[v]);
    merged_[v] = {position_[v], position_[v]};
  }
}

template <std::size_t C>
Vec3i GroupSimplifier<C>::to_grid(const Vec3d& p) const {
  const Vec3d q = p * scale_ + center_;
  Vec3i out;
  for (int k = 0; k < 3; ++k) {
    const double rounded = std::floor(q[k] + 0.5);
    out[k] = static_cast<int>(std::clamp<double>(rounded, -kMaxGridCoordinate, kMaxGridCoordinate));
  }
  return out;
}

/// Attribute units become distances: see SimplifyOptions.
template <std::size_t C>
void GroupSimplifier<C>::scale_attributes() {
  attribute_scale_.assign(attribute_count_, 0.0);
  if (attribute_count_ == 0) return;
  const AttributeLayout& layout = input_.layout;
  double area = 0.0;
  std::array<double, kMaxUvSets> uv_area{};
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    const Vec3d& p = position_[mesh_.vertex(3 * t)];
    const Vec3d n = glm::cross(position_[mesh_.vertex(3 * t + 1)] - p, position_[mesh_.vertex(3 * t + 2)] - p);
    area += 0.5 * std::sqrt(glm::dot(n, n));
    for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
      std::array<Vec2d, 3> uv;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const float* a = &input_.wedge_attributes[std::size_t{mesh_.wedge(3 * t + k)} * attribute_count_];
        uv[k] = {a[layout.uv_offset() + 2 * set], a[layout.uv_offset() + 2 * set + 1]};
      }
      const Vec2d e = uv[1] - uv[0];
      const Vec2d f = uv[2] - uv[0];
      uv_area[set] += 0.5 * std::abs(e.x * f.y - e.y * f.x);
    }
  }
  // Where few triangles are left, what a normal says holds for less than they cover: the shape comes first then.
  constexpr double kMaxSide = 0.05;  // of half the group's extent: a full group has about this
  const double mean_side = std::min(kMaxSide, std::sqrt(area / std::max(1U, mesh_.alive_count())));
  for (std::size_t j = 0; j < attribute_count_; ++j) {
    if (layout.has_normal && j < 3) {
      attribute_scale_[j] = options_.normal_weight * mean_side;
    } else if (j < layout.color_offset()) {
      const double density = uv_area[(j - layout.uv_offset()) / 2];
      attribute_scale_[j] = density > 0.0 ? options_.uv_weight * std::sqrt(area / density) : 0.0;
    } else {
      attribute_scale_[j] = options_.color_weight * mean_side;
    }
    if (!std::isfinite(attribute_scale_[j])) attribute_scale_[j] = 0.0;
  }
  for (std::size_t w = 0; w < wedge_.size(); ++w) {
    for (std::size_t j = 0; j < attribute_count_; ++j) {
      value_[w][j] = attribute_scale_[j] * static_cast<double>(input_.wedge_attributes[w * attribute_count_ + j]);
    }
  }
}

template <std::size_t C>
void GroupSimplifier<C>::add_face_quadrics() {
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    const std::uint32_t v[3] = {mesh_.vertex(3 * t), mesh_.vertex(3 * t + 1), mesh_.vertex(3 * t + 2)};
    const Vec3d& p = position_[v[0]];
    const Vec3d e1 = position_[v[1]] - p;
    const Vec3d e2 = position_[v[2]] - p;
    const Vec3d cross = glm::cross(e1, e2);
    const double twice_area = std::sqrt(glm::dot(cross, cross));
    if (!(twice_area > 0.0)) continue;
    const Vec3d n = cross / twice_area;
    const double area = 0.5 * twice_area;
    for (const std::uint32_t vertex : v) plane_[vertex].add_plane(n, -glm::dot(n, p), area);
    total_weight_ += 3.0 * area;
    if (attribute_count_ == 0) continue;

    // Across a sliver a gradient means nothing: there the attribute is taken as constant.
    const double longest2 = std::max({glm::dot(e1, e1), glm::dot(e2, e2), glm::dot(e2 - e1, e2 - e1)});
    const bool is_sliver = twice_area < 1e-3 * longest2;
    const Vec3d to_1 = glm::cross(e2, n) / twice_area;
    const Vec3d to_2 = glm::cross(n, e1) / twice_area;
    const std::uint32_t w[3] = {mesh_.wedge(3 * t), mesh_.wedge(3 * t + 1), mesh_.wedge(3 * t + 2)};
    for (const std::uint32_t wedge : w) wedge_[wedge].base.weight += area;
    for (std::size_t j = 0; j < attribute_count_; ++j) {
      const double s0 = value_[w[0]][j];
      const double s1 = value_[w[1]][j];
      const double s2 = value_[w[2]][j];
      Vec3d gradient(0.0);
      double offset = (s0 + s1 + s2) / 3.0;
      if (!is_sliver) {
        gradient = to_1 * (s1 - s0) + to_2 * (s2 - s0);
        offset = s0 - glm::dot(gradient, p);
      }
      for (const std::uint32_t wedge : w) wedge_[wedge].add_face(j, gradient, offset, area);
    }
  }
}

/// Borders of the source, of materials and of texture charts are held in place by planes that stand on them.
template <std::size_t C>
void GroupSimplifier<C>::add_edge_quadrics() {
  struct Use {
    std::uint32_t a, b;     // a < b
    std::uint32_t corner;   // whose edge to the next corner this is
  };
  std::vector<Use> uses;
  uses.reserve(3 * mesh_.alive_count());
  for (std::uint32_t corner = 0; corner < 3 * mesh_.triangle_count(); ++corner) {
    if (!mesh_.is_alive(corner / 3)) continue;
    const std::uint32_t a = mesh_.vertex(corner);
    const std::uint32_t b = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
    uses.push_back({std::min(a, b), std::max(a, b), corner});
  }
  std::sort(uses.begin(), uses.end(), [](const Use& x, const Use& y) {
    if (x.a != y.a) return x.a < y.a;
    if (x.b != y.b) return x.b < y.b;
    return x.corner < y.corner;
  });
  const auto add_wall = [&](const Use& use, std::vector<Quadric>& quadrics, double weight) {
    const std::uint32_t t = use.corner / 3;
    const Vec3d& p = position_[mesh_.vertex(3 * t)];
    const Vec3d n = glm::cross(position_[mesh_.vertex(3 * t + 1)] - p, position_[mesh_.vertex(3 * t + 2)] - p);
    const Vec3d edge = position_[use.b] - position_[use.a];
    Vec3d wall = glm::cross(n, edge);
    const double length = std::sqrt(glm::dot(wall, wall));
    if (!(length > 0.0)) return;
    wall /= length;
    const double d = -glm::dot(wall, position_[use.a]);
    const double w = weight * glm::dot(edge, edge);
    quadrics[use.a].add_plane(wall, d, w);
    quadrics[use.b].add_plane(wall, d, w);
  };
  const auto add_seam = [&](const Use& use, double weight) {
    if (seam_.empty()) seam_.resize(position_.size());
    add_wall(use, seam_, weight);
  };
  const AttributeLayout& layout = input_.layout;
  const auto differ = [&](std::uint32_t corner_x, std::uint32_t corner_y) {
    const float* x = &input_.wedge_attributes[std::size_t{mesh_.wedge(corner_x)} * attribute_count_];
    const float* y = &input_.wedge_attributes[std::size_t{mesh_.wedge(corner_y)} * attribute_count_];
    return !std::equal(x + layout.uv_offset(), x + attribute_count_, y + layout.uv_offset());
  };
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    while (end < uses.size() && uses[end].a == uses[i].a && uses[end].b == uses[i].b) ++end;
    if (end - i != 2) {
      for (std::size_t k = i; k < end; ++k) add_wall(uses[k], border_, 1.0);
      is_border_[uses[i].a] = is_border_[uses[i].b] = 1;
    } else {
      const Use& x = uses[i];
      const Use& y = uses[i + 1];
      double weight = 0.0;
      if (input_.triangle_material[x.corner / 3] != input_.triangle_material[y.corner / 3]) {
        weight = options_.border_weight;
      } else if (attribute_count_ > layout.uv_offset()) {
        const auto corner_at = [&](const Use& use, std::uint32_t vertex) {
          return mesh_.vertex(use.corner) == vertex ? use.corner : CollapseMesh::next_in_triangle(use.corner);
        };
        if (differ(corner_at(x, x.a), corner_at(y, x.a)) || differ(corner_at(x, x.b), corner_at(y, x.b))) {
          weight = options_.seam_weight;
        }
      }
      if (weight > 0.0) {
        add_seam(x, weight);
        add_seam(y, weight);
      }
    }
    i = end;
  }
}

template <std::size_t C>
void GroupSimplifier<C>::update_wedges(std::uint32_t vertex) {
  if (attribute_count_ == 0) return;
  mesh_.corners_of(vertex, corners_a_);
  only_wedge_[vertex] = kSeveralWedges;
  bool is_first = true;
  for (const std::uint32_t corner : corners_a_) {
    const std::uint32_t w = mesh_.wedge(corner);
    if (is_first) only_wedge_[vertex] = w;
    if (w != only_wedge_[vertex]) {
      only_wedge_[vertex] = kSeveralWedges;
      return;
    }
    is_first = false;
  }
}

template <std::size_t C>
void GroupSimplifier<C>::seed_candidates() {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh_.alive_count());
  for (std::uint32_t corner = 0; corner < 3 * mesh_.triangle_count(); ++corner) {
    if (!mesh_.is_alive(corner / 3)) continue;
    const std::uint32_t a = mesh_.vertex(corner);
    const std::uint32_t b = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
    edges.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const auto& [a, b] : edges) push_candidate(a, b);
}

template <std::size_t C>
void GroupSimplifier<C>::push_candidate(std::uint32_t a, std::uint32_t b) {
  if (is_locked_[a] != 0 && is_locked_[b] != 0) {
    ++obstacles_[static_cast<std::size_t>(Obstacle::kLocked)];
    return;
  }
  if (a > b) std::swap(a, b);
  const Placement placement = place(a, b);
  queue_.push({placement.cost, a, b, version_[a], version_[b]});
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
    // One class per wedge first, joined along the triangles on the edge. Wedge counts are small: linear search will do.
    mesh_.corners_of(a, corners_a_);
    mesh_.corners_of(b, corners_b_);
    const auto find_class = [&](std::uint32_t w) -> std::size_t {
      for (std::size_t i = 0; i < class_count_; ++i) {
        const auto& members = classes_[i].members;
        if (std::find(members.begin(), members.end(), w) != members.end()) return i;
      }
      new_class().members.push_back(w);
      return class_count_ - 1;
    };
    for (const std::uint32_t corner : corners_a_) find_class(mesh_.wedge(corner));
    for (const std::uint32_t corner : corners_b_) find_class(mesh_.wedge(corner));
    for (const std::uint32_t corner : corners_a_) {
      const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
      const std::uint32_t previous = CollapseMesh::next_in_triangle(next);
      const std::uint32_t other = mesh_.vertex(next) == b ? next : previous;
      if (mesh_.vertex(other) != b) continue;
      const std::size_t i = find_class(mesh_.wedge(corner));
      const std::size_t j = find_class(mesh_.wedge(other));
      if (i == j) continue;
      classes_[i].members.insert(classes_[i].members.end(), classes_[j].members.begin(), classes_[j].members.end());
      std::swap(classes_[j], classes_[class_count_ - 1]);
      --class_count_;
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
  const Vec3d& pa = position_[a];
  const Vec3d& pb = position_[b];
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

/// I3 for attributes. A triangle (locked, moved, c) with c locked goes; the triangle across (moved, c) inherits the edge
/// (locked, c), which may lie on the group's border. If another group shades that edge with the same wedges, the heir
/// must bring them: (moved, c) may not be a crease. And no border edge gets a corner with attributes that nothing had there. `around` are the corners at the moved vertex.
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
  for (const std::uint32_t corner : around) {
    const std::uint32_t t = corner / 3;
    const std::uint32_t at_locked = corner_in(t, locked);
    if (at_locked == CollapseMesh::kEnd) {
      // The triangle will stand on the locked vertex. If it has another locked one, their edge may be the border.
      const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
      const bool may_be_border = is_locked_[mesh_.vertex(next)] != 0 ||
                                 is_locked_[mesh_.vertex(CollapseMesh::next_in_triangle(next))] != 0;
      if (may_be_border && !joins_locked_wedge(mesh_.wedge(corner))) return false;
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

/// The triangles that would surround the joined vertex, by their outer edges. Where sheets are dropped, pairs that would
/// lie on each other do not count: they will be gone.
template <std::size_t C>
void GroupSimplifier<C>::collect_new_star(std::uint32_t a, std::uint32_t b, bool drops_sheets) {
  star_.clear();
  sheet_.clear();
  for (const auto* corners : {&corners_a_, &corners_b_}) {
    for (const std::uint32_t corner : *corners) {
      const std::uint32_t x = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
      const std::uint32_t y = mesh_.vertex(CollapseMesh::next_in_triangle(CollapseMesh::next_in_triangle(corner)));
      if (x == a || x == b || y == a || y == b) continue;
      if (drops_sheets) {
        const auto opposite = std::find(star_.begin(), star_.end(), std::pair(y, x));
        if (opposite != star_.end()) {
          sheet_.push_back(*opposite);
          *opposite = star_.back();
          star_.pop_back();
          continue;
        }
      }
      star_.emplace_back(x, y);
    }
  }
}

/// What goes without a vertex noticing: an edge to a neighbour that no triangle covers any more, a dropped sheet, and
/// neighbours whose triangles all go (their witnesses are weighed too). Returns the largest squared distance at which
/// such points are left, taken to the middle of what goes.
template <std::size_t C>
double GroupSimplifier<C>::collect_vanishing(std::uint32_t a, std::uint32_t b, const Vec3d& target) {
  vanishing_.clear();
  double lost2 = 0.0;
  const auto is_in_star = [&](std::uint32_t v) {
    return std::any_of(star_.begin(), star_.end(), [v](const auto& edge) { return edge.first == v || edge.second == v; });
  };
  for (const auto* corners : {&corners_a_, &corners_b_}) {
    for (const std::uint32_t corner : *corners) {
      const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
      for (const std::uint32_t v : {mesh_.vertex(next), mesh_.vertex(CollapseMesh::next_in_triangle(next))}) {
        if (v == a || v == b || is_in_star(v)) continue;
        if (std::find(vanishing_.begin(), vanishing_.end(), v) != vanishing_.end()) continue;
        mesh_.corners_of(v, dropped_);
        const bool has_others = std::any_of(dropped_.begin(), dropped_.end(), [&](std::uint32_t c) {
          const std::uint32_t x = mesh_.vertex(CollapseMesh::next_in_triangle(c));
          const std::uint32_t y = mesh_.vertex(CollapseMesh::next_in_triangle(CollapseMesh::next_in_triangle(c)));
          return x != a && x != b && y != a && y != b;
        });
        const Vec3d uncovered = position_[v] - target;
        lost2 = std::max(lost2, (has_others ? 0.25 : 1.0) * glm::dot(uncovered, uncovered));
        if (!has_others) vanishing_.push_back(v);
      }
    }
  }
  for (const auto& [x, y] : sheet_) {
    const Vec3d base = position_[y] - position_[x];
    const Vec3d cross = glm::cross(base, target - position_[x]);
    const double base2 = glm::dot(base, base);
    if (base2 > 0.0) lost2 = std::max(lost2, 0.25 * glm::dot(cross, cross) / base2);
  }
  return lost2;
}

/// The largest squared distance from what is left behind to the group's triangles away from both vertices.
template <std::size_t C>
double GroupSimplifier<C>::distance2_to_rest(std::uint32_t a, std::uint32_t b) const {
  double largest = 0.0;
  for (const auto& [unused, point] : left_behind_) {
    const Vec3d p = to_frame(point);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (!mesh_.is_alive(t)) continue;
      const std::array<std::uint32_t, 3> v{mesh_.vertex(3 * t), mesh_.vertex(3 * t + 1), mesh_.vertex(3 * t + 2)};
      if (std::any_of(v.begin(), v.end(), [&](std::uint32_t x) { return x == a || x == b; })) continue;
      nearest = std::min(nearest, distance2_to_facet(p, position_[v[0]], position_[v[1]], position_[v[2]]));
    }
    largest = std::max(largest, nearest);
  }
  return largest;
}

/// The largest squared distance from the witnesses of both vertices to the new star; left_behind_ holds all of them.
template <std::size_t C>
double GroupSimplifier<C>::weigh_witnesses(std::uint32_t a, std::uint32_t b, const Vec3d& target) {
  left_behind_.clear();
  double largest = 0.0;
  const auto weigh = [&](std::uint32_t vertex) {
    const Witnesses& w = witnesses_[vertex];
    for (std::uint32_t i = 0; i < w.count; ++i) {
      const Vec3d point = to_frame(w.points[i]);
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& [x, y] : star_) {
        nearest = std::min(nearest, distance2_to_facet(point, target, position_[x], position_[y]));
      }
      left_behind_.emplace_back(nearest, w.points[i]);
      largest = std::max(largest, nearest);
    }
  };
  weigh(a);
  weigh(b);
  for (const std::uint32_t v : vanishing_) weigh(v);
  if (!star_.empty()) return largest;
  // The piece vanishes. Of foliage its size is what is lost: its neighbours grow instead. Else what it leaves is as far
  // off as the nearest of what stays.
  const Box both{glm::min(merged_[a].low, merged_[b].low), glm::max(merged_[a].high, merged_[b].high)};
  if (options_.keep_area) return both.diagonal() * both.diagonal();
  return std::min(distance2_to_rest(a, b), 1e30);
}

/// How far the new star is from the triangles that it replaces, squared, where that exceeds `least`; else `least`. By the
/// middles of its triangles and of their edges at the target.
template <std::size_t C>
double GroupSimplifier<C>::new_surface_distance2(const Vec3d& target, double least) const {
  double farthest = least;
  const auto reach = [&](const Vec3d& point) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto* corners : {&corners_a_, &corners_b_}) {
      for (const std::uint32_t corner : *corners) {
        const std::uint32_t t = corner / 3;
        nearest = std::min(nearest, distance2_to_facet(point, position_[mesh_.vertex(3 * t)],
                                                       position_[mesh_.vertex(3 * t + 1)], position_[mesh_.vertex(3 * t + 2)]));
        if (nearest <= farthest) return;
      }
    }
    if (nearest < std::numeric_limits<double>::infinity()) farthest = nearest;
  };
  for (const auto& [x, y] : star_) {
    reach((target + position_[x] + position_[y]) / 3.0);
    reach((target + position_[x]) * 0.5);
    reach((target + position_[y]) * 0.5);
  }
  return farthest;
}

template <std::size_t C>
typename GroupSimplifier<C>::Obstacle GroupSimplifier<C>::try_collapse(const Candidate& candidate) {
  std::uint32_t a = candidate.a;
  std::uint32_t b = candidate.b;
  const Placement placement = place(a, b);  // leaves the wedge classes behind
  for (std::size_t i = 0; i < class_count_; ++i) {
    if (classes_[i].is_ambiguous) return Obstacle::kSeams;
  }
  Vec3d target = placement.position;
  if (is_locked_[a] == 0 && is_locked_[b] == 0) target = to_frame(to_grid(target));
  mesh_.corners_of(a, corners_a_);
  mesh_.corners_of(b, corners_b_);
  if (is_locked_[a] != 0 && !keeps_shared_corners(a, corners_b_)) return Obstacle::kSeams;
  if (is_locked_[b] != 0 && !keeps_shared_corners(b, corners_a_)) return Obstacle::kSeams;
  bool breaks_topology = false;
  if (!keeps_topology(a, b)) {
    if (!options_.may_relax_topology) return Obstacle::kTopology;
    if (!candidate.may_break_topology) {
      queue_.push({kTopologyPrice * candidate.cost, a, b, version_[a], version_[b], true});
      return Obstacle::kPutBack;
    }
    breaks_topology = true;
  }
  if (!are_flips_relaxed_ && (turns_over(a, b, corners_a_, target) || turns_over(b, a, corners_b_, target))) {
    return Obstacle::kFlips;
  }
  // Thin closed features vanish almost free of plane error, and crevices and tunnels close so. What the source points
  // behind both vertices would be left at, and how far the new triangles are from the old, is the truth of it: where that
  // is far more than the quadrics say, the collapse waits for its turn at that price.
  collect_new_star(a, b, breaks_topology || has_broken_topology_);
  const double lost2 = collect_vanishing(a, b, target);
  const double left_behind2 = std::max(lost2, weigh_witnesses(a, b, target));
  const double mean_weight = 2.0 * total_weight_ / mesh_.alive_count();
  const double price_of_distance2 = kGuardShare * std::sqrt(std::max(mean_weight, plane_[a].weight + plane_[b].weight));
  double price = price_of_distance2 * left_behind2;
  if (price <= candidate.cost) {
    const double affordable2 = price_of_distance2 > 0.0 ? candidate.cost / price_of_distance2 : 0.0;
    const double reached2 = new_surface_distance2(target, affordable2);
    if (reached2 > affordable2) price = price_of_distance2 * reached2;
  }
  if (price > candidate.cost) {
    queue_.push({price, a, b, version_[a], version_[b], candidate.may_break_topology});
    return Obstacle::kPutBack;
  }
  has_broken_topology_ |= breaks_topology;
  if (is_locked_[b] != 0) std::swap(a, b);
  collapse(a, b, target);
  return Obstacle::kNone;
}

/// Joins b into a at `target`. The wedge classes of the pair are in classes_.
template <std::size_t C>
void GroupSimplifier<C>::collapse(std::uint32_t a, std::uint32_t b, const Vec3d& target) {
  plane_[a] += plane_[b];
  border_[a] += border_[b];
  if (!seam_.empty()) seam_[a] += seam_[b];
  if (plane_[a].weight > 0.0) {
    error_ = std::max(error_, std::sqrt(plane_[a].evaluate(target) / plane_[a].weight));
  }
  if (border_[a].weight > 0.0) {
    error_ = std::max(error_, std::sqrt(border_[a].evaluate(target) / border_[a].weight));
  }
  std::stable_sort(left_behind_.begin(), left_behind_.end(),
                   [](const auto& x, const auto& y) { return x.first > y.first; });
  witnesses_[a].count = static_cast<std::uint32_t>(std::min(left_behind_.size(), Witnesses::kCapacity));
  for (std::uint32_t i = 0; i < witnesses_[a].count; ++i) witnesses_[a].points[i] = left_behind_[i].second;
  merged_[a].low = glm::min(merged_[a].low, merged_[b].low);
  merged_[a].high = glm::max(merged_[a].high, merged_[b].high);
  is_border_[a] |= is_border_[b];
  if (is_locked_[a] == 0) {
    grid_position_[a] = to_grid(target);
    position_[a] = to_frame(grid_position_[a]);
  }
  const auto relabel = [&](std::uint32_t vertex, std::uint32_t from, std::uint32_t to) {
    for (const std::uint32_t corner : vertex == a ? corners_a_ : corners_b_) {
      if (mesh_.wedge(corner) == from) mesh_.set_wedge(corner, to);
    }
  };
  mesh_.corners_of(a, corners_a_);
  mesh_.corners_of(b, corners_b_);
  for (std::size_t i = 0; i < class_count_; ++i) {
    const WedgeClass& c = classes_[i];
    const std::uint32_t keeper = c.fixed != kSeveralWedges ? c.fixed : c.members[0];
    for (const std::uint32_t w : c.members) {
      if (w == keeper) continue;
      wedge_[keeper].add(wedge_[w], attribute_count_);
      relabel(a, w, keeper);
      relabel(b, w, keeper);
    }
    if (c.fixed == kSeveralWedges && wedge_[keeper].base.weight > 0.0) {
      for (std::size_t j = 0; j < attribute_count_; ++j) value_[keeper][j] = wedge_[keeper].best(j, position_[a]);
    }
  }
  mesh_.merge_vertices(a, b);
  ++version_[a];
  ++version_[b];

  if (has_broken_topology_) error_ = std::max(error_, drop_collapsed_sheets(a));
  update_wedges(a);
  mesh_.corners_of(a, corners_a_);
  if (corners_a_.empty()) error_ = std::max(error_, merged_[a].diagonal());

  neighbors_a_.clear();
  for (const std::uint32_t corner : corners_a_) {
    const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
    neighbors_a_.push_back(mesh_.vertex(next));
    neighbors_a_.push_back(mesh_.vertex(CollapseMesh::next_in_triangle(next)));
  }
  std::sort(neighbors_a_.begin(), neighbors_a_.end());
  neighbors_a_.erase(std::unique(neighbors_a_.begin(), neighbors_a_.end()), neighbors_a_.end());
  const std::vector<std::uint32_t> around = neighbors_a_;
  for (const std::uint32_t n : around) push_candidate(a, n);
}

/// Removes pairs of triangles that lie on each other. Such a sheet has no plane error, but it was there: returns its
/// smallest height, or the size of what stood behind vertices that go with it, in frame units.
template <std::size_t C>
double GroupSimplifier<C>::drop_collapsed_sheets(std::uint32_t vertex) {
  mesh_.drop_opposite_pairs(vertex, dropped_);
  double lost = 0.0;
  for (const std::uint32_t t : dropped_) {
    const std::uint32_t v[3] = {mesh_.vertex(3 * t), mesh_.vertex(3 * t + 1), mesh_.vertex(3 * t + 2)};
    const Vec3d e0 = position_[v[1]] - position_[v[0]];
    const Vec3d e1 = position_[v[2]] - position_[v[1]];
    const Vec3d e2 = position_[v[0]] - position_[v[2]];
    const Vec3d cross = glm::cross(e0, e1);
    const double longest2 = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
    if (longest2 > 0.0) lost = std::max(lost, std::sqrt(glm::dot(cross, cross) / longest2));
    for (const std::uint32_t corner_vertex : v) {
      mesh_.corners_of(corner_vertex, corners_b_);
      if (corners_b_.empty()) lost = std::max(lost, merged_[corner_vertex].diagonal());
    }
  }
  return lost;
}

/// Scales the pieces that can grow about their centres until the group covers as much as it did.
template <std::size_t C>
void GroupSimplifier<C>::grow_pieces() {
  const auto area_of = [&](const Vec3d& p, const Vec3d& q, const Vec3d& r) {
    const Vec3d n = glm::cross(q - p, r - p);
    return 0.5 * std::sqrt(glm::dot(n, n));
  };
  double covered = 0.0;
  for (const WedgeTriangle& t : input_.triangles) {
    covered += area_of(to_frame(input_.positions[input_.wedge_position[t[0]]]),
                       to_frame(input_.positions[input_.wedge_position[t[1]]]),
                       to_frame(input_.positions[input_.wedge_position[t[2]]]));
  }
  std::vector<std::uint32_t> parent(position_.size());
  for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = v;
  const auto root_of = [&](std::uint32_t v) {
    while (parent[v] != v) {
      parent[v] = parent[parent[v]];
      v = parent[v];
    }
    return v;
  };
  struct Piece {
    double area = 0.0;
    Vec3d moment{0.0};  ///< area times centre
    bool is_locked = false;
  };
  std::vector<Piece> pieces(position_.size());
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    for (const std::uint32_t corner : {3 * t + 1, 3 * t + 2}) parent[root_of(mesh_.vertex(corner))] = root_of(mesh_.vertex(3 * t));
  }
  double fixed = 0.0;
  double free = 0.0;
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    const Vec3d p[3] = {position_[mesh_.vertex(3 * t)], position_[mesh_.vertex(3 * t + 1)], position_[mesh_.vertex(3 * t + 2)]};
    Piece& piece = pieces[root_of(mesh_.vertex(3 * t))];
    const double area = area_of(p[0], p[1], p[2]);
    piece.area += area;
    piece.moment += (p[0] + p[1] + p[2]) * (area / 3.0);
    for (std::uint32_t k = 0; k < 3; ++k) piece.is_locked |= is_locked_[mesh_.vertex(3 * t + k)] != 0;
  }
  for (const Piece& piece : pieces) (piece.is_locked ? fixed : free) += piece.area;
  if (!(free > 0.0) || !(covered - fixed > free)) return;
  const double growth = std::min(kMaxGrowth, std::sqrt((covered - fixed) / free));
  for (std::uint32_t v = 0; v < position_.size(); ++v) {
    const Piece& piece = pieces[root_of(v)];
    if (piece.is_locked || !(piece.area > 0.0)) continue;
    const Vec3d center = piece.moment / piece.area;
    const Vec3d moved = (position_[v] - center) * (growth - 1.0);
    error_ = std::max(error_, std::sqrt(glm::dot(moved, moved)));
    grid_position_[v] = to_grid(center + (position_[v] - center) * growth);
    position_[v] = to_frame(grid_position_[v]);
  }
}

template <std::size_t C>
void GroupSimplifier<C>::run() {
  run_passes();
  if (options_.may_relax_flips && mesh_.alive_count() > options_.target_triangles) {
    are_flips_relaxed_ = true;
    run_passes();
  }
  if (options_.keep_area) grow_pieces();
}

template <std::size_t C>
void GroupSimplifier<C>::run_passes() {
  for (int pass = 0; pass < kMaxPasses && mesh_.alive_count() > options_.target_triangles; ++pass) {
    obstacles_.fill(0);
    queue_ = {};
    seed_candidates();
    bool any = false;
    while (!queue_.empty() && mesh_.alive_count() > options_.target_triangles) {
      const Candidate candidate = queue_.top();
      queue_.pop();
      if (version_[candidate.a] != candidate.version_a || version_[candidate.b] != candidate.version_b) continue;
      const Obstacle obstacle = try_collapse(candidate);
      if (obstacle == Obstacle::kNone) {
        any = true;
      } else {
        ++obstacles_[static_cast<std::size_t>(obstacle)];
      }
    }
    if (!any) break;  // obstacles depend on neighbours too, so what was refused is tried again as long as something moved
  }
}

template <std::size_t C>
StuckReason GroupSimplifier<C>::reason_for_stopping() const {
  if (mesh_.alive_count() <= options_.target_triangles) return StuckReason::kNotStuck;
  const auto largest = std::max_element(obstacles_.begin() + 1, obstacles_.begin() + 5);
  if (*largest == 0) return StuckReason::kTooSmall;
  switch (static_cast<Obstacle>(largest - obstacles_.begin())) {
    case Obstacle::kLocked: return StuckReason::kLocked;
    case Obstacle::kFlips: return StuckReason::kFlips;
    case Obstacle::kSeams: return StuckReason::kSeams;
    case Obstacle::kTopology: return StuckReason::kTopology;
    case Obstacle::kNone:
    case Obstacle::kPutBack: break;
  }
  return StuckReason::kTooSmall;
}

template <std::size_t C>
SimplifyResult GroupSimplifier<C>::result() const {
  SimplifyResult out;
  out.quadric_error = error_ * scale_ * input_.grid.step();
  out.reason = reason_for_stopping();
  constexpr std::uint32_t kUnset = 0xFFFFFFFFU;
  std::vector<std::uint32_t> new_position(position_.size(), kUnset);
  // A wedge may have come to serve one vertex only, so a map per wedge is enough.
  std::vector<std::uint32_t> new_wedge(input_.wedge_position.size(), kUnset);
  const std::size_t stride = attribute_count_;
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    WedgeTriangle triangle{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh_.vertex(3 * t + k);
      const std::uint32_t w = stride == 0 ? v : mesh_.wedge(3 * t + k);
      if (new_position[v] == kUnset) {
        new_position[v] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(grid_position_[v]);
        out.witnesses.push_back(witnesses_[v]);
      }
      std::uint32_t& slot = stride == 0 ? new_position[v] : new_wedge[w];
      if (stride == 0 ? out.wedge_position.size() <= slot : slot == kUnset) {
        slot = static_cast<std::uint32_t>(out.wedge_position.size());
        out.wedge_position.push_back(new_position[v]);
        for (std::size_t j = 0; j < stride; ++j) {
          const bool is_kept = is_wedge_locked_[w] != 0 || !(attribute_scale_[j] > 0.0);
          out.wedge_attributes.push_back(is_kept ? input_.wedge_attributes[w * stride + j]
                                                 : static_cast<float>(value_[w][j] / attribute_scale_[j]));
        }
        if (input_.layout.has_normal && is_wedge_locked_[w] == 0) {
          float* n = &out.wedge_attributes[out.wedge_attributes.size() - stride];
          const double x = n[0];
          const double y = n[1];
          const double z = n[2];
          const double length = std::sqrt(x * x + y * y + z * z);
          if (length > 0.0) {
            n[0] = static_cast<float>(x / length);
            n[1] = static_cast<float>(y / length);
            n[2] = static_cast<float>(z / length);
          } else {
            std::copy_n(&input_.wedge_attributes[w * stride], 3, n);
          }
        }
      }
      triangle[k] = slot;
    }
    out.triangles.push_back(triangle);
    out.triangle_material.push_back(input_.triangle_material[t]);
  }
  return out;
}

}  // namespace meshlode
