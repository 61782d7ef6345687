// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/left_behind.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "builder/simplify/point_triangle.h"

namespace meshlode::builder {

LeftBehind::LeftBehind(std::vector<Witnesses> witnesses, const std::vector<Vec3i>& positions)
    : positions_(positions), witnesses_(std::move(witnesses)), next_joined_(positions.size()) {
  std::iota(next_joined_.begin(), next_joined_.end(), 0U);
}

/// A neighbour that no triangle of the new star has: an edge to it is not covered any more, or all of it goes. The
/// distance is that of the middle of what goes. False where too many vertices go.
bool LeftBehind::look_at(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                         std::uint32_t vertex) {
  const bool has_others = mesh.any_corner(vertex, [&](std::uint32_t corner) {
    return !mesh.has(corner / 3, star.a.vertex) && !mesh.has(corner / 3, star.b.vertex);
  });
  const Vec3d away = places[vertex] - star.target;
  largest2_ = std::max(largest2_, static_cast<float>((has_others ? 0.25 : 1.0) * glm::dot(away, away)));
  if (has_others) return true;
  if (vertex_count_ == kMostVertices) return false;
  vertices_[vertex_count_++] = vertex;
  return true;
}

bool LeftBehind::find_among_neighbors(const CollapseMesh& mesh, const GroupPlaces& places, VertexMarks& marks,
                                      const CollapseStar& star) {
  marks.start_search();
  for (const CollapseStar::OuterEdge& edge : star.outer()) {
    marks.mark(edge.x);
    marks.mark(edge.y);
  }
  for (const Ring* end : {&star.a, &star.b}) {
    for (const std::uint32_t corner : end->corners()) {
      for (const std::uint32_t v : mesh.others(corner)) {
        if (v == star.a.vertex || v == star.b.vertex || marks.is_marked_once(v)) continue;
        marks.mark(v);
        if (!look_at(mesh, places, star, v)) return false;
      }
    }
  }
  const std::span<const std::uint32_t> sheets = star.sheets();
  for (std::size_t k = 0; k < sheets.size(); k += 2) {
    const double height2 = height2_of_sheet(mesh, places, star, sheets[k], false);
    largest2_ = std::max(largest2_, static_cast<float>(0.25 * height2));
  }
  return true;
}

/// Under the link condition only a tip can go, of an edge of the border or of a piece that vanishes.
bool LeftBehind::find_vanishing(const CollapseMesh& mesh, const GroupPlaces& places, VertexMarks& marks,
                                const CollapseStar& star, const Asked& asked) {
  if (!asked.is_manifold) return find_among_neighbors(mesh, places, marks, star);
  if (!asked.is_on_border && star.outer_count > 0) return true;
  for (std::size_t k = 0; k < star.on_edge; ++k) {
    const std::uint32_t tip = star.tips[k];
    const bool is_covered = std::any_of(star.outer().begin(), star.outer().end(),
                                        [&](const auto& edge) { return edge.x == tip || edge.y == tip; });
    if (!is_covered && !look_at(mesh, places, star, tip)) return false;
  }
  return true;
}

/// The piece vanishes: what it leaves is as far off as the nearest of what stays. What is near the star comes first,
/// and what is no farther than `enough` is not looked for any closer: of thousands of loose pieces each would look at
/// all others else.
float LeftBehind::distance2_to_rest(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                    const Vec3i& point, float enough) const {
  const Vec3d p = places.to_frame(point);
  double nearest = std::numeric_limits<double>::infinity();
  const auto look_at = [&](std::uint32_t t) {
    if (!mesh.is_alive(t) || mesh.has(t, star.a.vertex) || mesh.has(t, star.b.vertex)) return;
    const Vec3d &a = places[mesh.vertex(3 * t)], &b = places[mesh.vertex(3 * t + 1)],
                &c = places[mesh.vertex(3 * t + 2)];
    nearest = std::min(nearest, distance2_to_facet(p, a, b, c));
  };
  const std::uint32_t first = star.gone()[0];
  const auto count = static_cast<std::uint32_t>(mesh.triangle_count());
  for (std::uint32_t step = 0; (step <= first || first + step < count) && !(nearest <= double{enough}); ++step) {
    if (step <= first) look_at(first - step);
    if (step > 0 && first + step < count) look_at(first + step);
  }
  return static_cast<float>(std::min(nearest, 1e30));
}

MESHLODE_CLONED_FOR_AVX2
void LeftBehind::weigh_witnesses(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                 std::uint32_t vertex) {
  const Witnesses& witnesses = witnesses_[vertex];
  const std::span<const FourFacets> facets = std::span(star.fresh).first(star.block_count());
  for (std::uint32_t i = 0; i < witnesses.count; ++i) {
    const float distance2 = facets.empty()
                                ? distance2_to_rest(mesh, places, star, witnesses.points[i], largest2_)
                                : distance2_to(facets, Vec3f(places.to_frame(witnesses.points[i]) - star.target));
    std::uint32_t at = weighed_count_++;
    for (; at > 0 && weighed_[at - 1].distance2 < distance2; --at) weighed_[at] = weighed_[at - 1];
    weighed_[at] = {distance2, vertex, i};
    largest2_ = std::max(largest2_, distance2);
  }
}

double LeftBehind::size2(std::uint32_t vertex, const GroupPlaces& places) const {
  Vec3i low = positions_[vertex], high = low;
  for (std::uint32_t v = next_joined_[vertex]; v != vertex; v = next_joined_[v]) {
    low = glm::min(low, positions_[v]);
    high = glm::max(high, positions_[v]);
  }
  const Vec3d diagonal = Vec3d(high - low) / places.scale();
  return glm::dot(diagonal, diagonal);
}

double LeftBehind::size2_of_both(const CollapseStar& star, const GroupPlaces& places) {
  std::swap(next_joined_[star.a.vertex], next_joined_[star.b.vertex]);  // two rings are one
  const double both2 = size2(star.a.vertex, places);
  std::swap(next_joined_[star.a.vertex], next_joined_[star.b.vertex]);
  return both2;
}

std::optional<float> LeftBehind::weigh(const CollapseMesh& mesh, const GroupPlaces& places, VertexMarks& marks,
                                       const CollapseStar& star, const Asked& asked) {
  vertices_[0] = star.a.vertex;
  vertices_[1] = star.b.vertex;
  vertex_count_ = 2;
  weighed_count_ = 0;
  largest2_ = 0.0F;
  if (!find_vanishing(mesh, places, marks, star, asked)) return std::nullopt;
  // Of foliage its size is what is lost: its neighbours grow instead.
  if (star.outer_count == 0 && asked.keep_area) {
    return std::max(largest2_, static_cast<float>(size2_of_both(star, places)));
  }
  for (std::uint32_t i = 0; i < vertex_count_; ++i) weigh_witnesses(mesh, places, star, vertices_[i]);
  return largest2_;
}

void LeftBehind::join(std::uint32_t into, std::uint32_t from) {
  Witnesses kept;
  kept.count = std::min<std::uint32_t>(weighed_count_, Witnesses::kCapacity);
  for (std::uint32_t i = 0; i < kept.count; ++i) {
    kept.points[i] = witnesses_[weighed_[i].vertex].points[weighed_[i].index];
    kept.ids[i] = witnesses_[weighed_[i].vertex].ids[weighed_[i].index];
  }
  witnesses_[into] = kept;
  std::swap(next_joined_[into], next_joined_[from]);
}

double height2_of_sheet(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                        std::uint32_t triangle, bool is_least) {
  Vec3d outer[2]{Vec3d(0.0), Vec3d(0.0)};
  int count = 0;
  for (std::uint32_t corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
    const std::uint32_t v = mesh.vertex(corner);
    if (v != star.a.vertex && v != star.b.vertex && count < 2) outer[count++] = places[v];
  }
  const Vec3d base = outer[1] - outer[0], x = star.target - outer[0], y = star.target - outer[1];
  const Vec3d cross = glm::cross(base, x);
  double base2 = glm::dot(base, base);
  if (is_least) base2 = std::max({base2, glm::dot(x, x), glm::dot(y, y)});
  return count == 2 && base2 > 0.0 ? glm::dot(cross, cross) / base2 : 0.0;
}

}  // namespace meshlode::builder
