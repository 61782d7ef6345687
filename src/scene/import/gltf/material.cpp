// SPDX-License-Identifier: GPL-3.0-or-later
// The few things of a material that the build acts on. Above all: its texture references, in extensions that are not
// known here too, because a UV set that no material samples is not stored.
#include <algorithm>
#include <array>
#include <utility>

#include "base/gltf_textures.h"
#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/gltf_import.h"

namespace meshlode::scene {

namespace {

/// The tree as base/gltf_textures.h asks it.
class Handle {
 public:
  Handle() = default;
  explicit Handle(const Json* json) : json_(json) {}

  [[nodiscard]] bool is_object() const { return json_ != nullptr && json_->is_object(); }
  [[nodiscard]] Handle find(std::string_view key) const {
    return Handle(json_ != nullptr ? json_->find(key) : nullptr);
  }
  [[nodiscard]] std::size_t size() const { return array() != nullptr ? array()->size() : 0; }
  [[nodiscard]] Handle item(std::size_t i) const { return i < size() ? Handle(&(*array())[i]) : Handle(); }
  [[nodiscard]] std::optional<std::uint64_t> index() const { return json_ != nullptr ? json_->index() : std::nullopt; }
  [[nodiscard]] std::optional<double> number() const { return json_ != nullptr ? json_->number() : std::nullopt; }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < size(); ++i) visit(std::string_view(), item(i));
    if (!is_object()) return;
    for (const JsonMember& member : *json_->object()) visit(std::string_view(member.key), Handle(&member.value));
  }
  bool operator==(const Handle&) const = default;

 private:
  [[nodiscard]] const Json::Array* array() const { return json_ != nullptr ? json_->array() : nullptr; }
  const Json* json_ = nullptr;
};

/// An index below `count`, or kNoId.
std::uint32_t id_below(std::optional<std::uint64_t> index, std::size_t count) {
  return index && *index < std::min<std::size_t>(count, kNoId) ? static_cast<std::uint32_t>(*index) : kNoId;
}

/// The image of every texture, looked up once: many references may name one texture.
std::vector<std::uint32_t> images_of_textures(const GltfAsset& asset) {
  const std::size_t image_count = asset.root.items("images").size();
  std::vector<std::uint32_t> out;
  for (const Json& texture : asset.root.items("textures")) {
    out.push_back(id_below(image_of_texture(Handle(&texture)), image_count));
  }
  return out;
}

/// Every texture reference of a material. Their blobs are found later, with the images.
std::vector<TextureUse> read_texture_uses(const Json& json, const std::vector<std::uint32_t>& images) {
  const Handle material(&json);
  const Handle metallic = material.find("pbrMetallicRoughness");
  const bool is_replaced = material.find("extensions").find("KHR_materials_pbrSpecularGlossiness").is_object();
  const std::array<std::pair<Handle, TextureRole>, 5> roles{{
      {base_color_info(material), TextureRole::kBaseColor},
      {is_replaced ? Handle() : metallic.find("metallicRoughnessTexture"), TextureRole::kMetallicRoughness},
      {material.find("normalTexture"), TextureRole::kNormal},
      {material.find("occlusionTexture"), TextureRole::kOcclusion},
      {material.find("emissiveTexture"), TextureRole::kEmissive},
  }};
  std::vector<TextureUse> out;
  for_each_texture_info(material, [&](const Handle& info) {
    const TextureReference reference = read_texture_info(info);
    TextureUse use;
    const auto known = std::find_if(roles.begin(), roles.end(), [&](const auto& role) { return role.first == info; });
    if (known != roles.end()) use.role = known->second;
    use.texture = id_below(reference.texture, images.size());
    if (use.texture != kNoId) use.image = images[use.texture];
    use.uv_set = static_cast<std::uint32_t>(std::min<std::uint64_t>(reference.uv_set, kNoId));
    use.offset = reference.offset;
    use.scale = reference.scale;
    use.rotation = reference.rotation;
    out.push_back(use);
  });
  return out;
}

float number_or(const Json* json, float fallback) {
  if (json == nullptr) return fallback;
  const auto number = json->number();
  return number ? static_cast<float>(*number) : fallback;
}

void read_base_color(const Json& owner, std::string_view key, SceneMaterial& out) {
  const auto& numbers = owner.items(key);
  if (numbers.size() != 4) return;
  for (int c = 0; c < 4; ++c) out.base_color[c] = number_or(&numbers[static_cast<std::size_t>(c)], 1.0F);
}

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
  const std::vector<std::uint32_t> images = images_of_textures(asset);
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
    const Json* pbr = material.find("pbrMetallicRoughness");
    const Json* extensions = material.find("extensions");
    const Json* specular = extensions != nullptr ? extensions->find("KHR_materials_pbrSpecularGlossiness") : nullptr;
    // Specular-glossiness stands in the place of metallic-roughness, with defaults of its own.
    if (specular != nullptr) {
      read_base_color(*specular, "diffuseFactor", m);
    } else if (pbr != nullptr) {
      read_base_color(*pbr, "baseColorFactor", m);
    }
    m.needs_tangents = has_direction(material);
    m.textures = read_texture_uses(material, images);
    bool has_high_set = false;
    for (const TextureUse& use : m.textures) {
      if (use.uv_set < kMaxUvSets) {
        m.uv_sets_used |= 1U << use.uv_set;
      } else {
        has_high_set = true;
      }
      if (use.role != TextureRole::kBaseColor) continue;
      m.base_color_texture = use.texture;
      m.base_color_uv_set = use.uv_set;
    }
    if (has_high_set) {
      left_out.push_back(
          {"material " + std::to_string(out.size()), "a texture samples TEXCOORD_4 or above, which is not kept"});
    }
    out.push_back(std::move(m));
  }
  return out;
}

}  // namespace meshlode::scene
