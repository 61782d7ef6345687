// SPDX-License-Identifier: MIT
// From a texture to its bytes, through the glTF document that the asset holds: texture, image, blob.
#pragma once

#include <cstdint>

#include "run/read/asset.h"

namespace meshlode::run {

/// The glTF image of a glTF texture, by the rule of base/gltf_textures.h; kNone where there is none. Reads the document
/// from its start.
[[nodiscard]] std::uint32_t find_image_of_texture(const Asset& asset, std::uint32_t texture);

/// The blob, into Asset::blobs(), that is a glTF image; kNone where the asset does not hold it.
[[nodiscard]] std::uint32_t find_blob_of_image(const Asset& asset, std::uint32_t image);

}  // namespace meshlode::run
