// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/texel_budget.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "format/grid.h"

namespace meshlode::judge {

namespace {

using Json = nlohmann::json;

/// A value by its path, or null.
const Json& at(const Json& value, const char* key) {
  static const Json nothing;
  return value.is_object() && value.contains(key) ? value[key] : nothing;
}
const Json& at(const Json& value, const Json& index) {
  static const Json nothing;
  return value.is_array() && index.is_number_unsigned() && index.get<std::size_t>() < value.size()
             ? value[index.get<std::size_t>()]
             : nothing;
}

struct TextureUse {
  std::uint64_t set;
  double texels;
};

using ImageSizes = std::map<std::size_t, std::optional<std::pair<std::uint32_t, std::uint32_t>>>;

/// What a unit of texture coordinates crosses in the texture that `info` (a glTF textureInfo) names. `sizes`: of images
/// that were looked at already, by blob.
std::optional<TextureUse> texture_use(const scene::Scene& scene, const Json& document, const Json& info,
                                      ImageSizes& sizes) {
  const Json& image = at(at(document, "images"), at(at(at(document, "textures"), at(info, "index")), "source"));
  const Json& blob = at(image, "blob");
  if (!blob.is_number_unsigned() || blob.get<std::size_t>() >= scene.blobs.size()) return std::nullopt;
  const auto [known, is_new] = sizes.try_emplace(blob.get<std::size_t>());
  if (is_new) known->second = stated_image_size(scene.blobs[known->first].bytes);
  const auto& size = known->second;
  if (!size) return std::nullopt;
  TextureUse use{0, 0.0};
  const Json& transform = at(at(info, "extensions"), "KHR_texture_transform");
  for (const Json* const place : {&info, &transform}) {
    const Json& set = at(*place, "texCoord");
    if (set.is_null()) continue;
    if (!set.is_number_unsigned()) return std::nullopt;
    use.set = set.get<std::uint64_t>();
  }
  const Json& scale = at(transform, "scale");
  const bool is_scaled = scale.is_array() && scale.size() == 2 && scale[0].is_number() && scale[1].is_number();
  const double across = size->first * (is_scaled ? std::abs(scale[0].get<double>()) : 1.0);
  const double down = size->second * (is_scaled ? std::abs(scale[1].get<double>()) : 1.0);
  use.texels = std::max(across, down);
  return use;
}

}  // namespace

std::vector<std::array<double, scene::kMaxUvSets>> most_texels_of_materials(const scene::Scene& scene) {
  const Json document = Json::parse(scene.document, nullptr, false);
  ImageSizes sizes;
  std::vector<std::array<double, scene::kMaxUvSets>> out(scene.materials.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    std::array<double, scene::kMaxUvSets>& most = out[i];
    // Whatever an extension calls its textures, a textureInfo has an index.
    std::vector<const Json*> open{&at(at(document, "materials"), Json(scene.materials[i].source_index))};
    while (!open.empty()) {
      const Json& value = *open.back();
      open.pop_back();
      if (!value.is_structured()) continue;
      for (const Json& inner : value) open.push_back(&inner);
      const auto use = texture_use(scene, document, value, sizes);
      if (use && use->set < scene::kMaxUvSets && std::isfinite(use->texels))
        most[use->set] = std::max(most[use->set], use->texels);
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
  constexpr std::int64_t kLargest = (std::int64_t{1} << 24U) - 1;
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  const std::size_t first_uv = record.normal_mode == format::NormalMode::kStored ? 6 : 3;
  std::array<bool, scene::kMaxUvSets> is_finest{};
  for (const run::DecodedCluster& cluster : clusters.subspan(record.first_cluster, record.cluster_count)) {
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      const std::int32_t* uv = &cluster.channels[std::size_t{v} * cluster.channel_count + first_uv];
      for (std::uint32_t k = 0; k < 2 * record.uv_set_count; ++k) {
        is_finest[k / 2] = is_finest[k / 2] || 2 * std::abs(std::int64_t{uv[k]}) > kLargest;
      }
    }
  }
  return is_finest;
}

void check_texel_budget(const run::Asset& asset, const scene::Scene& source, double texels,
                        std::span<const run::DecodedCluster> clusters, RuleLog& log) {
  constexpr double kRounding = 1.0 + 1e-6;
  const auto of_materials = most_texels_of_materials(source);
  for (std::size_t m = 0; m < asset.meshes().size() && m < source.meshes.size(); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    if (mesh.cluster_count == 0 || mesh.uv_set_count == 0) continue;
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
