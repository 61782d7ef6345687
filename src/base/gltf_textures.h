// SPDX-License-Identifier: MIT
// Which textures a glTF material names, and which image each of them is: one rule, for the importer, which records the
// answer beside each material, and for those who meet the document in an asset. It sees JSON through a handle, so that
// it knows no JSON library. Whatever is not as glTF has it counts as not there: safe on any tree.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace meshlode {

/// A JSON value, or nowhere; cheap to copy. Of nowhere, and of another kind of value, everything is nowhere or nothing.
/// `for_each` calls its argument with the key (empty in an array) and the handle of each element.
template <class T>
concept JsonHandle = requires(const T& json, std::string_view key, std::size_t i) {
  { json.is_object() } -> std::same_as<bool>;
  { json.find(key) } -> std::same_as<T>;
  { json.size() } -> std::same_as<std::size_t>;
  { json.item(i) } -> std::same_as<T>;
  { json.index() } -> std::same_as<std::optional<std::uint64_t>>;
  { json.number() } -> std::same_as<std::optional<double>>;
  { json == json } -> std::same_as<bool>;
  json.for_each([](std::string_view, const T&) {});
};

/// Extensions of a texture that name an image of a kind that glTF itself does not allow.
inline constexpr std::array<std::string_view, 4> kTextureSourceExtensions{"KHR_texture_basisu", "EXT_texture_webp",
                                                                          "EXT_texture_avif", "MSFT_texture_dds"};

/// Calls `visit` with every image that a texture names, as an index in `images`, not held against its length: the
/// texture's own source, which everybody can read, then those of extensions.
template <JsonHandle Json, class Visit>
void for_each_image_of_texture(const Json& texture, const Visit& visit) {
  if (const auto own = texture.find("source").index()) visit(*own);
  const Json extensions = texture.find("extensions");
  for (const std::string_view name : kTextureSourceExtensions) {
    if (const auto source = extensions.find(name).find("source").index()) visit(*source);
  }
}

/// The image of a texture: the first of them.
template <JsonHandle Json>
[[nodiscard]] std::optional<std::uint64_t> image_of_texture(const Json& texture) {
  std::optional<std::uint64_t> first;
  for_each_image_of_texture(texture, [&](std::uint64_t image) { first = first ? first : image; });
  return first;
}

/// A textureInfo of glTF, with its KHR_texture_transform.
struct TextureReference {
  std::optional<std::uint64_t> texture;  ///< index in `textures`, not held against its length
  std::uint64_t tex_coord = 0;           ///< of the textureInfo itself: what a reader without the extension samples
  std::uint64_t uv_set = 0;              ///< TEXCOORD_n: the transform's where it names one, else tex_coord
  std::array<double, 2> offset{0.0, 0.0}, scale{1.0, 1.0};
  double rotation = 0.0;  ///< radians
};

template <JsonHandle Json>
[[nodiscard]] TextureReference read_texture_info(const Json& info) {
  TextureReference out;
  out.texture = info.find("index").index();
  out.tex_coord = info.find("texCoord").index().value_or(0);
  const Json transform = info.find("extensions").find("KHR_texture_transform");
  out.uv_set = transform.find("texCoord").index().value_or(out.tex_coord);
  const auto pair = [&](std::string_view key, std::array<double, 2>& value) {
    const Json numbers = transform.find(key);
    const auto first = numbers.item(0).number(), second = numbers.item(1).number();
    if (numbers.size() == 2 && first && second) value = {*first, *second};
  };
  pair("offset", out.offset);
  pair("scale", out.scale);
  out.rotation = transform.find("rotation").number().value_or(0.0);
  return out;
}

/// Where a material's base colour texture stands, if it has one. KHR_materials_pbrSpecularGlossiness stands in the
/// place of metallic-roughness: nothing of the two is mixed.
template <JsonHandle Json>
[[nodiscard]] Json base_color_info(const Json& material) {
  const Json glossiness = material.find("extensions").find("KHR_materials_pbrSpecularGlossiness");
  if (glossiness.is_object()) return glossiness.find("diffuseTexture");
  return material.find("pbrMetallicRoughness").find("baseColorTexture");
}

/// Calls `visit` with every textureInfo of a material, in the document's order: each object under a key that ends in
/// "Texture" and has an "index", in extensions too, known or not, but not in extras. \pre the tree's depth is bounded
template <JsonHandle Json, class Visit>
void for_each_texture_info(const Json& material, const Visit& visit) {
  material.for_each([&](std::string_view key, const Json& value) {
    if (key == "extras") return;
    if (key.ends_with("Texture") && value.find("index") != Json()) visit(value);
    for_each_texture_info(value, visit);
  });
}

}  // namespace meshlode
