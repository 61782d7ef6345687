// SPDX-License-Identifier: MIT
#include "run/read/find_image.h"

#include "base/gltf_textures.h"
#include "run/read/json_text.h"

namespace meshlode::run {

std::uint32_t find_image_of_texture(const Asset& asset, std::uint32_t texture) {
  const JsonText document(asset.scene_json());
  const auto image = image_of_texture(document.find("textures").item(texture));
  const bool is_there = image && *image < document.find("images").size();
  return is_there ? static_cast<std::uint32_t>(*image) : format::kNone;
}

std::uint32_t find_blob_of_image(const Asset& asset, std::uint32_t image) {
  const auto blob = JsonText(asset.scene_json()).find("images").item(image).find("blob").index();
  const bool is_image = blob && *blob < asset.blobs().size() && asset.blobs()[*blob].kind == format::BlobKind::kImage;
  return is_image ? static_cast<std::uint32_t>(*blob) : format::kNone;
}

}  // namespace meshlode::run
