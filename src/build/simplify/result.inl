// SPDX-License-Identifier: GPL-3.0-or-later
// What is left: pieces grown to the area that the group covered, and the group as the DAG wants it.
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode::build {

/// Per vertex, one vertex of the loose piece that it belongs to: pieces share no vertex.
template <std::size_t C>
std::vector<std::uint32_t> GroupSimplifier<C>::find_pieces() const {
  DisjointSets pieces(places_.size());
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    for (const std::uint32_t corner : {3 * t + 1, 3 * t + 2}) pieces.join_to(mesh_.vertex(3 * t), mesh_.vertex(corner));
  }
  std::vector<std::uint32_t> piece_of(places_.size());
  for (std::uint32_t v = 0; v < piece_of.size(); ++v) piece_of[v] = pieces.find(v);
  return piece_of;
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
    covered += area_of(places_.to_frame(input_.positions[input_.wedge_position[t[0]]]),
                       places_.to_frame(input_.positions[input_.wedge_position[t[1]]]),
                       places_.to_frame(input_.positions[input_.wedge_position[t[2]]]));
  }
  struct Piece {
    double area = 0.0;
    Vec3d moment{0.0};  ///< area times centre
    bool is_locked = false;
  };
  std::vector<Piece> pieces(places_.size());
  const std::vector<std::uint32_t> piece_of = find_pieces();
  double fixed = 0.0;
  double free = 0.0;
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    const Vec3d p[3] = {places_[mesh_.vertex(3 * t)], places_[mesh_.vertex(3 * t + 1)], places_[mesh_.vertex(3 * t + 2)]};
    Piece& piece = pieces[piece_of[mesh_.vertex(3 * t)]];
    const double area = area_of(p[0], p[1], p[2]);
    piece.area += area;
    piece.moment += (p[0] + p[1] + p[2]) * (area / 3.0);
    for (std::uint32_t k = 0; k < 3; ++k) piece.is_locked |= locks_.is_vertex_locked[mesh_.vertex(3 * t + k)] != 0;
  }
  for (const Piece& piece : pieces) (piece.is_locked ? fixed : free) += piece.area;
  if (!(free > 0.0) || !(covered - fixed > free)) return;
  const double growth = std::min(kMaxGrowth, std::sqrt((covered - fixed) / free));
  for (std::uint32_t v = 0; v < places_.size(); ++v) {
    const Piece& piece = pieces[piece_of[v]];
    if (piece.is_locked || !(piece.area > 0.0)) continue;
    const Vec3d center = piece.moment / piece.area;
    const Vec3d moved = (places_[v] - center) * (growth - 1.0);
    error_ = std::max(error_, std::sqrt(glm::dot(moved, moved)));
    places_.move(v, center + (places_[v] - center) * growth);
  }
}

template <std::size_t C>
StuckReason GroupSimplifier<C>::reason_for_stopping() const {
  if (mesh_.alive_count() <= options_.target_triangles) return StuckReason::kNotStuck;
  const auto largest = std::max_element(obstacles_.begin() + 1, obstacles_.begin() + 5);
  if (static_cast<Obstacle>(largest - obstacles_.begin()) != Obstacle::kLocked) {
    // A piece keeps two triangles where it is closed: so many leave no room for the target, whatever refuses the last.
    std::vector<std::uint32_t> pieces;
    const std::vector<std::uint32_t> piece_of = find_pieces();
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (mesh_.is_alive(t)) pieces.push_back(piece_of[mesh_.vertex(3 * t)]);
    }
    std::sort(pieces.begin(), pieces.end());
    const auto end = std::unique(pieces.begin(), pieces.end());
    if (2 * (end - pieces.begin()) > std::ptrdiff_t{options_.target_triangles}) return StuckReason::kComponents;
  }
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

/// Two vertices may have come to lie on one point of the grid. A triangle with both has no area and no border by then.
template <std::size_t C>
bool GroupSimplifier<C>::has_corners_in_one_place(std::uint32_t triangle) const {
  const Vec3i& p = places_.on_grid(mesh_.vertex(3 * triangle));
  const Vec3i& q = places_.on_grid(mesh_.vertex(3 * triangle + 1));
  const Vec3i& r = places_.on_grid(mesh_.vertex(3 * triangle + 2));
  return p == q || q == r || r == p;
}

template <std::size_t C>
SimplifyResult GroupSimplifier<C>::result() const {
  SimplifyResult out;
  out.quadric_error = error_ * places_.scale() * input_.grid.step();
  out.reason = reason_for_stopping();
  constexpr std::uint32_t kUnset = 0xFFFFFFFFU;
  std::vector<std::uint32_t> new_position(places_.size(), kUnset);
  // A wedge may have come to serve one vertex only, so a map per wedge is enough.
  std::vector<std::uint32_t> new_wedge(input_.wedge_position.size(), kUnset);
  const std::size_t stride = attribute_count_;
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t) || has_corners_in_one_place(t)) continue;
    WedgeTriangle triangle{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh_.vertex(3 * t + k);
      const std::uint32_t w = stride == 0 ? v : mesh_.wedge(3 * t + k);
      if (new_position[v] == kUnset) {
        new_position[v] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(places_.on_grid(v));
        out.witnesses.push_back(left_behind_.witnesses(v));
      }
      std::uint32_t& slot = stride == 0 ? new_position[v] : new_wedge[w];
      if (stride == 0 ? out.wedge_position.size() <= slot : slot == kUnset) {
        slot = static_cast<std::uint32_t>(out.wedge_position.size());
        out.wedge_position.push_back(new_position[v]);
        for (std::size_t j = 0; j < stride; ++j) {
          const bool is_kept = locks_.is_wedge_locked[w] != 0 || !(attribute_scale_[j] > 0.0);
          out.wedge_attributes.push_back(is_kept ? input_.wedge_attributes[w * stride + j]
                                                 : static_cast<float>(value_[w][j] / attribute_scale_[j]));
        }
        if (input_.layout.has_normal && locks_.is_wedge_locked[w] == 0) {
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

}  // namespace meshlode::build
