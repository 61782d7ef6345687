// SPDX-License-Identifier: GPL-3.0-or-later
// Write: encoded meshes and the scene around them become the bytes of a .lode file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "build/encode/encode.h"
#include "scene/scene.h"

namespace meshlode::build {

struct WriteInput {
  std::vector<EncodedMesh> meshes;
  std::vector<std::string> mesh_names;
  const scene::Scene* scene = nullptr;  ///< materials, instances, blobs and document
  std::string meta_json;                ///< kMeta, already serialised
  format::Codec codec = format::Codec::kNone;
};

/// The whole file. Deterministic: no time, no path, no thread count. Errors: kUnsupported codec, kBuildFailed limits.
[[nodiscard]] Result<std::vector<std::uint8_t>> write_asset(WriteInput input);

}  // namespace meshlode::build
