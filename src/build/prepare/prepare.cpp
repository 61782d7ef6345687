// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/prepare/prepare.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <tuple>

#include <tbb/parallel_sort.h>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "build/prepare/separate_needles.h"
#include "build/prepare/zero_area.h"

namespace meshlode::build {

namespace {

/// The source's primitives as one list of corners. `vertex` ids run over all primitives.
struct Corners {
  std::vector<Vec3d> positions;          ///< per vertex, object units
  std::vector<float> attributes;         ///< per vertex, stride floats
  std::vector<std::uint32_t> triangles;  ///< 3 vertex ids each
  std::vector<std::uint32_t> materials;  ///< per triangle
};

float canonical_zero(float value) { return value == 0.0F ? 0.0F : value; }

Vec3f flat_normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d cross = glm::cross(b - a, c - a);
  const double length = std::sqrt(glm::dot(cross, cross));
  return length > 0.0 && std::isfinite(length) ? Vec3f(cross / length) : Vec3f(0.0F, 0.0F, 1.0F);
}

void append_vertex(const scene::Primitive& primitive, std::uint32_t vertex, const Vec3f& normal, const AttributeLayout& layout,
                   Corners& out) {
  out.positions.push_back(primitive.positions[vertex] + 0.0);  // + 0.0 turns -0 into 0
  if (layout.has_normal) {
    for (int k = 0; k < 3; ++k) out.attributes.push_back(canonical_zero(normal[k]));
  }
  for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
    const std::vector<Vec2f>& uvs = primitive.uvs[layout.uv_set_source[set]];
    const Vec2f uv = uvs.empty() ? Vec2f(0.0F) : uvs[vertex];
    out.attributes.push_back(canonical_zero(uv.x));
    out.attributes.push_back(canonical_zero(uv.y));
  }
  if (layout.has_color) {
    const Vec4f color = primitive.colors.empty() ? Vec4f(1.0F) : primitive.colors[vertex];
    for (int k = 0; k < 4; ++k) out.attributes.push_back(canonical_zero(color[k]));
  }
}

Corners gather_corners(const scene::SourceMesh& mesh, const AttributeLayout& layout) {
  Corners out;
  for (const scene::Primitive& primitive : mesh.primitives) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    const std::size_t triangle_count = primitive.indices.size() / 3;
    if (layout.has_normal && primitive.normals.empty()) {
      // Flat normals, as glTF asks for: every corner becomes a vertex of its own.
      for (std::size_t t = 0; t < triangle_count; ++t) {
        const std::uint32_t* corner = &primitive.indices[3 * t];
        const Vec3f normal = flat_normal(primitive.positions[corner[0]], primitive.positions[corner[1]],
                                         primitive.positions[corner[2]]);
        for (std::size_t k = 0; k < 3; ++k) {
          append_vertex(primitive, corner[k], normal, layout, out);
          out.triangles.push_back(first + static_cast<std::uint32_t>(3 * t + k));
        }
      }
    } else {
      for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
        const Vec3f normal = layout.has_normal ? primitive.normals[v] : Vec3f(0.0F);
        append_vertex(primitive, static_cast<std::uint32_t>(v), normal, layout, out);
      }
      for (const std::uint32_t index : primitive.indices) out.triangles.push_back(first + index);
    }
    out.materials.insert(out.materials.end(), triangle_count, primitive.material.value);
  }
  return out;
}

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
  const auto axis = [](int value) { return static_cast<std::uint64_t>(value + (format::kMaxGridCoordinate + 1)) >> 3U; };
  return spread3(axis(q.x)) | spread3(axis(q.y)) << 1U | spread3(axis(q.z)) << 2U;
}

auto as_tuple(const Vec3i& q) { return std::tuple(q.x, q.y, q.z); }

/// Orders attribute sets by their bits: any total order will do, it has to be the same everywhere.
int compare_attributes(const float* a, const float* b, std::uint32_t stride) {
  return stride == 0 ? 0 : std::memcmp(a, b, stride * sizeof(float));
}

/// Takes the triangles away that are no part of the source; returns how many.
std::uint64_t drop_undrawn(Corners& corners) {
  const std::vector<std::uint8_t> is_undrawn = find_undrawn(corners.positions, corners.triangles);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < is_undrawn.size(); ++t) {
    if (is_undrawn[t] != 0) continue;
    for (std::size_t k = 0; k < 3; ++k) corners.triangles[3 * kept + k] = corners.triangles[3 * t + k];
    corners.materials[kept++] = corners.materials[t];
  }
  corners.triangles.resize(3 * kept);
  corners.materials.resize(kept);
  return is_undrawn.size() - kept;
}

double median_edge_length(const Corners& corners) {
  // A sample of the edges is enough to choose a power of two.
  std::vector<double> lengths2;
  const std::size_t triangle_count = corners.materials.size();
  const std::size_t stride = std::max<std::size_t>(1, triangle_count / 20000);
  for (std::size_t t = 0; t < triangle_count; t += stride) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d edge = corners.positions[corners.triangles[3 * t + k]] -
                         corners.positions[corners.triangles[3 * t + (k + 1) % 3]];
      const double length2 = glm::dot(edge, edge);
      if (length2 > 0.0) lengths2.push_back(length2);
    }
  }
  if (lengths2.empty()) return 0.0;
  const auto middle = lengths2.begin() + static_cast<std::ptrdiff_t>(lengths2.size() / 2);
  std::nth_element(lengths2.begin(), middle, lengths2.end());
  return std::sqrt(*middle);
}

/// Vertex ids sorted by Z-order of the grid point, then the point, then attributes, then exact position: equal wedges,
/// positions and source points become runs, whatever their numbers were.
std::vector<std::uint32_t> canonical_vertex_order(const Corners& corners, const std::vector<Vec3i>& quantized,
                                                  std::uint32_t stride) {
  std::vector<std::uint64_t> keys(quantized.size());
  parallel_for_each_index(keys.size(), 4096, [&](std::size_t i) { keys[i] = morton(quantized[i]); });
  std::vector<std::uint32_t> order(quantized.size());
  std::iota(order.begin(), order.end(), 0U);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (keys[a] != keys[b]) return keys[a] < keys[b];
    if (quantized[a] != quantized[b]) return as_tuple(quantized[a]) < as_tuple(quantized[b]);
    const int attributes = compare_attributes(corners.attributes.data() + std::size_t{a} * stride,
                                              corners.attributes.data() + std::size_t{b} * stride, stride);
    if (attributes != 0) return attributes < 0;
    const Vec3d& p = corners.positions[a];
    const Vec3d& q = corners.positions[b];
    if (p != q) return std::tuple(p.x, p.y, p.z) < std::tuple(q.x, q.y, q.z);
    return a < b;
  });
  return order;
}

std::uint64_t count_pieces(const PreparedMesh& mesh) {
  DisjointSets pieces(mesh.positions.size());
  std::vector<std::uint8_t> is_used(mesh.positions.size(), 0);
  std::uint64_t count = 0;
  const auto use = [&](std::uint32_t position) {
    count += is_used[position] == 0 ? 1 : 0;
    is_used[position] = 1;
  };
  for (const WedgeTriangle& triangle : mesh.triangles) {
    const std::uint32_t first = mesh.wedge_position[triangle[0]];
    use(first);
    for (const std::uint32_t wedge : {triangle[1], triangle[2]}) {
      use(mesh.wedge_position[wedge]);
      count -= pieces.join(first, mesh.wedge_position[wedge]) ? 1 : 0;
    }
  }
  return count;
}

/// A triangle in canonical form: rotated so that its smallest exact vertex comes first; sorted by these fields.
struct CanonicalTriangle {
  std::array<std::uint32_t, 3> exact;  ///< ids of (exact position, attributes): what tells duplicates apart
  std::uint32_t material;
  auto operator<=>(const CanonicalTriangle&) const = default;
};

}  // namespace

Result<PreparedMesh> prepare_mesh(const scene::SourceMesh& source, const AttributeLayout& layout, const PrepareOptions& options) {
  PreparedMesh mesh;
  mesh.name = source.name;
  mesh.layout = layout;
  mesh.dropped_repaired = source.drops.repaired;
  for (const scene::Primitive& primitive : source.primitives) {
    mesh.source_triangles += primitive.indices.size() / 3;
    mesh.source_vertices += primitive.positions.size();
  }
  mesh.source_triangles += source.drops.repaired;

  Corners corners = gather_corners(source, layout);
  const std::uint32_t stride = layout.stride();
  for (const std::uint32_t vertex : corners.triangles) {
    const Vec3d& p = corners.positions[vertex];
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) {
      return Error{ErrorCode::kInvalid, "mesh '" + source.name + "'", "a position is not finite"};
    }
  }
  mesh.dropped_degenerate = drop_undrawn(corners);
  if (corners.triangles.empty()) return mesh;

  // Bounds over the vertices that the source's triangles use, so that stray points do not coarsen the grid.
  Vec3d low(std::numeric_limits<double>::infinity());
  Vec3d high(-std::numeric_limits<double>::infinity());
  for (const std::uint32_t vertex : corners.triangles) {
    low = glm::min(low, corners.positions[vertex]);
    high = glm::max(high, corners.positions[vertex]);
  }

  const Vec3d half = (high - low) * 0.5;
  mesh.diagonal = 2.0 * std::sqrt(glm::dot(half, half));
  if (!std::isfinite(mesh.diagonal)) {
    return Error{ErrorCode::kUnsupported, "mesh '" + source.name + "'", "its extent overflows a double when squared"};
  }
  const double largest_half = std::max({half.x, half.y, half.z});
  Result<format::PositionGrid> grid = choose_grid(largest_half, mesh.diagonal, median_edge_length(corners), options);
  if (!grid) return Error{grid.error().code, "mesh '" + source.name + "'", grid.error().detail};
  mesh.grid = *grid;
  // The origin lies on the grid through zero, so that meshes built with the same step abut.
  const double step = mesh.grid.step();
  for (int k = 0; k < 3; ++k) mesh.origin[k] = std::floor((low[k] + half[k]) / step + 0.5) * step;

  std::vector<Vec3i> quantized(corners.positions.size(), Vec3i(0));
  std::vector<std::uint8_t> is_used(corners.positions.size(), 0);
  for (const std::uint32_t vertex : corners.triangles) is_used[vertex] = 1;
  std::vector<Vec3d> relative(corners.positions.size(), Vec3d(0.0));
  for (std::size_t v = 0; v < quantized.size(); ++v) {
    if (is_used[v] == 0) continue;
    relative[v] = corners.positions[v] - mesh.origin;
    quantized[v] = mesh.grid.quantize(relative[v]);
  }
  // Meshes that must abut share nothing but the grid: there each vertex goes to its own point and nowhere else.
  if (!(options.grid_step > 0.0)) separate_needles(relative, corners.triangles, mesh.grid, quantized);
  double deviation2 = 0.0;
  for (std::size_t v = 0; v < quantized.size(); ++v) {
    if (is_used[v] == 0) continue;
    const Vec3d moved = mesh.grid.decode(quantized[v]) - relative[v];
    deviation2 = std::max(deviation2, glm::dot(moved, moved));
  }
  mesh.level0_deviation = std::sqrt(deviation2);

  // Runs of the canonical order give each vertex three ids: exact (position and attributes as in the source), wedge
  // (grid point and attributes) and position (grid point).
  const std::vector<std::uint32_t> order = canonical_vertex_order(corners, quantized, stride);
  std::vector<std::uint32_t> exact_of(order.size());
  std::vector<std::uint32_t> wedge_of_exact;
  {
    std::uint32_t previous = 0;
    bool has_previous = false;
    for (const std::uint32_t v : order) {
      if (is_used[v] == 0) continue;
      const bool same_point = has_previous && quantized[v] == quantized[previous];
      const bool same_wedge = same_point && compare_attributes(corners.attributes.data() + std::size_t{v} * stride,
                                                               corners.attributes.data() + std::size_t{previous} * stride,
                                                               stride) == 0;
      const bool same_exact = same_wedge && corners.positions[v] == corners.positions[previous];
      if (!same_point) mesh.positions.push_back(quantized[v]);
      if (!same_wedge) {
        mesh.wedge_position.push_back(static_cast<std::uint32_t>(mesh.positions.size() - 1));
        mesh.wedge_attributes.insert(mesh.wedge_attributes.end(),
                                     corners.attributes.begin() + static_cast<std::ptrdiff_t>(std::size_t{v} * stride),
                                     corners.attributes.begin() + static_cast<std::ptrdiff_t>((std::size_t{v} + 1) * stride));
      }
      if (!same_exact) {
        wedge_of_exact.push_back(static_cast<std::uint32_t>(mesh.wedge_position.size() - 1));
        mesh.exact_positions.push_back(corners.positions[v] - mesh.origin);
      }
      exact_of[v] = static_cast<std::uint32_t>(wedge_of_exact.size() - 1);
      previous = v;
      has_previous = true;
    }
  }

  std::vector<CanonicalTriangle> triangles;
  triangles.reserve(corners.materials.size());
  for (std::size_t t = 0; t < corners.materials.size(); ++t) {
    const std::uint32_t* c = &corners.triangles[3 * t];
    std::array<std::uint32_t, 3> exact{exact_of[c[0]], exact_of[c[1]], exact_of[c[2]]};
    std::rotate(exact.begin(), std::min_element(exact.begin(), exact.end()), exact.end());
    triangles.push_back({exact, corners.materials[t]});
  }
  tbb::parallel_sort(triangles.begin(), triangles.end());
  const auto unique_end = std::unique(triangles.begin(), triangles.end());
  mesh.dropped_duplicate = static_cast<std::uint64_t>(triangles.end() - unique_end);
  triangles.erase(unique_end, triangles.end());

  mesh.triangles.reserve(triangles.size());
  mesh.exact_triangles.reserve(triangles.size());
  mesh.triangle_material.reserve(triangles.size());
  for (const CanonicalTriangle& triangle : triangles) {
    WedgeTriangle wedges{};
    for (std::size_t k = 0; k < 3; ++k) wedges[k] = wedge_of_exact[triangle.exact[k]];
    const Vec3i& a = mesh.positions[mesh.wedge_position[wedges[0]]];
    const Vec3i& b = mesh.positions[mesh.wedge_position[wedges[1]]];
    const Vec3i& c = mesh.positions[mesh.wedge_position[wedges[2]]];
    // |coordinates| < 2^24, so each product is below 2^50 and the cross product is exact in int64.
    const glm::i64vec3 ab(b - a);
    const glm::i64vec3 ac(c - a);
    const bool has_area = ab.y * ac.z != ab.z * ac.y || ab.z * ac.x != ab.x * ac.z || ab.x * ac.y != ab.y * ac.x;
    if (!has_area) ++mesh.grid_collapsed;
    mesh.triangles.push_back(wedges);
    mesh.exact_triangles.push_back(triangle.exact);
    mesh.triangle_material.push_back(triangle.material);
  }
  mesh.piece_count = count_pieces(mesh);
  return mesh;
}

}  // namespace meshlode::build
