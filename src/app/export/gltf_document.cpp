// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/gltf_document.h"

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
