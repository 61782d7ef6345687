// SPDX-License-Identifier: GPL-3.0-or-later
// EXT_meshopt_compression, and KHR_meshopt_compression where it says no more: which buffer views are compressed, and
// their bytes.
#pragma once

#include <cstdint>
#include <optional>

#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/meshopt_decode.h"

namespace meshlode::scene {

/// Whether the file's own extension object of a buffer says that its bytes, if any, are for readers without the
/// extension.
[[nodiscard]] bool is_meshopt_fallback(const Json& buffer);

/// Bytes of the streams of all views together, counted once a view.
[[nodiscard]] std::uint64_t count_meshopt_bytes(const Json& root);

/// Fills asset.decoded_views. `max_bytes`: of all views together. \pre the asset is checked, its buffers are loaded
/// Errors: kInvalid; kUnsupported for a newer bitstream.
[[nodiscard]] Status decode_meshopt_views(GltfAsset& asset, std::uint64_t max_bytes);

}  // namespace meshlode::scene
