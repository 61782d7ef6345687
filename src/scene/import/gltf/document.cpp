// SPDX-License-Identifier: GPL-3.0-or-later
// What the asset carries without understanding it: the glTF tree without its geometry, and the bytes of its images.
#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/printable.h"
#include "base/try.h"
#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/gltf_import.h"
#include "scene/import/gltf/uri.h"
#include "scene/import/gltf/variants.h"
#include "scene/import/image_mime.h"

namespace meshlode::scene {

namespace {

/// An extension that names binary data cannot travel: the accessors and views it points to are gone.
bool names_binary(const Json& json) {
  if (const auto* array = json.array()) {
    return std::any_of(array->begin(), array->end(), names_binary);
  }
  const auto* object = json.object();
  if (object == nullptr) return false;
  return std::any_of(object->begin(), object->end(), [](const JsonMember& member) {
    return member.key == "bufferView" || member.key == "accessor" || names_binary(member.value);
  });
}

/// The object's extensions without those that name binary data; false where some were dropped.
void drop_binary_extensions(Json& object, const std::string& what, std::vector<LeftOut>& left_out) {
  Json* extensions = object.find("extensions");
  if (extensions == nullptr || !extensions->is_object()) return;
  std::vector<std::string> dropped;
  for (const JsonMember& member : *extensions->object()) {
    if (member.key == "EXT_mesh_gpu_instancing" || names_binary(member.value)) dropped.push_back(member.key);
  }
  for (const std::string& key : dropped) {
    left_out.push_back({what + " " + pointer_part(key), "an extension with binary data that is not kept"});
  }
  std::sort(dropped.begin(), dropped.end());
  extensions->erase_all(dropped);
  if (extensions->object()->empty()) object.erase("extensions");
}

std::string image_name(const Json& image) {
  if (const Json* name = image.find("name")) return std::string(*name->string());
  const Json* uri = image.find("uri");
  if (uri == nullptr || is_data_uri(*uri->string())) return "";
  const std::string_view path = *uri->string();
  return std::string(path.substr(path.find_last_of("/\\") + 1));  // npos + 1 == 0
}

/// A URI in a message: no control characters, and not all of a long one.
std::string shown_uri(std::string_view uri) {
  constexpr std::size_t kMost = 200;
  std::size_t size = std::min(uri.size(), kMost);
  while (size > 0 && size < uri.size() && (static_cast<unsigned char>(uri[size]) & 0xC0U) == 0x80U) --size;
  return uri.empty() ? std::string() : printable(uri.substr(0, size), kMost);
}

/// The bytes of an image where it names any, and else why it has none.
struct ImageBytes {
  std::optional<std::span<const std::uint8_t>> bytes;
  std::string why;
};

Result<ImageBytes> find_image_bytes(const GltfAsset& asset, GltfFiles& files, const ImportOptions& options,
                                    const Json& image, const std::string& path) {
  using Found = ImageBytes;
  if (const Json* uri = image.find("uri")) {
    auto opened = files.open(*uri->string());
    if (!opened && options.may_lack_images) {
      // In the words of the scene: what the machine says would be another text on another one (I10).
      if (is_data_uri(*uri->string()))
        return Found{std::nullopt, "its data URI cannot be read: " + opened.error().detail};
      return Found{std::nullopt, "its file \"" + shown_uri(*uri->string()) + "\" " + reason_not_opened(opened.error())};
    }
    if (!opened) return asset.error(opened.error().code, path + "/uri", opened.error().detail);
    return Found{*opened, {}};
  }
  const Json* view = image.find("bufferView");
  if (view == nullptr) return Found{std::nullopt, "it names no bytes"};
  const auto bytes = asset.view_bytes(view->index().value_or(0), path + "/bufferView");
  if (!bytes && options.may_lack_images) return Found{std::nullopt, bytes.error().detail};
  if (!bytes) return bytes.error();
  return Found{*bytes, {}};
}

Status carry_images(const GltfAsset& asset, GltfFiles& files, const ImportOptions& options, Json& document,
                    Scene& scene) {
  Json::Array out;
  // Images that share their bytes share a blob, however their URIs are spelled; views that merely overlap do not, so
  // what they add up to is bounded by the buffers they lie in (I11).
  std::map<std::pair<const std::uint8_t*, std::size_t>, std::size_t> blob_of;
  std::vector<std::uint32_t> blob_of_image;
  std::uint64_t view_bytes = 0;
  std::uint64_t view_limit = std::uint64_t{1} << 20U;
  for (const auto& buffer : asset.buffers) view_limit += buffer.size();
  for (const auto& view : asset.decoded_views) view_limit += view.size();
  for (const Json& source : asset.root.items("images")) {
    const std::string path = "/images/" + std::to_string(out.size());
    TRY_LET(found, find_image_bytes(asset, files, options, source, path));
    Json image = source;
    image.erase("uri");
    image.erase("bufferView");
    blob_of_image.push_back(kNoId);
    if (!found->bytes) {
      scene.left_out.push_back({"image " + std::to_string(out.size()), found->why});
      out.push_back(std::move(image));
      continue;
    }
    const std::span<const std::uint8_t> bytes = *found->bytes;
    const auto [known, is_new] = blob_of.try_emplace({bytes.data(), bytes.size()}, scene.blobs.size());
    if (is_new) {
      if (source.find("uri") == nullptr) view_bytes += bytes.size();
      if (view_bytes > view_limit) {
        return asset.invalid(path, "images that overlap are larger than the buffers they lie in");
      }
      SceneBlob blob;
      blob.kind = SceneBlob::Kind::kImage;
      blob.name = image_name(source);
      const Json* mime = source.find("mimeType");
      blob.mime_type = mime != nullptr ? *mime->string() : std::string(sniff_image_mime(bytes));
      blob.source_index = static_cast<std::uint32_t>(out.size());
      blob.bytes.assign(bytes.begin(), bytes.end());
      scene.blobs.push_back(std::move(blob));
    }
    blob_of_image.back() = static_cast<std::uint32_t>(known->second);
    const SceneBlob& blob = scene.blobs[known->second];
    if (image.find("mimeType") == nullptr && !blob.mime_type.empty()) {
      image.set("mimeType", Json::make_string(blob.mime_type));
    }
    if (image.find("name") == nullptr && !image_name(source).empty()) {
      image.set("name", Json::make_string(image_name(source)));
    }
    image.set("blob", Json::make_index(known->second));
    out.push_back(std::move(image));
  }
  if (!out.empty()) document.set("images", Json{std::move(out)});
  for (SceneMaterial& material : scene.materials) {
    for (TextureUse& use : material.textures) {
      if (use.image != kNoId) use.blob = blob_of_image[use.image];
    }
  }
  return Ok{};
}

void carry_extension_names(const Json& root, Json& document) {
  constexpr std::string_view kGone[] = {"KHR_draco_mesh_compression", "KHR_mesh_quantization",
                                        "EXT_meshopt_compression",    "KHR_meshopt_compression",
                                        "EXT_mesh_gpu_instancing",    "KHR_mesh_primitive_restart",
                                        "EXT_mesh_primitive_restart"};
  for (const std::string_view key : {"extensionsUsed", "extensionsRequired"}) {
    Json::Array kept;
    for (const Json& name : root.items(key)) {
      if (std::find(std::begin(kGone), std::end(kGone), *name.string()) == std::end(kGone)) kept.push_back(name);
    }
    if (!kept.empty()) document.set(key, Json{std::move(kept)});
  }
}

void carry_nodes(const GltfAsset& asset, Json& document, Scene& scene) {
  Json::Array nodes;
  for (const Json& source : asset.root.items("nodes")) {
    Json node = source;
    node.erase("skin");
    node.erase("weights");
    drop_binary_extensions(node, "node " + std::to_string(nodes.size()), scene.left_out);
    nodes.push_back(std::move(node));
  }
  if (!nodes.empty()) document.set("nodes", Json{std::move(nodes)});
  Json::Array meshes;
  for (const Json& source : asset.root.items("meshes")) {
    Json mesh = Json::make_object();
    for (const std::string_view key : {"name", "extras"}) {
      if (const Json* member = source.find(key)) mesh.set(key, *member);
    }
    Json::Array primitives = variant_primitives(asset, meshes.size(), scene.left_out);
    if (!primitives.empty()) mesh.set("primitives", Json{std::move(primitives)});
    meshes.push_back(std::move(mesh));
  }
  if (!meshes.empty()) document.set("meshes", Json{std::move(meshes)});
}

}  // namespace

Status carry_document(GltfAsset& asset, GltfFiles& files, const ImportOptions& options, DecodeBudget& budget,
                      Scene& scene) {
  Json document = Json::make_object();
  // Moved, not copied: an asset's own data may be most of its text. Nothing looks at these after this.
  const auto take = [&](std::string_view key) {
    if (Json* member = asset.root.find(key)) document.set(key, std::move(*member));
  };
  take("asset");
  carry_extension_names(asset.root, document);
  take("scene");
  take("scenes");
  carry_nodes(asset, document, scene);
  for (const std::string_view key : {"materials", "textures", "samplers", "cameras"}) take(key);
  if (auto status = carry_images(asset, files, options, document, scene); !status) return status;
  if (auto status = carry_animations(asset, budget, document, scene); !status) return status;
  take("extensions");
  take("extras");
  drop_binary_extensions(document, "root", scene.left_out);
  scene.document = dump_json(document);
  return Ok{};
}

}  // namespace meshlode::scene
