// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/gltf_document.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace meshlode::app {

const GltfJson* find_element(const GltfJson& object, const char* key, std::size_t index) {
  const auto it = object.find(key);
  return it != object.end() && it->is_array() && index < it->size() ? &(*it)[index] : nullptr;
}

GltfJson& array_of(GltfJson& object, const char* key) {
  GltfJson& value = object[key];
  if (value.is_null()) value = GltfJson::array();
  return value;
}

Status check_arrays(const GltfJson& object, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const auto it = object.find(key);
    if (it != object.end() && !it->is_null() && !it->is_array())
      return malformed(std::string("/") + key + " is not an array");
  }
  return Ok{};
}

void use_extension(GltfJson& document, const char* name, bool is_required) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!is_required && list == std::string_view("extensionsRequired")) continue;
    GltfJson& names = array_of(document, list);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

Error malformed(std::string detail) {
  return {ErrorCode::kInvalid, "section SCNE", std::move(detail)};
}

std::size_t add_view(GltfJson& document, GlbBinary::Range range, ViewTarget target) {
  GltfJson view = {{"buffer", 0}, {"byteOffset", range.offset}, {"byteLength", range.bytes}};
  if (target != ViewTarget::kNone) view["target"] = static_cast<int>(target);
  GltfJson& views = array_of(document, "bufferViews");
  views.push_back(std::move(view));
  return views.size() - 1;
}

std::size_t add_accessor(GltfJson& document, GltfJson accessor) {
  GltfJson& accessors = array_of(document, "accessors");
  accessors.push_back(std::move(accessor));
  return accessors.size() - 1;
}

}  // namespace meshlode::app
