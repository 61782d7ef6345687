// SPDX-License-Identifier: GPL-3.0-or-later
#include "material_looks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "draw/textures/alpha_mask.h"
#include "draw/textures/image.h"
#include "draw/textures/texture_image.h"
#include "run/read/limits.h"
#include "scene/import/json.h"

namespace meshlode::cli {

namespace {

using scene::Json;

/// An image as a material samples it.
struct Sampled {
  draw::DecodedImage image;
  std::array<draw::Wrap, 2> wrap{};
  std::array<double, 3> row_u{}, row_v{};  ///< texture coordinates to texels
  std::uint32_t threshold = 0;

  std::vector<std::uint8_t> does_pass;  ///< texel by texel: 0 or 1

  /// As builder::AlphaTest::of_row(). Texels are linear along a row, too.
  [[nodiscard]] std::uint64_t passing(const Vec2d& origin, const Vec2d& step, int first, std::uint64_t asked) const {
    const auto texel = [](const std::array<double, 3>& row, const Vec2d& at) { return row[0] * at.x + row[1] * at.y; };
    const double x0 = texel(row_u, origin) + row_u[2], y0 = texel(row_v, origin) + row_v[2];
    const double dx = texel(row_u, step), dy = texel(row_v, step);
    std::uint64_t drawn = 0;
    for (std::uint64_t rest = asked; rest != 0; rest &= rest - 1) {
      const int bit = std::countr_zero(rest);
      const double column = first + bit;
      const std::size_t x = draw::texel_at(x0 + dx * column, image.width, wrap[0]);
      const std::size_t y = draw::texel_at(y0 + dy * column, image.height, wrap[1]);
      drawn |= std::uint64_t{does_pass[y * image.width + x]} << bit;
    }
    return drawn;
  }
  [[nodiscard]] bool passes(std::uint32_t texel) const { return (texel >> 24U) * 255U >= threshold; }
};

draw::Wrap wrap_of(const Json* sampler, const char* key) {
  const Json* value = sampler != nullptr ? sampler->find(key) : nullptr;
  const std::uint64_t number = value != nullptr ? value->index().value_or(0) : 0;
  if (number == 33071) return draw::Wrap::kClamp;
  return number == 33648 ? draw::Wrap::kMirror : draw::Wrap::kRepeat;
}

const Json* item_at(const Json& document, const char* list, std::uint64_t index) {
  const Json::Array& items = document.items(list);
  return index < items.size() ? &items[index] : nullptr;
}

/// Of an 8-bit sRGB value, 0 … 1, to 16 bits: so coarse that no C library's last bit shows.
double linear_of(std::uint32_t value) {
  const double s = value / 255.0;
  const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return std::floor(linear * 65535.0 + 0.5) / 65535.0;
}

/// The mean of the texels that pass the test; of all where none does.
Vec3f mean_color(const Sampled& sampled, const Vec4f& factor) {
  std::array<double, 256> linear{};
  for (std::uint32_t i = 0; i < 256; ++i) linear[i] = linear_of(i);
  Vec3d sum(0.0);
  double weight = 0.0;
  for (const bool only_passing : {true, false}) {
    for (const std::uint32_t texel : sampled.image.texels) {
      if (only_passing && !sampled.passes(texel)) continue;
      sum += Vec3d(linear[texel & 255U], linear[texel >> 8U & 255U], linear[texel >> 16U & 255U]);
      weight += 1.0;
    }
    if (weight > 0.0) break;
  }
  return Vec3f(sum / std::max(weight, 1.0)) * Vec3f(factor);
}

std::optional<builder::MaterialLook> look_of(const scene::Scene& scene, const Json& document,
                                             const scene::SceneMaterial& material) {
  const auto use = std::find_if(material.textures.begin(), material.textures.end(),
                                [](const scene::TextureUse& t) { return t.role == scene::TextureRole::kBaseColor; });
  if (use == material.textures.end() || use->blob >= scene.blobs.size()) return std::nullopt;
  const std::vector<std::uint8_t>& bytes = scene.blobs[use->blob].bytes;
  const auto header = draw::read_image_header(bytes);
  if (!header || 4 * std::uint64_t{header->width} * header->height + header->decoder_bytes > run::kDefaultMaxDecoded) {
    return std::nullopt;
  }
  Result<draw::DecodedImage> image = draw::decode_image(bytes);
  if (!image) return std::nullopt;
  auto sampled = std::make_shared<Sampled>();
  sampled->image = std::move(*image);
  const Json* texture = item_at(document, "textures", use->texture);
  const Json* index = texture != nullptr ? texture->find("sampler") : nullptr;
  const std::optional<std::uint64_t> number = index != nullptr ? index->index() : std::nullopt;
  const Json* sampler = number ? item_at(document, "samplers", *number) : nullptr;
  sampled->wrap = {wrap_of(sampler, "wrapS"), wrap_of(sampler, "wrapT")};
  // KHR_texture_transform: scaled, then turned, then moved. Turned by floats, which C libraries agree on.
  const double cosine = static_cast<float>(std::cos(use->rotation)), sine = static_cast<float>(std::sin(use->rotation));
  sampled->row_u = {cosine * use->scale[0], sine * use->scale[1], use->offset[0]};
  sampled->row_v = {-sine * use->scale[0], cosine * use->scale[1], use->offset[1]};
  for (double& x : sampled->row_u) x *= sampled->image.width;
  for (double& x : sampled->row_v) x *= sampled->image.height;
  const bool is_masked = material.alpha_mode == scene::AlphaMode::kMask;
  sampled->threshold = is_masked ? draw::mask_threshold(material.base_color[3], material.alpha_cutoff) : 0;
  builder::MaterialLook look;
  look.color = mean_color(*sampled, material.base_color);
  look.uv_set = use->uv_set;
  if (sampled->threshold > 0) {
    sampled->does_pass.reserve(sampled->image.texels.size());
    for (const std::uint32_t texel : sampled->image.texels) {
      sampled->does_pass.push_back(sampled->passes(texel) ? 1 : 0);
    }
    sampled->image.texels = {};
    look.covers = [sampled](const Vec2d& origin, const Vec2d& step, int first, std::uint64_t asked) {
      return sampled->passing(origin, step, first, asked);
    };
  }
  return look;
}

class ImageLooks : public builder::LookReader {
 public:
  [[nodiscard]] std::vector<std::optional<builder::MaterialLook>> read(
      const scene::Scene& scene, std::span<const std::uint8_t> wanted) const override {
    std::vector<std::optional<builder::MaterialLook>> looks(scene.materials.size());
    const Result<Json> document = scene::parse_json(scene.document);
    if (!document) return looks;
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (wanted[i] != 0) looks[i] = look_of(scene, *document, scene.materials[i]);
    }
    return looks;
  }
};

}  // namespace

const builder::LookReader& image_looks() {
  static const ImageLooks reader;
  return reader;
}

}  // namespace meshlode::cli
