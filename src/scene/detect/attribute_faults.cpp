// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/detect/attribute_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "base/disjoint_sets.h"

namespace meshlode::scene {

namespace {

constexpr double kCosSmooth = 0.93969262078590843;  ///< of kSmoothDegrees
constexpr double kCosSame = 0.99996192306417131;    ///< of half a degree: what a build takes for flat
constexpr std::uint64_t kFewestIslands = 16;
constexpr std::uint64_t kTrianglesPerIsland = 64;
constexpr double kTrianglesPerCluster = 128.0;

double asset_bytes_of(const Topology& topology) {
  return kBytesPerTriangle * static_cast<double>(std::max<std::size_t>(1, topology.triangles.size()));
}

void add_bytes(const Topology& topology, std::uint64_t wedges, Fault& fault) {
  const double bytes = kBytesPerWedge * static_cast<double>(wedges);
  fault.costs.push_back(
      {CostKind::kBytes, CostUnit::kAssetBytes, bytes, std::min(1.0, bytes / asset_bytes_of(topology))});
}

void add_triangles(CostKind kind, const ConcernedTriangles& concerned, Fault& fault) {
  concerned.list_in(fault);
  fault.costs.push_back({kind, CostUnit::kTriangles, static_cast<double>(concerned.count()), concerned.share()});
}

std::uint32_t uv_sets_of(const Primitive& primitive, std::span<const SceneMaterial> materials) {
  return primitive.material.value < materials.size() ? materials[primitive.material.value].uv_sets_used : 0;
}

/// Whether the angle between two vectors of any length is at most that of the cosine.
bool is_within(double cosine, const Vec3d& a, const Vec3d& b) {
  return glm::dot(a, b) >= cosine * std::sqrt(glm::dot(a, a)) * std::sqrt(glm::dot(b, b));
}

/// The normals of a mesh by corner.
class CornerNormals {
 public:
  CornerNormals(const SourceMesh& mesh, const Topology& topology) : mesh_(mesh), topology_(topology) {}
  [[nodiscard]] bool has(std::uint32_t triangle, std::uint32_t corner) const {
    const std::uint32_t primitive = topology_.primitive_of(triangle);
    return local(primitive, triangle, corner) < mesh_.primitives[primitive].normals.size();
  }
  [[nodiscard]] const Vec3f& at(std::uint32_t triangle, std::uint32_t corner) const {
    const std::uint32_t primitive = topology_.primitive_of(triangle);
    return mesh_.primitives[primitive].normals[local(primitive, triangle, corner)];
  }

 private:
  [[nodiscard]] std::uint32_t local(std::uint32_t primitive, std::uint32_t triangle, std::uint32_t corner) const {
    return topology_.vertices[triangle][corner] - topology_.first_vertex[primitive];
  }
  const SourceMesh& mesh_;
  const Topology& topology_;
};

bool is_flat(const CornerNormals& normals, const Topology& topology) {
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    const Vec3d own = topology.area_normal(t);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (normals.has(t, k) && !is_within(kCosSame, own, Vec3d(normals.at(t, k)))) return false;
    }
  }
  return true;
}

/// Corners of one point that smooth edges join are one set; ids are 3 · triangle + corner.
DisjointSets join_smooth_corners(const Topology& topology) {
  DisjointSets fans(3 * topology.triangles.size());
  topology.for_each_edge([&](std::span<const TopologyEdge> edge) {
    if (edge.size() != 2 || edge[0].is_forward == edge[1].is_forward) return;
    if (!is_within(kCosSmooth, topology.area_normal(edge[0].triangle), topology.area_normal(edge[1].triangle))) return;
    const auto join = [&](std::uint32_t first, std::uint32_t second) {
      fans.join(3 * edge[0].triangle + first, 3 * edge[1].triangle + second);
    };
    join(edge[0].corner_low(), edge[1].corner_low());
    join(edge[0].corner_high(), edge[1].corner_high());
  });
  return fans;
}

/// How a UV set lies on the surface.
struct Islands {
  std::uint64_t triangles = 0, islands = 0, pieces = 0, seams = 0;
  [[nodiscard]] bool are_too_many() const {
    const std::uint64_t more = islands - pieces;  // each piece has an island
    return more >= kFewestIslands && more * kTrianglesPerIsland >= triangles;
  }
};

class UvSet {
 public:
  UvSet(const SourceMesh& mesh, const Topology& topology, std::span<const SceneMaterial> materials, std::uint32_t set)
      : mesh_(mesh), topology_(topology), set_(set) {
    for (const Primitive& primitive : mesh.primitives) {
      const bool is_used = (uv_sets_of(primitive, materials) >> set & 1U) != 0;
      is_used_.push_back(is_used && primitive.uvs[set].size() >= primitive.positions.size() ? 1 : 0);
    }
  }
  [[nodiscard]] bool has(std::uint32_t triangle) const {
    return topology_.kinds[triangle] == TriangleKind::kSound && is_used_[topology_.primitive_of(triangle)] != 0;
  }
  [[nodiscard]] const Vec2f& at(std::uint32_t triangle, std::uint32_t corner) const {
    const std::uint32_t primitive = topology_.primitive_of(triangle);
    return mesh_.primitives[primitive]
        .uvs[set_][topology_.vertices[triangle][corner] - topology_.first_vertex[primitive]];
  }
  [[nodiscard]] Islands count(ConcernedTriangles& at_seams) const;

 private:
  const SourceMesh& mesh_;
  const Topology& topology_;
  std::uint32_t set_;
  std::vector<std::uint8_t> is_used_;  ///< by primitive
};

Islands UvSet::count(ConcernedTriangles& at_seams) const {
  Islands out;
  for (std::uint32_t t = 0; t < topology_.triangles.size(); ++t) out.triangles += has(t) ? 1U : 0U;
  if (out.triangles == 0) return out;
  DisjointSets islands(topology_.triangles.size()), pieces(topology_.triangles.size());
  out.islands = out.pieces = out.triangles;
  topology_.for_each_edge([&](std::span<const TopologyEdge> edge) {
    if (edge.size() != 2) return;
    const TopologyEdge &a = edge[0], &b = edge[1];
    if (!has(a.triangle) || !has(b.triangle)) return;
    out.pieces -= pieces.join(a.triangle, b.triangle) ? 1U : 0U;
    if (at(a.triangle, a.corner_low()) == at(b.triangle, b.corner_low()) &&
        at(a.triangle, a.corner_high()) == at(b.triangle, b.corner_high())) {
      out.islands -= islands.join(a.triangle, b.triangle) ? 1U : 0U;
      return;
    }
    ++out.seams;
    at_seams.mark(a.triangle);
    at_seams.mark(b.triangle);
  });
  return out;
}

}  // namespace

Fault find_split_normals(const SourceMesh& mesh, const Topology& topology) {
  Fault fault = fault_of(FaultKind::kSplitNormals);
  const CornerNormals normals(mesh, topology);
  if (is_flat(normals, topology)) return fault;
  struct Corner {
    std::uint32_t fan, id;
    Vec3f normal;
  };
  std::vector<Corner> corners;
  DisjointSets fans = join_smooth_corners(topology);
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (!normals.has(t, k)) continue;
      const Vec3f& n = normals.at(t, k);
      if (!std::isfinite(n.x) || !std::isfinite(n.y) || !std::isfinite(n.z)) continue;
      corners.push_back({fans.find(3 * t + k), 3 * t + k, n});
    }
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::tie(a.fan, a.normal.x, a.normal.y, a.normal.z, a.id) <
           std::tie(b.fan, b.normal.x, b.normal.y, b.normal.z, b.id);
  });
  ConcernedTriangles concerned(topology);
  for (std::size_t first = 0, end = 0; first < corners.size(); first = end) {
    // Normals that differ in their last bits lie side by side in the order.
    std::uint64_t more = 0;
    for (std::size_t last = first; end < corners.size() && corners[end].fan == corners[first].fan; ++end) {
      if (is_within(kCosSame, Vec3d(corners[last].normal), Vec3d(corners[end].normal))) continue;
      ++more;
      last = end;
    }
    for (std::size_t i = first; more > 0 && i < end; ++i) concerned.mark(corners[i].id / 3);
    fault.count += more;
  }
  if (fault.count == 0 || fault.count * kOneInAHundred < topology.points.size()) {
    return fault_of(FaultKind::kSplitNormals);
  }
  fault.measure = static_cast<double>(topology.points.size());
  add_bytes(topology, fault.count, fault);
  add_triangles(CostKind::kTime, concerned, fault);
  return fault;
}

Fault find_uv_islands(const SourceMesh& mesh, const Topology& topology, std::span<const SceneMaterial> materials) {
  Fault worst = fault_of(FaultKind::kUvIslands);
  std::uint64_t most = 0;
  for (std::uint32_t set = 0; set < kMaxUvSets; ++set) {
    ConcernedTriangles at_seams(topology);
    const Islands islands = UvSet(mesh, topology, materials, set).count(at_seams);
    if (!islands.are_too_many() || islands.islands - islands.pieces <= most) continue;
    most = islands.islands - islands.pieces;
    worst = fault_of(FaultKind::kUvIslands);
    worst.count = islands.islands;
    worst.measure = static_cast<double>(islands.pieces);
    add_bytes(topology, islands.seams, worst);
    add_triangles(CostKind::kTime, at_seams, worst);
  }
  return worst;
}

Fault find_missing_uvs(const SourceMesh& mesh, const Topology& topology, std::span<const SceneMaterial> materials) {
  Fault fault = fault_of(FaultKind::kMissingUvs);
  ConcernedTriangles concerned(topology);
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const Primitive& primitive = mesh.primitives[p];
    if (primitive.indices.empty()) continue;
    bool is_missing = false;
    for (std::uint32_t set = 0; set < kMaxUvSets; ++set) {
      const bool is_used = (uv_sets_of(primitive, materials) >> set & 1U) != 0;
      is_missing = is_missing || (is_used && primitive.uvs[set].empty());
    }
    if (!is_missing) continue;
    ++fault.count;
    for (std::uint32_t t = topology.first_triangle[p]; t < topology.first_triangle[p + 1]; ++t) concerned.mark(t);
  }
  if (fault.count > 0) add_triangles(CostKind::kAccuracy, concerned, fault);
  return fault;
}

Fault find_unused_uvs(const SourceMesh& mesh, const Topology& topology, std::span<const SceneMaterial> materials) {
  Fault fault = fault_of(FaultKind::kUnusedUvs);
  double bytes = 0.0, all = 0.0;
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const Primitive& primitive = mesh.primitives[p];
    const std::uint32_t used = uv_sets_of(primitive, materials);
    std::uint64_t unused = 0, of_uvs = 0;
    for (std::uint32_t set = 0; set < kMaxUvSets; ++set) {
      of_uvs += primitive.uvs[set].size() * sizeof(Vec2f);
      if ((used >> set & 1U) != 0 || primitive.uvs[set].empty()) continue;
      ++fault.count;
      unused += primitive.uvs[set].size() * sizeof(Vec2f);
    }
    if (unused > 0) fault.triangle_count += topology.first_triangle[p + 1] - topology.first_triangle[p];
    bytes += static_cast<double>(unused);
    // As glTF stores them: positions and normals of three floats, colours of four.
    all += static_cast<double>(of_uvs + primitive.positions.size() * 12 + primitive.normals.size() * 12 +
                               primitive.colors.size() * 16 + primitive.indices.size() * 4);
  }
  // A twentieth: no asset has them.
  if (fault.count > 0) {
    fault.costs.push_back({CostKind::kBytes, CostUnit::kSourceBytes, bytes, 0.05 * bytes / std::max(1.0, all)});
  }
  return fault;
}

Fault find_many_materials(const SourceMesh& mesh, const Topology& topology) {
  Fault fault = fault_of(FaultKind::kManyMaterials);
  std::set<std::uint32_t> materials;
  for (const Primitive& primitive : mesh.primitives) {
    if (!primitive.indices.empty()) materials.insert(primitive.material.value);
  }
  if (materials.size() < kManyMaterials) return fault;
  const auto material_of = [&](std::uint32_t triangle) {
    return mesh.primitives[topology.primitive_of(triangle)].material.value;
  };
  ConcernedTriangles concerned(topology);
  topology.for_each_edge([&](std::span<const TopologyEdge> edge) {
    for (const TopologyEdge& one : edge) {
      if (material_of(one.triangle) == material_of(edge[0].triangle)) continue;
      concerned.mark(one.triangle);
      concerned.mark(edge[0].triangle);
    }
  });
  fault.count = materials.size();
  fault.measure = static_cast<double>(concerned.count());
  concerned.list_in(fault);
  // A border between materials is locked as a seam is; and of few triangles each, every material is a draw of its own.
  const double clusters = std::max(1.0, static_cast<double>(topology.triangles.size()) / kTrianglesPerCluster);
  const double draws = std::min(1.0, static_cast<double>(fault.count) / clusters);
  fault.costs.push_back({CostKind::kTime, CostUnit::kTriangles, static_cast<double>(concerned.count()),
                         std::max(concerned.share(), 0.1 * draws)});
  return fault;
}

}  // namespace meshlode::scene
