// SPDX-License-Identifier: GPL-3.0-or-later
// What an exported document has beside geometry: buffers of animations, images, textures and materials.
#pragma once

#include <meshlode/result.h>

#include "app/export/glb_file.h"
#include "app/export/gltf_document.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// Puts the bytes that the document names by blobs into the BIN chunk, and names them as glTF does. Materials are made
/// of records where the document has none. Errors: as malformed(); kInvalid for a blob that is damaged.
[[nodiscard]] Status carry_contents(const run::Asset& asset, GltfJson& document, GlbBinary& binary);

}  // namespace meshlode::app
