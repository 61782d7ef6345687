// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/prepare/weld.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <tuple>

#include <tbb/parallel_sort.h>

#include "base/parallel.h"
#include "base/release.h"
#include "base/unset_vector.h"
#include "builder/gap_label.h"
#include "builder/prepare/flat_normal.h"

namespace meshlode::builder {

namespace {

/// Spreads the low 21 bits of x to every third bit.
std::uint64_t spread3(std::uint64_t x) {
  x &= 0x1FFFFF;
  x = (x | x << 32U) & 0x001F00000000FFFF;
  x = (x | x << 16U) & 0x001F0000FF0000FF;
  x = (x | x << 8U) & 0x100F00F00F00F00F;
  x = (x | x << 4U) & 0x10C30C30C30C30C3;
  x = (x | x << 2U) & 0x1249249249249249;
  return x;
}

/// Z-order of a grid point (24 bits an axis, the lowest three dropped: ties are ordered by coordinates).
std::uint64_t morton(const Vec3i& q) {
  const auto axis = [](int value) {
    return static_cast<std::uint64_t>(value + (format::kMaxGridCoordinate + 1)) >> 3U;
  };
  return spread3(axis(q.x)) | spread3(axis(q.y)) << 1U | spread3(axis(q.z)) << 2U;
}

auto as_tuple(const Vec3i& q) {
  return std::tuple(q.x, q.y, q.z);
}

/// Orders attribute sets by their bits: any total order will do, it has to be the same everywhere.
int compare_attributes(const float* a, const float* b, std::uint32_t stride) {
  return stride == 0 ? 0 : std::memcmp(a, b, stride * sizeof(float));
}

/// Vertex ids sorted by Z-order of the grid point, then the point, then attributes, then exact position: equal wedges,
/// positions and source points become runs, whatever their numbers were.
UnsetVector<std::uint32_t> canonical_vertex_order(const Corners& corners, std::span<const Vec3i> quantized,
                                                  std::uint32_t stride) {
  struct Placed {
    std::uint64_t key;
    std::uint32_t vertex;
  };
  UnsetVector<Placed> placed(quantized.size());
  parallel_for_each_index(placed.size(), kLoopGrain, [&](std::size_t i) {
    placed[i] = {morton(quantized[i]), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(placed.begin(), placed.end(), [&](const Placed& x, const Placed& y) {
    if (x.key != y.key) return x.key < y.key;
    const std::uint32_t a = x.vertex, b = y.vertex;
    if (quantized[a] != quantized[b]) return as_tuple(quantized[a]) < as_tuple(quantized[b]);
    const int attributes =
        compare_attributes(corners.attributes_of(a, stride), corners.attributes_of(b, stride), stride);
    if (attributes != 0) return attributes < 0;
    const Vec3d& p = corners.positions[a];
    const Vec3d& q = corners.positions[b];
    if (p != q) return std::tuple(p.x, p.y, p.z) < std::tuple(q.x, q.y, q.z);
    return a < b;
  });
  UnsetVector<std::uint32_t> order(placed.size());
  parallel_for_each_index(order.size(), kLoopGrain, [&](std::size_t i) { order[i] = placed[i].vertex; });
  return order;
}

/// Two ids of a vertex: of its exact position with its attributes, as in the source, and of that one's wedge.
struct VertexIds {
  UnsetVector<std::uint32_t> exact_of;  ///< per vertex; of those that no triangle uses, nothing
  UnsetVector<std::uint32_t> wedge_of_exact;
};

/// Of a vertex in canonical order: what it begins. A new point is a new wedge, and that a new exact position.
struct Begins {
  std::uint32_t points = 0, wedges = 0, exacts = 0;
};

void add(Begins& sum, const Begins& more) {
  sum.points += more.points;
  sum.wedges += more.wedges;
  sum.exacts += more.exacts;
}

/// Runs of the canonical order become positions (grid point), wedges (grid point and attributes) and exact positions:
/// counted by chunk, then written to where the chunks before end.
VertexIds weld_vertices(const Corners& corners, std::span<const Vec3i> points, const std::vector<std::uint8_t>& is_used,
                        PreparedMesh& mesh) {
  constexpr std::size_t kLength = 4 * kLoopGrain;
  const std::uint32_t stride = mesh.layout.stride();
  UnsetVector<std::uint32_t> order = canonical_vertex_order(corners, points, stride);
  VertexIds ids;
  ids.exact_of.resize(order.size());
  std::erase_if(order, [&](std::uint32_t v) { return is_used[v] == 0; });
  const auto begins_at = [&](std::size_t i) -> Begins {
    if (i == 0) return {1, 1, 1};
    const std::uint32_t v = order[i], previous = order[i - 1];
    if (points[v] != points[previous]) return {1, 1, 1};
    const int attributes =
        compare_attributes(corners.attributes_of(v, stride), corners.attributes_of(previous, stride), stride);
    if (attributes != 0) return {0, 1, 1};
    return {0, 0, corners.positions[v] == corners.positions[previous] ? 0U : 1U};
  };
  std::vector<Begins> before(chunk_count(order.size(), kLength) + 1);
  parallel_for_each_chunk(order.size(), kLength, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) add(before[chunk + 1], begins_at(i));
  });
  for (std::size_t chunk = 0; chunk + 1 < before.size(); ++chunk) add(before[chunk + 1], before[chunk]);
  const Begins all = before.back();
  parallel_all([&] { mesh.positions.resize(all.points); }, [&] { mesh.wedge_position.resize(all.wedges); },
               [&] { mesh.wedge_attributes.resize(std::size_t{all.wedges} * stride); },
               [&] { mesh.exact_positions.resize(all.exacts); });
  ids.wedge_of_exact.resize(all.exacts);
  parallel_for_each_chunk(order.size(), kLength, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    Begins so_far = before[chunk];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t v = order[i];
      const Begins begun = begins_at(i);
      add(so_far, begun);
      const std::uint32_t point = so_far.points - 1, wedge = so_far.wedges - 1, exact = so_far.exacts - 1;
      if (begun.points != 0) mesh.positions[point] = points[v];
      if (begun.wedges != 0) {
        mesh.wedge_position[wedge] = point;
        std::copy_n(corners.attributes_of(v, stride), stride,
                    mesh.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(std::size_t{wedge} * stride));
      }
      if (begun.exacts != 0) {
        ids.wedge_of_exact[exact] = wedge;
        mesh.exact_positions[exact] = corners.positions[v] - mesh.origin;
      }
      ids.exact_of[v] = exact;
    }
  });
  return ids;
}

/// A triangle in canonical form: rotated so that its smallest exact vertex comes first; sorted by these fields.
struct CanonicalTriangle {
  std::array<std::uint32_t, 3> exact;  ///< ids of (exact position, attributes): what tells duplicates apart
  std::uint32_t material;              ///< and gap; among duplicates that with the narrowest gap is sorted first
  bool operator<(const CanonicalTriangle& other) const {
    const auto key = [](const CanonicalTriangle& t) {
      return std::tuple(t.exact, material_of(t.material), 255U - gap_pair_of(t.material).byte());
    };
    return key(*this) < key(other);
  }
  [[nodiscard]] bool is_duplicate_of(const CanonicalTriangle& other) const {
    return exact == other.exact && material_of(material) == material_of(other.material);
  }
};

/// In order, and each once; counts what was there more often. By counting: a vertex is the smallest one of a handful.
UnsetVector<CanonicalTriangle> weld_triangles(const Corners& corners, std::span<const std::uint32_t> exact_of,
                                              std::size_t exact_count, std::uint64_t& duplicates) {
  const std::size_t count = corners.materials.size();
  const auto corners_of = [&](std::size_t t) {
    const std::uint32_t* c = &corners.triangles[3 * t];
    return std::array{exact_of[c[0]], exact_of[c[1]], exact_of[c[2]]};
  };
  std::vector<std::uint32_t> end(exact_count + 1, 0);  // of each vertex's triangles, once they are in place
  for (std::size_t t = 0; t < count; ++t) {
    const std::array<std::uint32_t, 3> exact = corners_of(t);
    ++end[*std::min_element(exact.begin(), exact.end()) + 1];
  }
  std::partial_sum(end.begin(), end.end(), end.begin());
  UnsetVector<CanonicalTriangle> triangles(count);
  for (std::size_t t = 0; t < count; ++t) {
    std::array<std::uint32_t, 3> exact = corners_of(t);
    std::rotate(exact.begin(), std::min_element(exact.begin(), exact.end()), exact.end());
    triangles[end[exact[0]]++] = {exact, corners.materials[t]};
  }
  parallel_for_each_chunk(exact_count, kLoopGrain, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; ++v) {
      std::sort(triangles.begin() + (v == 0 ? 0 : end[v - 1]), triangles.begin() + end[v]);
    }
  });
  const auto unique_end =
      std::unique(triangles.begin(), triangles.end(),
                  [](const CanonicalTriangle& a, const CanonicalTriangle& b) { return a.is_duplicate_of(b); });
  duplicates = static_cast<std::uint64_t>(triangles.end() - unique_end);
  triangles.erase(unique_end, triangles.end());
  return triangles;
}

/// On the grid, decided exactly.
bool has_area(const PreparedMesh& mesh, const WedgeTriangle& triangle) {
  const Vec3i& a = mesh.positions[mesh.wedge_position[triangle[0]]];
  const Vec3i& b = mesh.positions[mesh.wedge_position[triangle[1]]];
  const Vec3i& c = mesh.positions[mesh.wedge_position[triangle[2]]];
  // |coordinates| < 2^24, so each product is below 2^50 and the cross product is exact in int64.
  const glm::i64vec3 ab(b - a);
  const glm::i64vec3 ac(c - a);
  return ab.y * ac.z != ab.z * ac.y || ab.z * ac.x != ab.x * ac.z || ab.x * ac.y != ab.y * ac.x;
}

void keep_flat_normals(const Corners& corners, const std::vector<std::uint8_t>& is_used,
                       std::span<const std::uint32_t> exact_of, std::span<const CanonicalTriangle> triangles,
                       PreparedMesh& mesh) {
  std::vector<std::uint32_t> vertex_of(mesh.exact_positions.size());
  for (std::uint32_t v = 0; v < is_used.size(); ++v) {
    if (is_used[v] != 0) vertex_of[exact_of[v]] = v;
  }
  mesh.exact_normals.resize(triangles.size());
  parallel_for_each_index(triangles.size(), kLoopGrain, [&](std::size_t t) {
    const auto& [a, b, c] = triangles[t].exact;
    mesh.exact_normals[t] =
        flat_normal(corners.positions[vertex_of[a]], corners.positions[vertex_of[b]], corners.positions[vertex_of[c]]);
  });
}

}  // namespace

void weld(const Corners& corners, std::span<const Vec3i> points, const std::vector<std::uint8_t>& is_used,
          bool keeps_normals, PreparedMesh& mesh) {
  const VertexIds ids = weld_vertices(corners, points, is_used, mesh);
  UnsetVector<CanonicalTriangle> triangles =
      weld_triangles(corners, ids.exact_of, mesh.exact_positions.size(), mesh.dropped_duplicate);
  resize_all(triangles.size(), mesh.triangles, mesh.exact_triangles, mesh.triangle_material);
  std::vector<std::uint32_t> collapsed(chunk_count(triangles.size(), kLoopGrain), 0);
  parallel_for_each_chunk(triangles.size(), kLoopGrain, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const CanonicalTriangle& triangle = triangles[t];
      for (std::size_t k = 0; k < 3; ++k) mesh.triangles[t][k] = ids.wedge_of_exact[triangle.exact[k]];
      if (!has_area(mesh, mesh.triangles[t])) ++collapsed[chunk];
      mesh.exact_triangles[t] = triangle.exact;
      mesh.triangle_material[t] = triangle.material;
    }
  });
  for (const std::uint32_t count : collapsed) mesh.grid_collapsed += count;
  if (keeps_normals) keep_flat_normals(corners, is_used, ids.exact_of, triangles, mesh);
  release(triangles);
  mesh.exact_on_grid.resize(ids.wedge_of_exact.size());
  parallel_for_each_index(ids.wedge_of_exact.size(), kLoopGrain, [&](std::size_t exact) {
    mesh.exact_on_grid[exact] = mesh.positions[mesh.wedge_position[ids.wedge_of_exact[exact]]];
  });
}

}  // namespace meshlode::builder
