// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/detect/detect.h"

#include <algorithm>
#include <string>
#include <utility>

#include "scene/detect/attribute_faults.h"
#include "scene/detect/edge_faults.h"
#include "scene/detect/face_faults.h"
#include "scene/detect/precision_faults.h"
#include "scene/detect/topology.h"

namespace meshlode::scene {

namespace {

/// What one cluster holds by default (I2).
constexpr std::uint64_t kClusterTriangles = 128, kClusterVertices = 256;

bool is_one_cluster(const SourceMesh& mesh) {
  std::uint64_t vertices = 0;
  for (const Primitive& primitive : mesh.primitives) vertices += primitive.positions.size();
  const std::uint64_t triangles = triangles_of(mesh);
  return triangles > 0 && triangles <= kClusterTriangles && vertices <= kClusterVertices;
}

std::vector<std::uint64_t> count_draws(const Scene& scene) {
  std::vector<std::uint64_t> draws(scene.meshes.size(), 0);
  for (const SceneInstance& instance : scene.instances) {
    if (instance.mesh.value < draws.size()) ++draws[instance.mesh.value];
  }
  return draws;
}

void list_mesh(std::size_t mesh, Fault& fault) {
  ++fault.count;
  if (fault.meshes.size() < kMaxListedMeshes) fault.meshes.push_back(static_cast<std::uint32_t>(mesh));
}

double share_of(double part, double whole) {
  return whole > 0.0 ? std::min(1.0, part / whole) : 0.0;
}

/// It costs all that there is: there may be no triangle to count.
Fault find_nothing_to_draw(const Scene& scene, std::uint64_t without_area) {
  Fault fault = fault_of(FaultKind::kNothingToDraw);
  for (const SourceMesh& mesh : scene.meshes) fault.triangle_count += triangles_of(mesh);
  if (fault.triangle_count > without_area) return fault;
  fault.count = 1;
  fault.measure = static_cast<double>(scene.triangles_in_file);
  fault.costs.push_back({CostKind::kAccuracy, CostUnit::kTriangles, static_cast<double>(fault.triangle_count), 1.0});
  return fault;
}

/// However few are missing, the shape is another one: never less than "high".
constexpr double kLeastMissingShare = 0.1;

Fault find_missing_triangles(const Scene& scene) {
  Fault fault = fault_of(FaultKind::kMissing);
  fault.count = fault.triangle_count = count_missing_triangles(scene);
  if (fault.count == 0) return fault;
  fault.measure = static_cast<double>(scene.triangles_in_file);
  const auto missing = static_cast<double>(fault.count);
  fault.costs.push_back({CostKind::kAccuracy, CostUnit::kTriangles, missing,
                         std::max(kLeastMissingShare, share_of(missing, fault.measure))});
  return fault;
}

Fault find_small_meshes(const Scene& scene, const std::vector<std::uint64_t>& draws) {
  Fault fault = fault_of(FaultKind::kSmallMeshes);
  double all = 0.0, small = 0.0, small_draws = 0.0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const double drawn = static_cast<double>(triangles_of(scene.meshes[m])) * static_cast<double>(draws[m]);
    all += drawn;
    if (draws[m] == 0 || !is_one_cluster(scene.meshes[m])) continue;
    small += drawn;
    small_draws += static_cast<double>(draws[m]);
    fault.triangle_count += triangles_of(scene.meshes[m]);
    list_mesh(m, fault);
  }
  if (small_draws < static_cast<double>(kManySmallDraws)) return {};
  fault.measure = small_draws;
  fault.costs.push_back({CostKind::kTime, CostUnit::kTriangles, small, share_of(small, all)});
  return fault;
}

Fault find_undrawn_meshes(const Scene& scene, const std::vector<std::uint64_t>& draws) {
  Fault fault = fault_of(FaultKind::kUndrawnMeshes);
  std::uint64_t all = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const std::uint64_t triangles = triangles_of(scene.meshes[m]);
    all += triangles;
    if (draws[m] > 0 || triangles == 0) continue;
    fault.triangle_count += triangles;
    list_mesh(m, fault);
  }
  if (fault.count == 0) return fault;
  fault.measure = static_cast<double>(fault.triangle_count);
  fault.costs.push_back({CostKind::kBytes, CostUnit::kAssetBytes, kBytesPerTriangle * fault.measure,
                         share_of(fault.measure, static_cast<double>(all))});
  return fault;
}

/// Which images some material samples. Materials that no primitive has count too where variants may choose them.
std::vector<std::uint8_t> find_sampled_images(const Scene& scene) {
  std::vector<std::uint8_t> is_used(scene.materials.size(), 0), is_sampled(scene.blobs.size(), 0);
  const bool has_variants = scene.document.find("KHR_materials_variants") != std::string::npos;
  for (const SourceMesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) {
      if (primitive.material.value < is_used.size()) is_used[primitive.material.value] = 1;
    }
  }
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (is_used[m] == 0 && !has_variants) continue;
    for (const TextureUse& use : scene.materials[m].textures) {
      if (use.blob < is_sampled.size()) is_sampled[use.blob] = 1;
    }
  }
  return is_sampled;
}

Fault find_unsampled_images(const Scene& scene) {
  Fault fault = fault_of(FaultKind::kUnsampledImages);
  const std::vector<std::uint8_t> is_sampled = find_sampled_images(scene);
  double all = 0.0, unsampled = 0.0;
  for (const SourceMesh& mesh : scene.meshes) all += kBytesPerTriangle * static_cast<double>(triangles_of(mesh));
  for (std::size_t b = 0; b < scene.blobs.size(); ++b) {
    const auto bytes = static_cast<double>(scene.blobs[b].bytes.size());
    all += bytes;
    if (scene.blobs[b].kind != SceneBlob::Kind::kImage || is_sampled[b] != 0) continue;
    unsampled += bytes;
    ++fault.count;
  }
  if (fault.count == 0) return fault;
  fault.costs.push_back({CostKind::kBytes, CostUnit::kAssetBytes, unsampled, share_of(unsampled, all)});
  return fault;
}

void keep_found(Fault fault, std::uint32_t mesh, std::vector<Fault>& faults) {
  if (fault.count == 0) return;
  fault.mesh = mesh;
  std::stable_sort(fault.costs.begin(), fault.costs.end(),
                   [](const FaultCost& a, const FaultCost& b) { return a.share > b.share; });
  faults.push_back(std::move(fault));
}

}  // namespace

std::uint64_t triangles_of(const SourceMesh& mesh) {
  std::uint64_t count = 0;
  for (const Primitive& primitive : mesh.primitives) count += primitive.indices.size() / 3;
  return count;
}

std::uint64_t count_missing_triangles(const Scene& scene) {
  std::uint64_t read = 0;
  for (const SourceMesh& mesh : scene.meshes) read += triangles_of(mesh) + mesh.drops.repaired;
  return scene.triangles_in_file > read ? scene.triangles_in_file - read : 0;
}

std::vector<Fault> examine_mesh(const SourceMesh& mesh, std::span<const SceneMaterial> materials) {
  std::vector<Fault> faults;
  if (!is_countable(mesh)) return faults;
  const Topology topology = make_topology(mesh);
  const auto keep = [&](Fault fault) { keep_found(std::move(fault), kNoId, faults); };
  keep(find_not_finite(mesh, topology));
  keep(find_degenerate_faces(topology));
  keep(find_duplicate_faces(topology));
  keep(find_non_manifold_edges(topology));
  keep(find_misoriented(topology));
  keep(find_unwelded_seams(topology));
  keep(find_needles(topology));
  keep(find_error_in_few(topology));
  keep(find_far_from_origin(topology));
  keep(find_finer_than_grid(topology));
  keep(find_split_normals(mesh, topology));
  keep(find_uv_islands(mesh, topology, materials));
  keep(find_missing_uvs(mesh, topology, materials));
  keep(find_unused_uvs(mesh, topology, materials));
  keep(find_many_materials(mesh, topology));
  return faults;
}

std::vector<Fault> examine_scene(const Scene& scene) {
  std::vector<Fault> faults;
  std::uint64_t without_area = 0;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    for (Fault& fault : examine_mesh(scene.meshes[m], scene.materials)) {
      if (fault.kind == FaultKind::kDegenerate) without_area += fault.count;
      keep_found(std::move(fault), m, faults);
    }
  }
  keep_found(find_nothing_to_draw(scene, without_area), kNoId, faults);
  keep_found(find_missing_triangles(scene), kNoId, faults);
  const std::vector<std::uint64_t> draws = count_draws(scene);
  keep_found(find_small_meshes(scene, draws), kNoId, faults);
  keep_found(find_undrawn_meshes(scene, draws), kNoId, faults);
  keep_found(find_unsampled_images(scene), kNoId, faults);
  return faults;
}

}  // namespace meshlode::scene
