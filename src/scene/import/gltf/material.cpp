// SPDX-License-Identifier: GPL-3.0-or-later
// The few things of a material that the build acts on. Above all: which UV sets some texture samples, in extensions
// that are not known here too, because a UV set that no material samples is not stored.
#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/gltf_import.h"

namespace meshlode::scene {

namespace {

/// texCoord of a texture info; KHR_texture_transform may override it.
std::uint32_t uv_set_of(const Json& info) {
  if (const Json* extensions = info.find("extensions")) {
    const Json* transform = extensions->find("KHR_texture_transform");
    const Json* override_set = transform != nullptr ? transform->find("texCoord") : nullptr;
    if (override_set != nullptr && override_set->index()) {
      return static_cast<std::uint32_t>(std::min<std::uint64_t>(*override_set->index(), kNoIndex));
    }
  }
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(index_or(info, "texCoord", 0), kNoIndex));
}

/// Every object under a key that ends in "Texture" and has an "index" is a texture info, wherever it stands.
void collect_uv_sets(const Json& json, std::uint32_t& sets, bool& has_high_set) {
  if (const auto* array = json.array()) {
    for (const Json& item : *array) collect_uv_sets(item, sets, has_high_set);
    return;
  }
  const auto* object = json.object();
  if (object == nullptr) return;
  for (const JsonMember& member : *object) {
    if (member.key == "extras") continue;
    if (member.key.ends_with("Texture") && member.value.find("index") != nullptr) {
      const std::uint32_t set = uv_set_of(member.value);
      if (set < kMaxUvSets) {
        sets |= 1U << set;
      } else {
        has_high_set = true;
      }
    }
    collect_uv_sets(member.value, sets, has_high_set);
  }
}

float number_or(const Json* json, float fallback) {
  if (json == nullptr) return fallback;
  const auto number = json->number();
  return number ? static_cast<float>(*number) : fallback;
}

void read_base_color(const Json& owner, std::string_view factor, std::string_view texture, SceneMaterial& out) {
  const auto& numbers = owner.items(factor);
  if (numbers.size() == 4) {
    for (int c = 0; c < 4; ++c) out.base_color[c] = number_or(&numbers[static_cast<std::size_t>(c)], 1.0F);
  }
  if (const Json* info = owner.find(texture)) {
    out.base_color_texture = static_cast<std::uint32_t>(index_or(*info, "index", kNoIndex));
    out.base_color_uv_set = uv_set_of(*info);
  }
}

}  // namespace

namespace {

bool has_direction(const Json& material) {
  if (material.find("normalTexture") != nullptr) return true;
  const Json* extensions = material.find("extensions");
  if (extensions == nullptr) return false;
  const Json* coat = extensions->find("KHR_materials_clearcoat");
  return extensions->find("KHR_materials_anisotropy") != nullptr ||
         (coat != nullptr && coat->find("clearcoatNormalTexture") != nullptr);
}

}  // namespace

std::vector<SceneMaterial> read_materials(const GltfAsset& asset, std::vector<LeftOut>& left_out) {
  std::vector<SceneMaterial> out;
  for (const Json& material : asset.root.items("materials")) {
    SceneMaterial m;
    m.source_index = static_cast<std::uint32_t>(out.size());
    if (const Json* name = material.find("name")) m.name = *name->string();
    if (const Json* mode = material.find("alphaMode")) {
      if (*mode->string() == "MASK") m.alpha_mode = AlphaMode::kMask;
      if (*mode->string() == "BLEND") m.alpha_mode = AlphaMode::kBlend;
    }
    m.alpha_cutoff = number_or(material.find("alphaCutoff"), 0.5F);
    if (const Json* flag = material.find("doubleSided")) m.double_sided = std::get<bool>(flag->value);
    if (const Json* pbr = material.find("pbrMetallicRoughness")) {
      read_base_color(*pbr, "baseColorFactor", "baseColorTexture", m);
    }
    const Json* extensions = material.find("extensions");
    const Json* specular = extensions != nullptr ? extensions->find("KHR_materials_pbrSpecularGlossiness") : nullptr;
    if (specular != nullptr) {
      // It stands in the place of metallic-roughness, with defaults of its own: nothing of the two is mixed.
      m.base_color = Vec4f(1.0F);
      m.base_color_texture = m.base_color_uv_set = kNoIndex;
      read_base_color(*specular, "diffuseFactor", "diffuseTexture", m);
    }
    m.needs_tangents = has_direction(material);
    bool has_high_set = false;
    collect_uv_sets(material, m.uv_sets_used, has_high_set);
    if (has_high_set) {
      left_out.push_back(
          {"material " + std::to_string(out.size()), "a texture samples TEXCOORD_4 or above, which is not kept"});
    }
    out.push_back(std::move(m));
  }
  return out;
}

}  // namespace meshlode::scene
