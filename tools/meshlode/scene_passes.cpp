// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_passes.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace meshlode::cli {

namespace {

bool is_mask(const scene::SceneMaterial& material) {
  return material.alpha_mode == scene::AlphaMode::kMask && material.alpha_cutoff > 0.0F;
}

bool has_texture(const scene::SceneMaterial& material) {
  return std::any_of(material.textures.begin(), material.textures.end(), [](const scene::TextureUse& use) {
    return use.role == scene::TextureRole::kBaseColor || use.role == scene::TextureRole::kNormal;
  });
}

/// Of all levels: twice the source's triangles.
std::uint64_t estimate_clusters(const app::PlannedMesh& mesh, std::uint32_t cluster_triangles) {
  if (mesh.triangles == 0) return 0;
  return mesh.is_whole ? 1 : 2 * mesh.triangles / cluster_triangles + 1;
}

}  // namespace

draw::PassPlan plan_scene_passes(const scene::Scene& scene, const app::ScenePlan& plan,
                                 std::uint32_t cluster_triangles) {
  draw::PassFacts facts;
  facts.instance_count = static_cast<std::uint32_t>(
      std::min<std::size_t>(scene.instances.size(), std::numeric_limits<std::uint32_t>::max()));
  for (const scene::SceneInstance& instance : scene.instances) {
    const app::PlannedMesh& mesh = plan.meshes[instance.mesh.value];
    facts.cluster_instances += estimate_clusters(mesh, cluster_triangles);
    facts.has_single_root = facts.has_single_root || mesh.triangles > 0;
  }
  facts.has_double_sided = std::any_of(scene.materials.begin(), scene.materials.end(),
                                       [](const scene::SceneMaterial& m) { return m.double_sided; });
  facts.has_alpha_mask = std::any_of(scene.materials.begin(), scene.materials.end(), is_mask);
  facts.has_textures = std::any_of(scene.materials.begin(), scene.materials.end(), has_texture);
  return *draw::plan_passes(facts, {}, 0, 0, {}, true);  // nothing is forced: there is no error
}

}  // namespace meshlode::cli
