// SPDX-License-Identifier: GPL-3.0-or-later
// What a group begins with: the frame in which it is weighed, the scale of its attributes, and the quadrics of its
// faces, borders and seams.
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode::build {

template <std::size_t C>
GroupSimplifier<C>::GroupSimplifier(const SimplifyInput& input, const SimplifyOptions& options)
    : input_(input),
      options_(options),
      locks_(input.is_locked, input.is_wedge_shared, input.wedge_position),
      mesh_(input.triangles, input.wedge_position, input.positions.size()),
      places_(input.positions),
      attribute_count_(input.layout.stride()),
      plane_(input.positions.size()),
      border_(input.positions.size()),
      left_behind_(input.witnesses, places_),
      version_(input.positions.size(), 0),
      is_border_(input.positions.size(), 0),
      wedge_(attribute_count_ == 0 ? 0 : input.wedge_position.size()),
      value_(wedge_.size()),
      classes_(wedge_.size(), input.positions.size()) {
  scale_attributes();
  add_face_quadrics();
  add_edge_quadrics();
  if (attribute_count_ == 0) return;
  for (joined_.vertex = 0; joined_.vertex < places_.size(); ++joined_.vertex) {
    mesh_.corners_of(joined_.vertex, joined_.corners);
    classes_.update(mesh_, joined_);
  }
}

/// Attribute units become distances: see SimplifyOptions.
template <std::size_t C>
void GroupSimplifier<C>::scale_attributes() {
  attribute_scale_.assign(attribute_count_, 0.0);
  if (attribute_count_ == 0) return;
  const AttributeLayout& layout = input_.layout;
  double area = 0.0;
  std::array<double, scene::kMaxUvSets> uv_area{};
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    const Vec3d& p = places_[mesh_.vertex(3 * t)];
    const Vec3d n = glm::cross(places_[mesh_.vertex(3 * t + 1)] - p, places_[mesh_.vertex(3 * t + 2)] - p);
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
    const Vec3d& p = places_[v[0]];
    const Vec3d e1 = places_[v[1]] - p;
    const Vec3d e2 = places_[v[2]] - p;
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
    const Vec3d& p = places_[mesh_.vertex(3 * t)];
    const Vec3d n = glm::cross(places_[mesh_.vertex(3 * t + 1)] - p, places_[mesh_.vertex(3 * t + 2)] - p);
    const Vec3d edge = places_[use.b] - places_[use.a];
    Vec3d wall = glm::cross(n, edge);
    const double length = std::sqrt(glm::dot(wall, wall));
    if (!(length > 0.0)) return;
    wall /= length;
    const double d = -glm::dot(wall, places_[use.a]);
    const double w = weight * glm::dot(edge, edge);
    quadrics[use.a].add_plane(wall, d, w);
    quadrics[use.b].add_plane(wall, d, w);
  };
  const auto add_seam = [&](const Use& use, double weight) {
    if (seam_.empty()) seam_.resize(places_.size());
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
    int net = 0;
    for (std::size_t k = i; k < end; ++k) net += mesh_.vertex(uses[k].corner) == uses[k].a ? 1 : -1;
    has_free_border_ |= net != 0 && (locks_.is_vertex_locked[uses[i].a] == 0 || locks_.is_vertex_locked[uses[i].b] == 0);
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

}  // namespace meshlode::build
