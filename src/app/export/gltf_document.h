// SPDX-License-Identifier: GPL-3.0-or-later
// A glTF document in the making.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>

#include <nlohmann/json.hpp>

#include <meshlode/result.h>

#include "app/export/glb_file.h"

namespace meshlode::app {

using GltfJson = nlohmann::json;  // keys sorted: deterministic bytes

/// Element `index` of the array `key` of an object, or null where there is none of that shape.
[[nodiscard]] const GltfJson* find_element(const GltfJson& object, const char* key, std::size_t index);

/// The array under `key`, made empty where it is missing. \pre not another kind of value
GltfJson& array_of(GltfJson& object, const char* key);

/// Whether each of these members is an array, where it is there. Errors: as malformed().
[[nodiscard]] Status check_arrays(const GltfJson& object, std::initializer_list<const char*> keys);

/// Names an extension in the document's lists, once.
void use_extension(GltfJson& document, const char* name, bool is_required);

/// A view of the BIN chunk, or an accessor: its index.
std::size_t add_view(GltfJson& document, GlbBinary::Range range, ViewTarget target = ViewTarget::kNone);
std::size_t add_accessor(GltfJson& document, GltfJson accessor);

/// The scene that an asset carries is not what glTF allows.
[[nodiscard]] Error malformed(std::string detail);

}  // namespace meshlode::app
