// SPDX-License-Identifier: GPL-3.0-or-later
// Every object of a material that has an integer "index" is a texture reference: those of glTF itself and of
// extensions, known or not.
#include "build/plan/texel_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "build/plan/image_size.h"

namespace meshlode::build {

namespace {

using Json = nlohmann::json;

/// An index in an object, or nothing that any table has.
std::size_t index_in(const Json& object, const char* key, std::size_t missing) {
  const auto found = object.find(key);
  if (found == object.end()) return missing;
  return found->is_number_unsigned() ? found->get<std::size_t>() : static_cast<std::size_t>(-1);
}

const Json* element(const Json& document, const char* array, std::size_t index) {
  const auto found = document.find(array);
  if (found == document.end() || !found->is_array() || index >= found->size() || !(*found)[index].is_object()) {
    return nullptr;
  }
  return &(*found)[index];
}

class TexelSizes {
 public:
  TexelSizes(const scene::Scene& scene, const Json& document) : scene_(scene), document_(document) {}

  void add_material(const Json& value) {
    if (value.is_array()) {
      for (const Json& item : value) add_material(item);
    }
    if (!value.is_object()) return;
    const auto index = value.find("index");
    if (index != value.end() && index->is_number_unsigned()) add_texture(value, index->get<std::size_t>());
    for (const auto& item : value.items()) add_material(item.value());
  }

  std::array<double, scene::kMaxUvSets> texels{};

 private:
  using Size = std::optional<ImageSize>;

  void add_texture(const Json& reference, std::size_t texture_index) {
    constexpr auto kNowhere = static_cast<std::size_t>(-1);
    std::size_t set = index_in(reference, "texCoord", 0);
    double scale[2] = {1.0, 1.0};
    const auto extensions = reference.find("extensions");
    if (extensions != reference.end() && extensions->is_object()) {
      const auto transform = extensions->find("KHR_texture_transform");
      if (transform != extensions->end() && transform->is_object()) {
        set = index_in(*transform, "texCoord", set);
        const auto scales = transform->find("scale");
        if (scales != transform->end() && scales->is_array() && scales->size() == 2 && (*scales)[0].is_number() &&
            (*scales)[1].is_number()) {
          for (std::size_t k = 0; k < 2; ++k) scale[k] = std::abs((*scales)[k].get<double>());
        }
      }
    }
    if (set >= scene::kMaxUvSets) return;
    const Json* const texture = element(document_, "textures", texture_index);
    const Json* const image =
        texture == nullptr ? nullptr : element(document_, "images", index_in(*texture, "source", kNowhere));
    const std::size_t blob = image == nullptr ? kNowhere : index_in(*image, "blob", kNowhere);
    if (blob >= scene_.blobs.size()) return;
    const auto [known, is_new] = sizes_.try_emplace(blob);
    if (is_new) known->second = read_image_size(scene_.blobs[blob].bytes);
    const Size& size = known->second;
    if (!size) return;
    const double most = std::max(size->width * scale[0], size->height * scale[1]);
    if (std::isfinite(most)) texels[set] = std::max(texels[set], most);
  }

  const scene::Scene& scene_;
  const Json& document_;
  std::map<std::size_t, Size> sizes_;  ///< of images that were looked at already
};

}  // namespace

std::vector<std::array<double, scene::kMaxUvSets>> texels_of_materials(const scene::Scene& scene) {
  std::vector<std::array<double, scene::kMaxUvSets>> out(scene.materials.size());
  const Json document = Json::parse(scene.document, nullptr, false);
  if (!document.is_object()) return out;
  TexelSizes sizes(scene, document);
  for (std::size_t i = 0; i < out.size(); ++i) {
    sizes.texels = {};
    if (const Json* const found = element(document, "materials", scene.materials[i].source_index)) {
      sizes.add_material(*found);
    }
    out[i] = sizes.texels;
  }
  return out;
}

std::array<double, scene::kMaxUvSets> texels_per_unit(
    std::span<const std::array<double, scene::kMaxUvSets>> of_materials, const scene::SourceMesh& mesh) {
  std::array<double, scene::kMaxUvSets> out{};
  for (const scene::Primitive& primitive : mesh.primitives) {
    if (primitive.material.value >= of_materials.size()) continue;
    for (std::size_t set = 0; set < out.size(); ++set) {
      out[set] = std::max(out[set], of_materials[primitive.material.value][set]);
    }
  }
  return out;
}

std::array<double, scene::kMaxUvSets> texels_per_unit(const scene::Scene& scene, const scene::SourceMesh& mesh) {
  return texels_per_unit(texels_of_materials(scene), mesh);
}

}  // namespace meshlode::build
