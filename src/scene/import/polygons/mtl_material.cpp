// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/mtl_material.h"

#include <algorithm>
#include <utility>

namespace meshlode::scene {

namespace {

Json numbers(std::initializer_list<double> values) {
  Json out = Json::make_array();
  for (const double value : values) std::get<Json::Array>(out.value).push_back(Json::make_number(value));
  return out;
}

/// The texture reference of an object, and its entry beside the material.
void add_texture(Json& owner, const char* key, TextureRole role, std::uint32_t image, SceneMaterial& out) {
  if (image == kNoId) return;
  Json info = Json::make_object();
  info.set("index", Json::make_index(image));
  owner.set(key, std::move(info));
  TextureUse use;
  use.role = role;
  use.texture = use.image = use.blob = image;
  out.textures.push_back(use);
  out.uv_sets_used = 1;
}

Json make_pbr(const MtlMaterial& from, const MtlImages& images, SceneMaterial& out) {
  const auto& [r, g, b] = from.diffuse;
  const double opacity = opacity_of(from);
  out.base_color = Vec4f(r, g, b, opacity);
  Json pbr = Json::make_object();
  pbr.set("baseColorFactor", numbers({r, g, b, opacity}));
  add_texture(pbr, "baseColorTexture", TextureRole::kBaseColor, images.base_color, out);
  if (images.base_color != kNoId) {
    out.base_color_texture = images.base_color;
    out.base_color_uv_set = 0;
  }
  const bool has_metal_map = images.metallic_roughness != kNoId && !from.metal.file.empty();
  // A 0 that writers always write would switch the map off.
  const double metalness = from.metalness.value_or(0.0);
  pbr.set("metallicFactor", Json::make_number(has_metal_map && metalness == 0.0 ? 1.0 : metalness));
  const bool is_off = images.metallic_roughness != kNoId && from.roughness == 0.0;
  if (from.roughness && !is_off) pbr.set("roughnessFactor", Json::make_number(*from.roughness));
  add_texture(pbr, "metallicRoughnessTexture", TextureRole::kMetallicRoughness, images.metallic_roughness, out);
  return pbr;
}

/// Factors above 1 are a strength of KHR_materials_emissive_strength.
void add_emission(const MtlMaterial& from, const MtlImages& images, Json& material, SceneMaterial& out,
                  bool& has_strength) {
  add_texture(material, "emissiveTexture", TextureRole::kEmissive, images.emissive, out);
  std::array<double, 3> factor = from.emission.value_or(std::array{0.0, 0.0, 0.0});
  const double largest = *std::max_element(factor.begin(), factor.end());
  if (largest == 0.0 && images.emissive == kNoId) return;
  if (largest == 0.0) factor = {1.0, 1.0, 1.0};  // a map without Ke, or with the Ke 0 that writers always write
  if (largest > 1.0) {
    for (double& c : factor) c /= largest;
    Json strength = Json::make_object(), extensions = Json::make_object();
    strength.set("emissiveStrength", Json::make_number(largest));
    extensions.set("KHR_materials_emissive_strength", std::move(strength));
    material.set("extensions", std::move(extensions));
    has_strength = true;
  }
  material.set("emissiveFactor", numbers({factor[0], factor[1], factor[2]}));
}

}  // namespace

double opacity_of(const MtlMaterial& from) {
  if (from.dissolve) return *from.dissolve;
  if (from.transparency && *from.transparency < 1.0) return 1.0 - *from.transparency;
  return 1.0;
}

bool can_have_roughness_map(const MtlMaterial& from) {
  return from.metal.file.empty() ? from.metalness.value_or(0.0) == 0.0 : from.metal.file == from.rough.file;
}

Json make_material(const MtlMaterial& from, const MtlImages& images, SceneMaterial& out, bool& has_strength) {
  Json material = Json::make_object();
  material.set("name", Json::make_string(out.name));
  material.set("pbrMetallicRoughness", make_pbr(from, images, out));
  add_texture(material, "normalTexture", TextureRole::kNormal, images.normal, out);
  out.needs_tangents = images.normal != kNoId;
  add_emission(from, images, material, out, has_strength);
  if (opacity_of(from) < 1.0) {
    out.alpha_mode = AlphaMode::kBlend;
    material.set("alphaMode", Json::make_string("BLEND"));
  } else if (images.masks) {
    out.alpha_mode = AlphaMode::kMask;
    material.set("alphaMode", Json::make_string("MASK"));
  }
  return material;
}

}  // namespace meshlode::scene
