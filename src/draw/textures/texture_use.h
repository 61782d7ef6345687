// SPDX-License-Identifier: GPL-3.0-or-later
// Which image a material samples, with which UVs and how it repeats: read from the scene's document, which travels
// through the asset as it was, by the rule of base/gltf_textures.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "run/read/asset.h"

namespace meshlode::draw {

/// Beyond 0 … 1. The values are the shaders' too.
enum class Wrap : std::uint32_t { kRepeat = 0, kMirror = 1, kClamp = 2 };

/// A texture reference of a material. Filters are not read: who draws decides on them.
struct TextureUse {
  std::uint32_t blob = format::kNone;  ///< index in Asset::blobs(); kNone where the asset has no such image
  std::uint32_t uv_set = 0;            ///< TEXCOORD_n
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  /// KHR_texture_transform: u' = row_u[0] · u + row_u[1] · v + row_u[2]. Every entry is 0 or of a magnitude in
  /// [1e-9, 1e9].
  std::array<double, 3> row_u{1.0, 0.0, 0.0}, row_v{0.0, 1.0, 0.0};
};

struct MaterialTextures {
  std::optional<TextureUse> base_color;
  std::optional<TextureUse> normal;
  double normal_scale = 1.0;
};

/// One entry for each of Asset::materials(). Parses the document: read once, and hand it to all that load images. Safe
/// on any document: what is not as glTF has it counts as not there, and a transform out of range as none.
[[nodiscard]] std::vector<MaterialTextures> read_material_textures(const run::Asset& asset);

}  // namespace meshlode::draw
