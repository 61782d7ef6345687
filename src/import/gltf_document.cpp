// SPDX-License-Identifier: GPL-3.0-or-later
// What the asset carries without understanding it: the glTF tree without its geometry, and the bytes of its images.
#include <algorithm>
#include <map>

#include "import/gltf_check_base.h"
#include "import/gltf_import.h"

namespace meshlode {

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
    extensions->erase(key);
    left_out.push_back({what + " " + pointer_part(key), "an extension with binary data that is not kept"});
  }
  if (extensions->object()->empty()) object.erase("extensions");
}

std::string_view sniff_mime(std::span<const std::uint8_t> bytes) {
  const auto starts = [&](std::initializer_list<int> magic) {
    return bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin(), [](int a, std::uint8_t b) { return a == b; });
  };
  if (starts({0x89, 'P', 'N', 'G'})) return "image/png";
  if (starts({0xFF, 0xD8, 0xFF})) return "image/jpeg";
  if (starts({0xAB, 'K', 'T', 'X'})) return "image/ktx2";
  if (starts({'R', 'I', 'F', 'F'})) return "image/webp";
  if (starts({'D', 'D', 'S', ' '})) return "image/vnd-ms.dds";
  return "";
}

std::string image_name(const Json& image) {
  if (const Json* name = image.find("name")) return *name->string();
  const Json* uri = image.find("uri");
  if (uri == nullptr || uri->string()->starts_with("data:")) return "";
  const std::string& path = *uri->string();
  return path.substr(path.find_last_of('/') + 1);  // npos + 1 == 0
}

Status carry_images(const GltfAsset& asset, GltfFiles& files, Json& document, Scene& scene) {
  Json::Array out;
  std::map<std::string, std::size_t> blob_of;  // images that share their bytes share a blob
  const auto& images = asset.root.items("images");
  std::uint64_t view_bytes = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::string path = "/images/" + std::to_string(i);
    Json image = images[i];
    std::span<const std::uint8_t> bytes;
    std::string key;  // a uri, or a newline (which no uri has) and the view
    if (const Json* uri = images[i].find("uri")) {
      key = *uri->string();
    } else if (const Json* view = images[i].find("bufferView")) {
      key = "\nview " + std::to_string(view->index().value_or(0));
    }
    image.erase("uri");
    image.erase("bufferView");
    if (key.empty()) {
      scene.left_out.push_back({"image " + std::to_string(i), "it names no bytes"});
      out.push_back(std::move(image));
      continue;
    }
    auto known = blob_of.find(key);
    if (known == blob_of.end()) {
      if (images[i].find("uri") != nullptr) {
        auto opened = files.open(key);
        if (!opened) return asset.error(opened.error().code, path + "/uri", opened.error().detail);
        bytes = *opened;
      } else {
        const auto view = static_cast<std::uint32_t>(images[i].find("bufferView")->index().value_or(0));
        const GltfBufferView& v = asset.model.views[view];
        if (v.length > 0 && asset.buffers[v.buffer].empty()) {
          return asset.invalid(path + "/bufferView", "its buffer has no data");
        }
        bytes = asset.view_bytes(view);
        // Views may overlap; the same bytes under many names must not grow without bound (I11).
        view_bytes += bytes.size();
        std::uint64_t limit = std::uint64_t{1} << 20U;
        for (const auto& buffer : asset.buffers) limit += buffer.size();
        if (view_bytes > limit)
          return asset.invalid(path, "images that overlap are larger than the buffers they lie in");
      }
      SceneBlob blob;
      blob.kind = SceneBlob::Kind::kImage;
      blob.name = image_name(images[i]);
      const Json* mime = images[i].find("mimeType");
      blob.mime_type = mime != nullptr ? *mime->string() : std::string(sniff_mime(bytes));
      blob.source_index = static_cast<std::uint32_t>(i);
      blob.bytes.assign(bytes.begin(), bytes.end());
      known = blob_of.emplace(key, scene.blobs.size()).first;
      scene.blobs.push_back(std::move(blob));
    }
    const SceneBlob& blob = scene.blobs[known->second];
    if (image.find("mimeType") == nullptr && !blob.mime_type.empty()) {
      image.set("mimeType", Json::make_string(blob.mime_type));
    }
    if (image.find("name") == nullptr && !image_name(images[i]).empty()) {
      image.set("name", Json::make_string(image_name(images[i])));
    }
    image.set("blob", Json::make_index(known->second));
    out.push_back(std::move(image));
  }
  if (!out.empty()) document.set("images", Json{std::move(out)});
  return Ok{};
}

void carry_extension_names(const Json& root, Json& document) {
  constexpr std::string_view kGone[] = {"KHR_draco_mesh_compression", "KHR_mesh_quantization",
                                        "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"};
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
    meshes.push_back(std::move(mesh));
  }
  if (!meshes.empty()) document.set("meshes", Json{std::move(meshes)});
}

}  // namespace

Status carry_document(const GltfAsset& asset, GltfFiles& files, DecodeBudget& budget, Scene& scene) {
  Json document = Json::make_object();
  const auto copy = [&](std::string_view key) {
    if (const Json* member = asset.root.find(key)) document.set(key, *member);
  };
  copy("asset");
  carry_extension_names(asset.root, document);
  copy("scene");
  copy("scenes");
  carry_nodes(asset, document, scene);
  for (const std::string_view key : {"materials", "textures", "samplers", "cameras"}) copy(key);
  if (auto status = carry_images(asset, files, document, scene); !status) return status;
  if (auto status = carry_animations(asset, budget, document, scene); !status) return status;
  copy("extensions");
  copy("extras");
  drop_binary_extensions(document, "root", scene.left_out);
  scene.document = dump_json(document);
  return Ok{};
}

}  // namespace meshlode
