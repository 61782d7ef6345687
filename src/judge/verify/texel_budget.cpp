// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/texel_budget.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "format/grid.h"

namespace meshlode::judge {

std::vector<std::array<double, scene::kMaxUvSets>> most_texels_of_materials(const scene::Scene& scene) {
  std::vector<std::optional<std::pair<std::uint32_t, std::uint32_t>>> sizes;  // of the blobs
  for (const scene::SceneBlob& blob : scene.blobs) {
    const bool is_image = blob.kind == scene::SceneBlob::Kind::kImage;
    sizes.push_back(is_image ? stated_image_size(blob.bytes) : std::nullopt);
  }
  std::vector<std::array<double, scene::kMaxUvSets>> out(scene.materials.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (const scene::TextureUse& use : scene.materials[i].textures) {
      if (use.blob >= sizes.size() || !sizes[use.blob] || use.uv_set >= scene::kMaxUvSets) continue;
      const double across = std::abs(use.scale[0]) * sizes[use.blob]->first;
      const double down = std::abs(use.scale[1]) * sizes[use.blob]->second;
      const double texels = across < down ? down : across;
      if (std::isfinite(texels) && texels > out[i][use.uv_set]) out[i][use.uv_set] = texels;
    }
  }
  return out;
}

std::array<double, scene::kMaxUvSets> most_texels(std::span<const std::array<double, scene::kMaxUvSets>> of_materials,
                                                  const scene::SourceMesh& mesh) {
  std::array<double, scene::kMaxUvSets> most{};
  for (const scene::Primitive& primitive : mesh.primitives) {
    if (primitive.material.value >= of_materials.size()) continue;
    const auto& own = of_materials[primitive.material.value];
    for (std::size_t set = 0; set < most.size(); ++set) most[set] = std::max(most[set], own[set]);
  }
  return most;
}

std::array<bool, scene::kMaxUvSets> has_finest_step(const run::Asset& asset, MeshId mesh,
                                                    std::span<const run::DecodedCluster> clusters) {
  constexpr std::int64_t kLargestInteger = (std::int64_t{1} << 24U) - 1;
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  const std::size_t first_uv = record.normal_mode == format::NormalMode::kStored ? 6 : 3;
  std::array<bool, scene::kMaxUvSets> is_finest{};
  if (record.uv_set_count == 0) return is_finest;  // vertices end where the first UV would be
  for (const run::DecodedCluster& cluster : clusters.subspan(record.first_cluster, record.cluster_count)) {
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      const std::int32_t* uv = &cluster.channels[std::size_t{v} * cluster.channel_count + first_uv];
      for (std::uint32_t k = 0; k < 2 * record.uv_set_count; ++k) {
        is_finest[k / 2] = is_finest[k / 2] || 2 * std::abs(std::int64_t{uv[k]}) > kLargestInteger;
      }
    }
  }
  return is_finest;
}

void check_texel_budget(const run::Asset& asset, const scene::Scene& source,
                        std::span<const std::optional<double>> texels_of_mesh,
                        std::span<const run::DecodedCluster> clusters, RuleLog& log) {
  constexpr double kRounding = 1.0 + 1e-6;
  const auto of_materials = most_texels_of_materials(source);
  for (std::size_t m = 0; m < asset.meshes().size() && m < source.meshes.size(); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    if (mesh.cluster_count == 0 || mesh.uv_set_count == 0 || !texels_of_mesh[m]) continue;
    const double texels = *texels_of_mesh[m];
    const auto most = most_texels(of_materials, source.meshes[m]);
    const auto is_finest = has_finest_step(asset, MeshId(m), clusters);
    for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
      if (mesh.uv_set_source[set] >= scene::kMaxUvSets) continue;
      const double moved = 0.5 * format::exp2_exact(mesh.uv_log2[set]) * most[mesh.uv_set_source[set]];
      log.expect(
          moved <= texels * kRounding || is_finest[set], Rule::kV113, [&] { return place("mesh", m); },
          [&] { return differs("texels that a UV moves", moved, "uv_error in texels", texels); });
    }
  }
}

}  // namespace meshlode::judge
