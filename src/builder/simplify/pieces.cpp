// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/pieces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/disjoint_sets.h"

namespace meshlode::builder {

namespace {

constexpr double kMaxGrowth = 2.0;  ///< of a piece's size in one level

struct Piece {
  double area = 0.0;
  Vec3d moment{0.0};  ///< area times centre
  bool is_locked = false;
};

double area_of(const Vec3d& p, const Vec3d& q, const Vec3d& r) {
  const Vec3d n = glm::cross(q - p, r - p);
  return 0.5 * std::sqrt(glm::dot(n, n));
}

double covered_area(const SimplifyInput& input, const GroupPlaces& places) {
  double covered = 0.0;
  const auto place = [&](std::uint32_t wedge) { return places.to_frame(input.positions[input.wedge_position[wedge]]); };
  for (const WedgeTriangle& t : input.triangles) covered += area_of(place(t[0]), place(t[1]), place(t[2]));
  return covered;
}

/// By the vertex that names each.
std::vector<Piece> measure_pieces(const SimplifyInput& input, const CollapseMesh& mesh, const GroupPlaces& places,
                                  const std::vector<std::uint32_t>& piece_of) {
  std::vector<Piece> pieces(places.size());
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!mesh.is_alive(t)) continue;
    const std::array<std::uint32_t, 3> v{mesh.vertex(3 * t), mesh.vertex(3 * t + 1), mesh.vertex(3 * t + 2)};
    Piece& piece = pieces[piece_of[v[0]]];
    const double area = area_of(places[v[0]], places[v[1]], places[v[2]]);
    piece.area += area;
    piece.moment += (places[v[0]] + places[v[1]] + places[v[2]]) * (area / 3.0);
    for (const std::uint32_t corner : v) piece.is_locked |= input.stays(corner);
  }
  return pieces;
}

}  // namespace

std::vector<std::uint32_t> pieces_of(const CollapseMesh& mesh, std::size_t vertex_count) {
  DisjointSets pieces(vertex_count);
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!mesh.is_alive(t)) continue;
    for (const std::uint32_t corner : {3 * t + 1, 3 * t + 2}) pieces.join_to(mesh.vertex(3 * t), mesh.vertex(corner));
  }
  std::vector<std::uint32_t> piece_of(vertex_count);
  for (std::uint32_t v = 0; v < piece_of.size(); ++v) piece_of[v] = pieces.find(v);
  return piece_of;
}

std::size_t count_pieces(const CollapseMesh& mesh, std::size_t vertex_count) {
  const std::vector<std::uint32_t> piece_of = pieces_of(mesh, vertex_count);
  std::vector<std::uint32_t> pieces;
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.is_alive(t)) pieces.push_back(piece_of[mesh.vertex(3 * t)]);
  }
  std::sort(pieces.begin(), pieces.end());
  return static_cast<std::size_t>(std::unique(pieces.begin(), pieces.end()) - pieces.begin());
}

double grow_pieces(const SimplifyInput& input, const CollapseMesh& mesh, GroupPlaces& places) {
  const std::vector<std::uint32_t> piece_of = pieces_of(mesh, places.size());
  const std::vector<Piece> pieces = measure_pieces(input, mesh, places, piece_of);
  const double covered = covered_area(input, places);
  double fixed = 0.0;
  double free = 0.0;
  for (const Piece& piece : pieces) (piece.is_locked ? fixed : free) += piece.area;
  if (!(free > 0.0) || !(covered - fixed > free)) return 0.0;
  const double growth = std::min(kMaxGrowth, std::sqrt((covered - fixed) / free));
  double farthest = 0.0;
  for (std::uint32_t v = 0; v < places.size(); ++v) {
    const Piece& piece = pieces[piece_of[v]];
    if (piece.is_locked || !(piece.area > 0.0)) continue;
    const Vec3d center = piece.moment / piece.area;
    const Vec3d moved = (places[v] - center) * (growth - 1.0);
    farthest = std::max(farthest, std::sqrt(glm::dot(moved, moved)));
    places.move(v, center + (places[v] - center) * growth);
  }
  return farthest;
}

}  // namespace meshlode::builder
