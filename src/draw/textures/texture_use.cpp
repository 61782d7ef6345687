// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/textures/texture_use.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "base/gltf_textures.h"
#include "base/json_handle.h"

namespace meshlode::draw {

namespace {

using Json = TreeHandle<nlohmann::json>;

constexpr double kLargest = 1e9, kSmallest = 1e-9;

Json element(Json document, std::string_view array, std::optional<std::uint64_t> index) {
  return index ? document.find(array).item(*index) : Json();
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
void apply_transform(const TextureReference& reference, TextureUse& use) {
  const auto &offset = reference.offset, &scale = reference.scale;
  const double c = std::cos(reference.rotation), s = std::sin(reference.rotation);
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

std::optional<TextureUse> read_use(const run::Asset& asset, Json document, Json info) {
  const TextureReference reference = read_texture_info(info);
  const Json texture = element(document, "textures", reference.texture);
  if (texture == Json()) return std::nullopt;
  TextureUse use;
  apply_transform(reference, use);
  use.uv_set = static_cast<std::uint32_t>(std::min<std::uint64_t>(reference.uv_set, format::kNone));
  const Json sampler = element(document, "samplers", texture.find("sampler").index());
  use.wrap_u = wrap_of(sampler.find("wrapS").index().value_or(0));
  use.wrap_v = wrap_of(sampler.find("wrapT").index().value_or(0));
  const auto blob = element(document, "images", image_of_texture(texture)).find("blob").index();
  if (blob && *blob < asset.blobs().size() && asset.blobs()[*blob].kind == format::BlobKind::kImage) {
    use.blob = static_cast<std::uint32_t>(*blob);
  }
  return use;
}

}  // namespace

std::vector<MaterialTextures> read_material_textures(const run::Asset& asset) {
  std::vector<MaterialTextures> out(asset.materials().size());
  const std::string_view text = asset.scene_json();
  const auto tree = nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
  const Json document(tree);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Json material = element(document, "materials", asset.materials()[i].source_index);
    out[i].base_color = read_use(asset, document, base_color_info(material));
    const Json normal = material.find("normalTexture");
    out[i].normal = read_use(asset, document, normal);
    const double scale = normal.find("scale").number().value_or(1.0);
    out[i].normal_scale = std::abs(scale) <= kLargest ? scale : 1.0;
  }
  return out;
}

}  // namespace meshlode::draw
