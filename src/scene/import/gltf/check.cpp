// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes, materials, textures, images and animations of a glTF tree; the other checks are called from here.
#include <algorithm>

#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/variants.h"

namespace meshlode::scene {

namespace {

class GltfChecker : public JsonChecker {
 public:
  GltfChecker(const Json& root, const std::string& file) : JsonChecker(file), root_(root) {}

  void run() {
    for (const std::string_view key : {"meshes", "materials", "textures", "images", "samplers", "animations"}) {
      if (!objects(root_, "", key)) return;
    }
    if (!optional_object(root_, "", "extensions")) return;
    each("meshes", &GltfChecker::check_mesh);
    each("materials", &GltfChecker::check_material);
    each("textures", &GltfChecker::check_texture);
    each("images", &GltfChecker::check_image);
    each("animations", &GltfChecker::check_animation);
  }

 private:
  void each(std::string_view key, bool (GltfChecker::*check)(const Json&, const std::string&)) {
    const auto& items = root_.items(key);
    for (std::size_t i = 0; i < items.size() && ok(); ++i) {
      (this->*check)(items[i], "/" + std::string(key) + "/" + std::to_string(i));
    }
  }

  bool check_mesh(const Json& mesh, const std::string& path) {
    if (!optional_string(mesh, path, "name") || !objects(mesh, path, "primitives")) return false;
    if (mesh.find("primitives") == nullptr) return fail(path + "/primitives", "missing");
    const auto& primitives = mesh.items("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      if (!check_primitive(primitives[i], path + "/primitives/" + std::to_string(i))) return false;
    }
    return true;
  }

  bool check_primitive(const Json& primitive, const std::string& path) {
    const std::uint64_t accessor_count = root_.items("accessors").size();
    const Json* attributes = primitive.find("attributes");
    if (attributes == nullptr) return fail(path + "/attributes", "missing");
    if (!index_map(*attributes, path + "/attributes", accessor_count) ||
        !optional_index(primitive, path, "indices", accessor_count) ||
        !optional_index(primitive, path, "material", root_.items("materials").size()) ||
        !optional_index(primitive, path, "mode", 7) || !objects(primitive, path, "targets") ||
        !optional_object(primitive, path, "extensions")) {
      return false;
    }
    const auto& targets = primitive.items("targets");
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (!index_map(targets[i], path + "/targets/" + std::to_string(i), accessor_count)) return false;
    }
    const Json* extensions = primitive.find("extensions");
    const Json* draco = extensions != nullptr ? extensions->find("KHR_draco_mesh_compression") : nullptr;
    if (draco == nullptr) return true;
    const std::string here = path + "/extensions/KHR_draco_mesh_compression";
    if (!draco->is_object()) return fail(here, "not an object");
    if (draco->find("attributes") == nullptr) return fail(here + "/attributes", "missing");
    return required_index(*draco, here, "bufferView", root_.items("bufferViews").size()) &&
           index_map(*draco->find("attributes"), here + "/attributes", std::uint64_t{1} << 32U);
  }

  /// A texture reference of the core specification or of a KHR extension.
  bool check_texture_info(const Json& info, const std::string& path) {
    return required_index(info, path, "index", root_.items("textures").size()) &&
           optional_index(info, path, "texCoord", std::uint64_t{1} << 31U) && optional_object(info, path, "extensions");
  }

  bool check_textures_in(const Json& object, const std::string& path) {
    for (const JsonMember& member : *object.object()) {
      if (!member.key.ends_with("Texture") || !member.value.is_object()) continue;
      if (!check_texture_info(member.value, path + "/" + pointer_part(member.key))) return false;
    }
    return true;
  }

  bool check_material(const Json& material, const std::string& path) {
    if (!optional_string(material, path, "name") || !optional_string(material, path, "alphaMode") ||
        !optional_number(material, path, "alphaCutoff") || !optional_bool(material, path, "doubleSided") ||
        !optional_object(material, path, "pbrMetallicRoughness") || !optional_object(material, path, "extensions")) {
      return false;
    }
    for (const std::string_view key : {"normalTexture", "occlusionTexture", "emissiveTexture"}) {
      if (!optional_object(material, path, key)) return false;
    }
    if (!check_textures_in(material, path)) return false;
    if (const Json* pbr = material.find("pbrMetallicRoughness")) {
      const std::string here = path + "/pbrMetallicRoughness";
      if (!optional_numbers(*pbr, here, "baseColorFactor", 4) || !optional_object(*pbr, here, "baseColorTexture") ||
          !optional_object(*pbr, here, "metallicRoughnessTexture") || !check_textures_in(*pbr, here)) {
        return false;
      }
    }
    if (const Json* extensions = material.find("extensions")) {
      for (const JsonMember& extension : *extensions->object()) {
        const std::string here = path + "/extensions/" + pointer_part(extension.key);
        if (!extension.value.is_object()) return fail(here, "not an object");
        if (extension.key.starts_with("KHR_") && !check_textures_in(extension.value, here)) return false;
      }
      if (const Json* specular = extensions->find("KHR_materials_pbrSpecularGlossiness")) {
        const std::string here = path + "/extensions/KHR_materials_pbrSpecularGlossiness";
        if (!optional_numbers(*specular, here, "diffuseFactor", 4)) return false;
      }
    }
    return true;
  }

  bool check_texture(const Json& texture, const std::string& path) {
    if (!optional_index(texture, path, "source", root_.items("images").size()) ||
        !optional_index(texture, path, "sampler", root_.items("samplers").size()) ||
        !optional_object(texture, path, "extensions")) {
      return false;
    }
    const Json* extensions = texture.find("extensions");
    if (extensions == nullptr) return true;
    for (const std::string_view key :
         {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"}) {
      const Json* extension = extensions->find(key);
      if (extension == nullptr) continue;
      const std::string here = path + "/extensions/" + std::string(key);
      if (!extension->is_object()) return fail(here, "not an object");
      if (!optional_index(*extension, here, "source", root_.items("images").size())) return false;
    }
    return true;
  }

  bool check_image(const Json& image, const std::string& path) {
    if (!optional_string(image, path, "uri") || !optional_string(image, path, "name") ||
        !optional_string(image, path, "mimeType") ||
        !optional_index(image, path, "bufferView", root_.items("bufferViews").size())) {
      return false;
    }
    if (image.find("uri") != nullptr && image.find("bufferView") != nullptr) {
      return fail(path, "it has both a uri and a bufferView");
    }
    return true;
  }

  bool check_animation(const Json& animation, const std::string& path) {
    if (!optional_string(animation, path, "name") || !objects(animation, path, "samplers") ||
        !objects(animation, path, "channels")) {
      return false;
    }
    const auto& samplers = animation.items("samplers");
    const std::uint64_t accessor_count = root_.items("accessors").size();
    for (std::size_t i = 0; i < samplers.size(); ++i) {
      const std::string here = path + "/samplers/" + std::to_string(i);
      if (!required_index(samplers[i], here, "input", accessor_count) ||
          !required_index(samplers[i], here, "output", accessor_count)) {
        return false;
      }
      const Json* interpolation = samplers[i].find("interpolation");
      if (interpolation != nullptr && !interpolation->is_string() && interpolation->index() != 0) {
        return fail(here + "/interpolation", "not a string");
      }
    }
    const auto& channels = animation.items("channels");
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const std::string here = path + "/channels/" + std::to_string(i);
      if (!required_index(channels[i], here, "sampler", samplers.size())) return false;
      const Json* target = channels[i].find("target");
      if (target == nullptr || !target->is_object()) return fail(here + "/target", "missing or not an object");
      if (!optional_index(*target, here + "/target", "node", root_.items("nodes").size()) ||
          !optional_string(*target, here + "/target", "path")) {
        return false;
      }
      if (target->find("path") == nullptr) return fail(here + "/target/path", "missing");
    }
    return true;
  }

  const Json& root_;
};

/// Extensions that may be *required* and are honoured: geometry that is decoded, or looks that travel unchanged.
bool is_known_extension(std::string_view name) {
  constexpr std::string_view kKnown[] = {"KHR_draco_mesh_compression",
                                         "KHR_mesh_quantization",
                                         "EXT_meshopt_compression",
                                         "KHR_meshopt_compression",
                                         "EXT_mesh_gpu_instancing",
                                         "KHR_mesh_primitive_restart",
                                         "EXT_mesh_primitive_restart",
                                         "KHR_node_visibility",
                                         "KHR_texture_transform",
                                         "KHR_texture_basisu",
                                         "KHR_lights_punctual",
                                         "KHR_lights_image_based",
                                         "EXT_lights_image_based",
                                         "EXT_lights_ies",
                                         "KHR_technique_webgl",
                                         "KHR_techniques_webgl",
                                         "KHR_xmp",
                                         "KHR_xmp_json_ld"};
  if (std::find(std::begin(kKnown), std::end(kKnown), name) != std::end(kKnown)) return true;
  // Vendor_materials_x and Vendor_texture_x change how a surface looks, not where it is.
  const std::size_t bar = name.find('_');
  if (bar == std::string_view::npos) return false;
  const std::string_view rest = name.substr(bar + 1);
  return rest.starts_with("materials_") || rest.starts_with("texture_");
}

}  // namespace

Status check_gltf_extensions(const Json& root, const std::string& file) {
  JsonChecker checker(file);
  for (const std::string_view key : {"extensionsUsed", "extensionsRequired"}) {
    const Json* list = root.find(key);
    if (list == nullptr) continue;
    if (!list->is_array()) {
      checker.fail("/" + std::string(key), "not an array");
      return checker.status();
    }
    for (std::size_t i = 0; i < list->array()->size(); ++i) {
      const std::string path = "/" + std::string(key) + "/" + std::to_string(i);
      const auto name = (*list->array())[i].string();
      if (!name) {
        checker.fail(path, "not a string");
      } else if (key == "extensionsRequired" && !is_known_extension(*name)) {
        checker.fail(path, "the required extension " + pointer_part(*name) + " is not supported",
                     ErrorCode::kUnsupported);
      }
    }
  }
  return checker.status();
}

Status check_gltf(const Json& root, const std::string& file) {
  JsonChecker head(file);
  if (!root.is_object()) {
    head.fail("", "not a JSON object");
    return head.status();
  }
  const auto is_large = [](const Json* json) {
    return json != nullptr && json->is_object() && json->object()->size() > JsonChecker::kMaxMembers;
  };
  const Json* root_extensions = root.find("extensions");
  const Json* lights = root_extensions != nullptr ? root_extensions->find("KHR_lights_punctual") : nullptr;
  if (is_large(&root) || is_large(root_extensions) || is_large(lights)) {
    head.fail("", "more than " + std::to_string(JsonChecker::kMaxMembers) + " members");
    return head.status();
  }
  const Json* asset = root.find("asset");
  const Json* version = asset != nullptr ? asset->find("version") : nullptr;
  const Json* min_version = asset != nullptr ? asset->find("minVersion") : nullptr;
  if (version == nullptr || !version->is_string()) {
    head.fail("/asset/version", "missing or not a string: is this glTF?");
  } else if (!version->string()->starts_with("2.")) {
    head.fail("/asset/version", "glTF " + pointer_part(*version->string()) + " is not supported, only 2.0",
              ErrorCode::kUnsupported);
  } else if (min_version != nullptr && (!min_version->is_string() || *min_version->string() != "2.0")) {
    head.fail("/asset/minVersion", "it asks for a later version than 2.0", ErrorCode::kUnsupported);
  }
  if (!head.ok()) return head.status();
  if (auto status = check_gltf_extensions(root, file); !status) return status;
  if (auto status = check_gltf_accessors(root, file); !status) return status;
  if (auto status = check_gltf_meshopt(root, file); !status) return status;
  GltfChecker checker(root, file);
  checker.run();
  if (!checker.ok()) return checker.status();
  if (auto status = check_gltf_variants(root, file); !status) return status;
  if (auto status = check_gltf_nodes(root, file); !status) return status;
  return check_gltf_lost_geometry(root, file);
}

}  // namespace meshlode::scene
