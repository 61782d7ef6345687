// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/textures/texture_use.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace meshlode::draw {

namespace {

using Json = nlohmann::json;

constexpr double kLargest = 1e9, kSmallest = 1e-9;

const Json* member(const Json* object, const char* key) {
  if (object == nullptr || !object->is_object()) return nullptr;
  const auto found = object->find(key);
  return found == object->end() ? nullptr : &*found;
}

const Json* element(const Json& document, const char* array, std::uint64_t index) {
  const Json* found = member(&document, array);
  return found != nullptr && found->is_array() && index < found->size() ? &(*found)[index] : nullptr;
}

std::uint64_t index_in(const Json* object, const char* key, std::uint64_t missing) {
  const Json* found = member(object, key);
  if (found == nullptr) return missing;
  return found->is_number_unsigned() ? found->get<std::uint64_t>() : format::kNone;
}

double number_in(const Json* object, const char* key, double missing) {
  const Json* found = member(object, key);
  return found != nullptr && found->is_number() ? found->get<double>() : missing;
}

std::array<double, 2> pair_in(const Json* object, const char* key, std::array<double, 2> missing) {
  const Json* found = member(object, key);
  if (found == nullptr || !found->is_array() || found->size() != 2) return missing;
  if (!(*found)[0].is_number() || !(*found)[1].is_number()) return missing;
  return {(*found)[0].get<double>(), (*found)[1].get<double>()};
}

Wrap wrap_of(std::uint64_t gl_name) {
  switch (gl_name) {
    case 33071: return Wrap::kClamp;   // CLAMP_TO_EDGE
    case 33648: return Wrap::kMirror;  // MIRRORED_REPEAT
    default: return Wrap::kRepeat;
  }
}

/// Offset · rotation · scale, the rotation as in the extension's example: a quarter turn and the offset (0, 1) bring u
/// to where -v was, so that a scale of a half shows the lower left quarter.
void apply_transform(const Json& transform, TextureUse& use) {
  const auto offset = pair_in(&transform, "offset", {0.0, 0.0}), scale = pair_in(&transform, "scale", {1.0, 1.0});
  const double rotation = number_in(&transform, "rotation", 0.0);
  const double c = std::cos(rotation), s = std::sin(rotation);
  std::array<double, 3> rows[2] = {{scale[0] * c, scale[1] * s, offset[0]}, {-scale[0] * s, scale[1] * c, offset[1]}};
  for (auto& row : rows) {
    for (double& entry : row) {
      if (!(std::abs(entry) <= kLargest)) return;
      if (std::abs(entry) < kSmallest) entry = 0.0;  // a quarter turn's cosine among them
    }
  }
  use.row_u = rows[0];
  use.row_v = rows[1];
}

std::optional<TextureUse> read_use(const run::Asset& asset, const Json& document, const Json* info) {
  const std::uint64_t texture_index = index_in(info, "index", format::kNone);
  const Json* texture = element(document, "textures", texture_index);
  if (texture == nullptr) return std::nullopt;
  TextureUse use;
  const Json* transform = member(member(info, "extensions"), "KHR_texture_transform");
  if (transform != nullptr && transform->is_object()) apply_transform(*transform, use);
  const std::uint64_t set = index_in(transform, "texCoord", index_in(info, "texCoord", 0));
  use.uv_set = static_cast<std::uint32_t>(std::min<std::uint64_t>(set, format::kNone));
  if (const Json* sampler = element(document, "samplers", index_in(texture, "sampler", format::kNone))) {
    use.wrap_u = wrap_of(index_in(sampler, "wrapS", 0));
    use.wrap_v = wrap_of(index_in(sampler, "wrapT", 0));
  }
  const Json* image = element(document, "images", index_in(texture, "source", format::kNone));
  const std::uint64_t blob = index_in(image, "blob", format::kNone);
  if (blob < asset.blobs().size() && asset.blobs()[blob].kind == format::BlobKind::kImage) {
    use.blob = static_cast<std::uint32_t>(blob);
  }
  return use;
}

}  // namespace

std::vector<MaterialTextures> read_material_textures(const run::Asset& asset) {
  std::vector<MaterialTextures> out(asset.materials().size());
  const std::string_view text = asset.scene_json();
  const Json document = Json::parse(text.begin(), text.end(), nullptr, false);
  if (!document.is_object()) return out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Json* material = element(document, "materials", asset.materials()[i].source_index);
    if (material == nullptr) continue;
    const Json* info = member(member(material, "pbrMetallicRoughness"), "baseColorTexture");
    const Json* glossiness = member(member(material, "extensions"), "KHR_materials_pbrSpecularGlossiness");
    if (glossiness != nullptr) info = member(glossiness, "diffuseTexture");  // nothing of the two is mixed
    out[i].base_color = read_use(asset, document, info);
    const Json* normal = member(material, "normalTexture");
    out[i].normal = read_use(asset, document, normal);
    const double scale = number_in(normal, "scale", 1.0);
    out[i].normal_scale = std::abs(scale) <= kLargest ? scale : 1.0;
  }
  return out;
}

}  // namespace meshlode::draw
