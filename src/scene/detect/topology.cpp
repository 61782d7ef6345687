// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/detect/topology.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/box.h"

namespace meshlode::scene {

namespace {

/// Products of two edges that are equal but for this share of their lengths are the same: rounding of doubles.
constexpr double kNoArea = 0x1p-48;

bool is_finite(const Vec3d& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// The smallest power of two that no finite coordinate is beyond; 1 where all are zero.
double choose_unit(const SourceMesh& mesh) {
  double largest = 0.0;
  for (const Primitive& primitive : mesh.primitives) {
    for (const Vec3d& p : primitive.positions) {
      if (is_finite(p)) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  if (largest == 0.0) return 1.0;
  int exponent = 0;
  (void)std::frexp(largest, &exponent);
  // The ends of the range, so that neither the unit nor its inverse overflows.
  return std::ldexp(1.0, std::clamp(exponent, -1021, 1021));
}

/// By vertex, 1 where a triangle has it: files share one array of vertices among meshes.
std::vector<std::uint8_t> find_used_vertices(const SourceMesh& mesh, const Topology& topology) {
  std::vector<std::uint8_t> is_used(topology.first_vertex.back(), 0);
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const std::vector<std::uint32_t>& indices = mesh.primitives[p].indices;
    for (std::size_t i = 0; i < indices.size() / 3 * 3; ++i) {
      if (indices[i] < mesh.primitives[p].positions.size()) is_used[topology.first_vertex[p] + indices[i]] = 1;
    }
  }
  return is_used;
}

/// Fills `points` and returns the point of each vertex, kNoId for one that is not used or not finite.
std::vector<std::uint32_t> weld_points(const SourceMesh& mesh, Topology& topology) {
  std::vector<Vec3d> positions;
  positions.reserve(topology.first_vertex.back());
  const double scale = 1.0 / topology.unit;
  for (const Primitive& primitive : mesh.primitives) {
    for (const Vec3d& p : primitive.positions) positions.push_back(p * scale);
  }
  const std::vector<std::uint8_t> is_used = find_used_vertices(mesh, topology);
  std::vector<std::uint32_t> order;
  order.reserve(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (is_used[v] != 0 && is_finite(positions[v])) order.push_back(v);
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3d &p = positions[a], &q = positions[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  std::vector<std::uint32_t> point_of(positions.size(), kNoId);
  for (const std::uint32_t v : order) {
    if (topology.points.empty() || topology.points.back() != positions[v]) topology.points.push_back(positions[v]);
    point_of[v] = static_cast<std::uint32_t>(topology.points.size() - 1);
  }
  return point_of;
}

void add_triangles(const SourceMesh& mesh, const std::vector<std::uint32_t>& point_of, Topology& topology) {
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const Primitive& primitive = mesh.primitives[p];
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      std::array<std::uint32_t, 3> points{}, vertices{};
      bool is_whole = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t index = primitive.indices[i + k];
        const bool is_in = index < primitive.positions.size();
        vertices[k] = is_in ? topology.first_vertex[p] + index : kNoId;
        points[k] = is_in ? point_of[vertices[k]] : kNoId;
        is_whole = is_whole && points[k] != kNoId;
      }
      topology.triangles.push_back(points);
      topology.vertices.push_back(vertices);
      topology.kinds.push_back(is_whole ? TriangleKind::kSound : TriangleKind::kNotFinite);
    }
    topology.first_triangle.push_back(static_cast<std::uint32_t>(topology.triangles.size()));
  }
  topology.is_reversed.assign(topology.triangles.size(), 0);
}

void find_degenerate_triangles(Topology& topology) {
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    const auto& [a, b, c] = topology.triangles[t];
    bool has_area = a != b && b != c && c != a;
    if (has_area) {
      const Vec3d ab = topology.points[b] - topology.points[a], ac = topology.points[c] - topology.points[a];
      const Vec3d bc = topology.points[c] - topology.points[b];
      const Vec3d cross = glm::cross(ab, ac);
      const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
      has_area = std::sqrt(glm::dot(cross, cross)) > kNoArea * longest;
    }
    if (!has_area) topology.kinds[t] = TriangleKind::kDegenerate;
  }
}

void find_duplicate_triangles(const SourceMesh& mesh, Topology& topology) {
  struct Face {
    std::array<std::uint32_t, 3> points;  // sorted
    std::uint32_t material, triangle;
    bool is_odd;  // sorting was an odd permutation
  };
  std::vector<Face> faces;
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    Face face{topology.triangles[t], mesh.primitives[topology.primitive_of(t)].material.value, t, false};
    const auto order = [&](std::size_t i, std::size_t j) {
      if (face.points[i] <= face.points[j]) return;
      std::swap(face.points[i], face.points[j]);
      face.is_odd = !face.is_odd;
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::tie(a.points, a.material, a.triangle) < std::tie(b.points, b.material, b.triangle);
  });
  for (std::size_t i = 1, first = 0; i < faces.size(); ++i) {
    if (faces[i].points != faces[first].points || faces[i].material != faces[first].material) {
      first = i;
      continue;
    }
    topology.kinds[faces[i].triangle] = TriangleKind::kDuplicate;
    topology.is_reversed[faces[i].triangle] = faces[i].is_odd != faces[first].is_odd ? 1 : 0;
  }
}

void add_edges(Topology& topology) {
  std::vector<double> lengths;
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t a = topology.triangles[t][k], b = topology.triangles[t][(k + 1U) % 3U];
      topology.edges.push_back({std::min(a, b), std::max(a, b), t, k, a < b});
    }
  }
  std::sort(topology.edges.begin(), topology.edges.end(), [](const TopologyEdge& a, const TopologyEdge& b) {
    return std::tie(a.low, a.high, a.triangle, a.corner) < std::tie(b.low, b.high, b.triangle, b.corner);
  });
  lengths.reserve(topology.edges.size());
  for (const TopologyEdge& edge : topology.edges) {
    const Vec3d along = topology.points[edge.high] - topology.points[edge.low];
    lengths.push_back(std::sqrt(glm::dot(along, along)));
  }
  if (lengths.empty()) return;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  topology.median_edge = *middle;
}

}  // namespace

std::uint32_t Topology::primitive_of(std::uint32_t triangle) const {
  const auto after = std::upper_bound(first_triangle.begin(), first_triangle.end(), triangle);
  return static_cast<std::uint32_t>(after - first_triangle.begin() - 1);
}

FaultTriangle Topology::name_of_triangle(std::uint32_t triangle) const {
  const std::uint32_t primitive = primitive_of(triangle);
  return {primitive, triangle - first_triangle[primitive]};
}

bool Topology::has_edge(std::uint32_t a, std::uint32_t b) const {
  const std::pair wanted(std::min(a, b), std::max(a, b));
  const auto at = std::lower_bound(edges.begin(), edges.end(), wanted, [](const TopologyEdge& edge, const auto& ends) {
    return std::pair(edge.low, edge.high) < ends;
  });
  return at != edges.end() && std::pair(at->low, at->high) == wanted;
}

Vec3d Topology::area_normal(std::uint32_t triangle) const {
  const auto& [a, b, c] = triangles[triangle];
  return glm::cross(points[b] - points[a], points[c] - points[a]);
}

bool is_countable(const SourceMesh& mesh) {
  std::uint64_t vertices = 0, corners = 0;
  for (const Primitive& primitive : mesh.primitives) {
    vertices += primitive.positions.size();
    corners += primitive.indices.size();
  }
  return vertices < kNoId && corners < kNoId;
}

Topology make_topology(const SourceMesh& mesh) {
  Topology topology;
  topology.first_vertex.push_back(0);
  topology.first_triangle.push_back(0);
  for (const Primitive& primitive : mesh.primitives) {
    topology.first_vertex.push_back(topology.first_vertex.back() +
                                    static_cast<std::uint32_t>(primitive.positions.size()));
  }
  topology.unit = choose_unit(mesh);
  add_triangles(mesh, weld_points(mesh, topology), topology);
  for (const Vec3d& p : topology.points) topology.box.add(p);
  if (!topology.points.empty()) {
    const Vec3d size = topology.box.size();
    topology.diagonal = std::sqrt(glm::dot(size, size));
  }
  find_degenerate_triangles(topology);
  find_duplicate_triangles(mesh, topology);
  add_edges(topology);
  return topology;
}

double ConcernedTriangles::share() const {
  if (is_marked_.empty()) return 0.0;
  return static_cast<double>(count_) / static_cast<double>(is_marked_.size());
}

void ConcernedTriangles::list_in(Fault& fault) const {
  fault.triangle_count = count_;
  for (std::uint32_t t = 0; t < is_marked_.size() && fault.triangles.size() < kMaxListedTriangles; ++t) {
    if (is_marked_[t] != 0) fault.triangles.push_back(topology_.name_of_triangle(t));
  }
}

}  // namespace meshlode::scene
