// SPDX-License-Identifier: GPL-3.0-or-later
// Write: encoded meshes and the scene around them become the bytes of a .lode file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "builder/encode/encode.h"
#include "scene/scene.h"

namespace meshlode::builder {

struct WriteInput {
  std::vector<EncodedMesh> meshes;
  std::vector<std::string> mesh_names;
  const scene::Scene* scene = nullptr;  ///< instances; blobs, materials and document where there are none below
  const std::vector<scene::SceneBlob>* blobs = nullptr;          ///< with images as they are stored
  const std::vector<scene::SceneMaterial>* materials = nullptr;  ///< with those that the build derived
  const std::string* document = nullptr;                         ///< with these
  std::string meta_json;                                         ///< kMeta, already serialised
  format::Codec codec = format::Codec::kNone;
  bool has_page_hints = false;
  std::uint32_t promises = 0;  ///< format::kPromises…: what the meshes have errors for; 0: no section says so

  [[nodiscard]] const std::vector<scene::SceneBlob>& all_blobs() const {
    return blobs != nullptr ? *blobs : scene->blobs;
  }
  [[nodiscard]] const std::vector<scene::SceneMaterial>& all_materials() const {
    return materials != nullptr ? *materials : scene->materials;
  }
  [[nodiscard]] const std::string& whole_document() const { return document != nullptr ? *document : scene->document; }
};

/// The whole file. Deterministic: no time, no path, no thread count. Errors: kUnsupported codec, kBuildFailed limits.
[[nodiscard]] Result<std::vector<std::uint8_t>> write_asset(WriteInput input);

}  // namespace meshlode::builder
