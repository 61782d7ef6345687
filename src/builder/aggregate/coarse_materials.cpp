// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/coarse_materials.h"

#include <array>
#include <cstddef>
#include <utility>

#include <nlohmann/json.hpp>

namespace meshlode::builder {

namespace {

using Json = nlohmann::ordered_json;

bool stands_for_itself(const scene::SceneMaterial& material) {
  return material.alpha_mode == scene::AlphaMode::kOpaque && material.double_sided && material.textures.empty();
}

/// What is left of a glTF material without its textures, opaque and double sided.
Json derived_json(const Json& source, const scene::SceneMaterial& material, const scene::SceneMaterial& made) {
  Json derived = Json::object();
  if (!material.name.empty()) derived["name"] = material.name;
  Json pbr = Json::object();
  const Json old = source.contains("pbrMetallicRoughness") ? source["pbrMetallicRoughness"] : Json::object();
  pbr["baseColorFactor"] = {made.base_color[0], made.base_color[1], made.base_color[2], 1.0};
  const bool has_texture = old.contains("metallicRoughnessTexture");  // its factors are of the texture
  if (has_texture) pbr["metallicFactor"] = 0.0;
  for (const char* factor : {"metallicFactor", "roughnessFactor"}) {
    if (!has_texture && old.contains(factor)) pbr[factor] = old[factor];
  }
  derived["pbrMetallicRoughness"] = std::move(pbr);
  if (source.contains("emissiveFactor") && !source.contains("emissiveTexture")) {
    derived["emissiveFactor"] = source["emissiveFactor"];
  }
  derived["doubleSided"] = true;
  if (material.source_index != kNoId) derived["extras"]["meshlode"]["covers_as"] = material.source_index;
  return derived;
}

}  // namespace

bool needs_look(const scene::SceneMaterial& material) {
  return material.base_color_texture != kNoId;
}

Result<CoarseMaterials> derive_materials(const scene::Scene& scene, std::span<const std::uint8_t> is_used,
                                         std::span<const std::optional<MaterialLook>> looks) {
  CoarseMaterials out;
  out.materials = scene.materials;
  out.of_source.resize(scene.materials.size());
  Json document = Json::parse(scene.document, nullptr, false);
  if (!document.is_object()) return Error{ErrorCode::kInvalid, "document", "is not a JSON object"};
  Json& list = document["materials"];
  if (!list.is_array()) list = Json::array();
  bool is_any_derived = false;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    out.of_source[i].coarse = static_cast<std::uint32_t>(i);
    const scene::SceneMaterial& source = scene.materials[i];
    if (is_used[i] != 0 && looks[i]) {
      out.of_source[i].covers = looks[i]->covers;
      out.of_source[i].uv_set = looks[i]->uv_set;
    }
    if (is_used[i] == 0 || stands_for_itself(source)) continue;
    const bool is_listed = source.source_index < list.size();
    scene::SceneMaterial derived;
    derived.name = source.name;
    derived.source_index = static_cast<std::uint32_t>(list.size());
    derived.base_color = Vec4f(looks[i] ? looks[i]->color : Vec3f(source.base_color), 1.0F);
    derived.double_sided = true;
    out.of_source[i].coarse = static_cast<std::uint32_t>(out.materials.size());
    out.materials.push_back(std::move(derived));
    list.push_back(derived_json(is_listed ? list[source.source_index] : Json::object(), source, out.materials.back()));
    is_any_derived = true;
  }
  out.document = is_any_derived ? document.dump() : scene.document;
  return out;
}

}  // namespace meshlode::builder
