// SPDX-License-Identifier: GPL-3.0-or-later
// A glTF or GLB file, from bytes to a Scene: container, text, checks, buffers, geometry, and what travels unchanged.
#include "scene/import/gltf/gltf_import.h"

#include <cstring>
#include <optional>
#include <set>
#include <string_view>

#include "base/try.h"
#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/choose_scene.h"
#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/instancing.h"
#include "scene/import/gltf/merge_meshes.h"
#include "scene/import/gltf/meshopt_views.h"
#include "scene/import/gltf/primitive.h"
#include "scene/import/gltf/skins.h"
#include "scene/import/gltf/uri.h"
#include "scene/import/gltf/variants.h"

namespace meshlode::scene {

namespace {

struct Container {
  std::string_view text;
  std::optional<std::span<const std::uint8_t>> binary;
};

std::uint32_t load_u32(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

constexpr std::uint32_t kJsonChunk = 0x4E4F534Au, kBinChunk = 0x004E4942u;

/// Whether a chunk that stays inside the file could begin there.
bool may_be_chunk(std::span<const std::uint8_t> bytes, std::size_t at) {
  return at <= bytes.size() && bytes.size() - at >= 8 && load_u32(bytes, at) <= bytes.size() - at - 8;
}

/// Where the chunk after one that ends at `end` begins. Chunks start at multiples of 4 and their lengths count the
/// padding, but writers exist that leave the padding out, and others that do not count it.
std::size_t next_chunk(std::span<const std::uint8_t> bytes, std::size_t end) {
  const std::size_t rounded = std::min(bytes.size(), (end + 3) / 4 * 4);
  if (end == rounded || !may_be_chunk(bytes, end)) return rounded;
  const bool is_exact = load_u32(bytes, end + 4) == kBinChunk || !may_be_chunk(bytes, rounded);
  return is_exact ? end : rounded;
}

/// GLB (glTF 2.0, section 4.4) or plain text. The binary chunk stays where it is mapped.
Result<Container> open_container(const std::string& file, std::span<const std::uint8_t> bytes) {
  const auto bad = [&](const std::string& place, std::string why) {
    return Error{ErrorCode::kInvalid, file + ": " + place, std::move(why)};
  };
  if (bytes.size() < 4 || std::memcmp(bytes.data(), "glTF", 4) != 0) return Container{as_text(bytes), std::nullopt};
  if (bytes.size() < 20) return bad("GLB header", "cut short");
  const std::uint32_t version = load_u32(bytes, 4);
  if (version != 2) {
    return Error{ErrorCode::kUnsupported, file + ": GLB header",
                 "version " + std::to_string(version) + " is not supported, only 2"};
  }
  const std::uint32_t length = load_u32(bytes, 8);
  if (length > bytes.size() || length < 20) {
    return bad("GLB header",
               "its length of " + std::to_string(length) + " is not the file's " + std::to_string(bytes.size()));
  }
  bytes = bytes.first(length);
  Container out;
  std::size_t at = 12;
  for (std::size_t chunk = 0; at < bytes.size(); ++chunk) {
    const std::string place = "GLB chunk " + std::to_string(chunk);
    if (bytes.size() - at < 8) return bad(place, "its header is cut short");
    const std::uint32_t size = load_u32(bytes, at);
    const std::uint32_t type = load_u32(bytes, at + 4);
    at += 8;
    if (size > bytes.size() - at) {
      return bad(place, "its length of " + std::to_string(size) + " leaves the file");
    }
    const auto body = bytes.subspan(at, size);
    if (chunk == 0 && type != kJsonChunk) return bad(place, "the first chunk is not JSON");
    if (chunk == 0) out.text = as_text(body);
    if (chunk == 1 && type == kBinChunk) out.binary = body;  // other chunks are to be ignored
    at = next_chunk(bytes, at + size);
  }
  return out;
}

/// The JSON of a container.
Result<Json> read_tree(const std::string& file, std::string_view text) {
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
  if (text.size() > kMaxTextBytes) return Error{ErrorCode::kUnsupported, file, "more than 2 GiB of glTF text"};
  auto root = parse_json(text);
  if (!root) return Error{ErrorCode::kInvalid, file, root.error().detail};
  return root;
}

Status load_buffers(GltfAsset& asset, GltfFiles& files, const Container& container) {
  const auto& buffers = asset.root.items("buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string path = "/buffers/" + std::to_string(i);
    std::span<const std::uint8_t> bytes;
    const std::uint64_t length = index_or(buffers[i], "byteLength", 0);
    if (is_meshopt_fallback(buffers[i])) {
      asset.buffers.emplace_back();  // every view in it is compressed, and read from where its extension says
      continue;
    }
    if (const Json* uri = buffers[i].find("uri")) {
      auto opened = files.open(*uri->string());
      if (!opened) return asset.error(opened.error().code, path + "/uri", opened.error().detail);
      bytes = *opened;
    } else if (i == 0 && container.binary) {
      bytes = *container.binary;
    } else {
      asset.buffers.emplace_back();  // a buffer that only an extension fills; to read from it is an error
      continue;
    }
    if (bytes.size() < length) {
      return asset.invalid(
          path, "it has " + std::to_string(bytes.size()) + " bytes where byteLength says " + std::to_string(length));
    }
    asset.buffers.push_back(bytes.first(length));
  }
  return Ok{};
}

std::uint64_t count_draco_bytes(const GltfAsset& asset) {
  std::set<std::uint64_t> views;
  for (const Json& mesh : asset.root.items("meshes")) {
    for (const Json& primitive : mesh.items("primitives")) {
      const Json* extensions = primitive.find("extensions");
      const Json* draco = extensions != nullptr ? extensions->find("KHR_draco_mesh_compression") : nullptr;
      if (draco != nullptr) views.insert(index_or(*draco, "bufferView", 0));
    }
  }
  std::uint64_t sum = 0;
  for (const std::uint64_t view : views) sum += asset.model.bufferViews[view].byteLength;
  return sum;
}

/// EXT_ has groups of primitives besides, whose parts stand for themselves.
bool declares_restarts(const Json& root) {
  for (const Json& name : root.items("extensionsUsed")) {
    if (name.string()->ends_with("_mesh_primitive_restart")) return true;
  }
  for (const Json& name : root.items("extensionsRequired")) {
    if (name.string()->ends_with("_mesh_primitive_restart")) return true;
  }
  return false;
}

/// `weights`: of the vertices of those that a skin moves, by mesh and primitive.
Status read_meshes(const GltfAsset& asset, const ImportOptions& options, DecodeBudget& budget, Scene& scene,
                   std::vector<std::vector<VertexWeights>>& weights) {
  PrimitiveContext context{&asset, &options, &budget, &scene.left_out};
  context.has_restarts = declares_restarts(asset.root);
  const std::vector<bool> is_skinned = find_skinned_meshes(asset);
  weights.resize(asset.model.meshes.size());
  bool needs_default_material = false;
  const Json::Array& meshes = asset.root.items("meshes");  // looked up once: an object's members are a list
  for (std::size_t m = 0; m < asset.model.meshes.size(); ++m) {
    const tinygltf::Mesh& source = asset.model.meshes[m];
    SourceMesh mesh;
    mesh.name = source.name;
    bool has_targets = false;
    std::set<std::string> extensions;
    const Json::Array& primitives = meshes[m].items("primitives");
    for (std::size_t p = 0; p < source.primitives.size(); ++p) {
      has_targets = has_targets || !source.primitives[p].targets.empty();
      const Json& json = primitives[p];
      if (const Json* object = json.find("extensions")) {
        for (const JsonMember& member : *object->object()) extensions.insert(pointer_part(member.key));
      }
      VertexWeights of_primitive;
      TRY_LET(primitive, read_primitive(context, m, p, json, mesh.drops, is_skinned[m] ? &of_primitive : nullptr));
      if (!*primitive) continue;
      weights[m].push_back(std::move(of_primitive));
      needs_default_material = needs_default_material || !(*primitive)->material.is_valid();
      mesh.primitives.push_back(std::move(**primitive));
    }
    const std::string what = "mesh " + std::to_string(m) + " ";
    mesh.is_deformed = has_targets;
    if (has_targets) scene.left_out.push_back({what + "morph targets", "only the base shape is built"});
    extensions.erase("KHR_draco_mesh_compression");
    extensions.erase("KHR_materials_variants");
    for (const std::string& name : extensions) {
      scene.left_out.push_back({what + name, "an extension of primitives that is not kept"});
    }
    if (const Json* object = meshes[m].find("extensions"); object != nullptr && object->is_object()) {
      for (const JsonMember& member : *object->object()) {
        if (member.key.ends_with("_mesh_primitive_restart")) continue;  // its groups are of the primitives themselves
        scene.left_out.push_back({what + pointer_part(member.key), "an extension of meshes that is not kept"});
      }
    }
    scene.meshes.push_back(std::move(mesh));
  }
  if (context.clamped_colors != 0) {
    scene.left_out.push_back({"COLOR_0 of " + std::to_string(context.clamped_colors) + " vertices",
                              "values above 1 or below 0 are clamped to 0 … 1"});
  }
  if (context.whole_colors != 0) {
    scene.left_out.push_back({"COLOR_0 of " + std::to_string(context.whole_colors) + " vertices",
                              "whole numbers that are not said to be normalized; they are taken as if they were"});
  }
  if (!needs_default_material) return Ok{};
  const MaterialId default_material(scene.materials.size());
  scene.materials.emplace_back();
  for (SourceMesh& mesh : scene.meshes) {
    for (Primitive& primitive : mesh.primitives) {
      if (!primitive.material.is_valid()) primitive.material = default_material;
    }
  }
  return Ok{};
}

/// Where import finds the file of a URI, or would find it were it there. Errors: as resolve_uri, but never kIo.
Result<std::vector<std::filesystem::path>> places_of_uri(const std::filesystem::path& folder, std::string_view uri,
                                                         std::span<const std::filesystem::path> allow_outside) {
  std::vector<std::filesystem::path> missing;
  for (const std::string& name : paths_of_uri(uri)) {
    const std::filesystem::path where = folder / std::filesystem::path(name).lexically_normal();
    const auto found = resolve_below(folder, name, allow_outside);
    if (found) return std::vector{where};
    if (found.error().code == ErrorCode::kIo) missing.push_back(where);
  }
  if (!missing.empty()) return missing;
  return resolve_uri(folder, uri, allow_outside).error();
}

}  // namespace

Result<std::span<const std::uint8_t>> GltfAsset::view_bytes(std::size_t view, const std::string& json_path) const {
  if (!decoded_views.empty() && !decoded_views[view].empty()) {
    return std::span<const std::uint8_t>(decoded_views[view]);
  }
  const tinygltf::BufferView& v = model.bufferViews[view];
  const auto& bytes = buffers[v.buffer];
  if (!bytes.empty()) return bytes.subspan(v.byteOffset, v.byteLength);
  if (v.byteLength == 0) return bytes;
  const Json* extensions = root.items("bufferViews")[view].find("extensions");
  if (extensions != nullptr && extensions->object() != nullptr && !extensions->object()->empty()) {
    return error(ErrorCode::kUnsupported, json_path,
                 "its buffer has no data: the bytes lie in " + pointer_part((*extensions->object())[0].key) +
                     ", an extension that is not read, though optional here");
  }
  return invalid(json_path, "its buffer has no data");
}

Result<Scene> import_gltf(const std::filesystem::path& path, std::span<const std::uint8_t> bytes,
                          const ImportOptions& options) {
  GltfAsset asset;
  asset.file = path.string();
  TRY_LET(container, open_container(asset.file, bytes));
  TRY_LET(root, read_tree(asset.file, container->text));
  asset.root = std::move(*root);
  TRY(check_gltf(asset.root, asset.file));
  Scene scene;
  mend_gltf(asset.root, scene.left_out);

  GltfFiles files(path.parent_path(), options.files_read, options.allow_outside);
  files.hash(bytes);
  TRY(load_buffers(asset, files, *container));
  auto model = read_gltf_model(asset.root);
  if (!model) return Error{model.error().code, asset.file, model.error().detail};
  asset.model = std::move(*model);
  TRY(choose_scene(asset, options.scene));

  const std::uint64_t file_bytes = bytes.size() + files.total_bytes();
  const std::uint64_t stream_bytes = std::min(count_meshopt_bytes(asset.root), file_bytes);
  const std::uint64_t max_view_bytes =
      std::max(16 * stream_bytes, std::min(kMeshoptMaxExpansion * stream_bytes, options.max_decoded));
  TRY(decode_meshopt_views(asset, max_view_bytes));

  // Streams may overlap, and one of Draco's may come out of a compressed view: no more of them than the files have.
  const std::uint64_t draco_bytes = std::min(count_draco_bytes(asset), file_bytes);
  DecodeBudget budget(file_bytes, std::min(draco_bytes + stream_bytes, file_bytes), options.max_decoded);
  scene.materials = read_materials(asset, scene.left_out);
  keep_uv_sets_of_variants(asset, scene.materials);
  std::vector<std::vector<VertexWeights>> weights;
  TRY(read_meshes(asset, options, budget, scene, weights));
  if (auto status = expand_instancing(asset, budget, file_bytes, options.max_decoded, scene.left_out); !status) {
    return status.error();
  }
  TRY(settle_skins(asset, weights, budget, scene));
  weights.clear();
  scene.instances = read_instances(asset, options.scene, scene.left_out);
  scene.choice = options.scene;
  merge_equal_meshes(asset, scene);
  TRY(carry_document(asset, files, options, budget, scene));
  scene.source_hash = files.hash_hex();
  return scene;
}

Result<std::vector<FileReference>> list_gltf_references(const std::filesystem::path& path,
                                                        std::span<const std::uint8_t> bytes,
                                                        std::span<const std::filesystem::path> allow_outside) {
  using Kind = FileReference::Kind;
  const std::string file = path.string();
  TRY_LET(container, open_container(file, bytes));
  TRY_LET(root, read_tree(file, container->text));
  std::vector<FileReference> references;
  std::set<std::filesystem::path> known;
  for (const Kind kind : {Kind::kBuffer, Kind::kImage}) {
    const std::string_view key = kind == Kind::kBuffer ? "buffers" : "images";
    const Json::Array& items = root->items(key);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Json* uri = items[i].find("uri");
      if (uri == nullptr || !uri->is_string() || is_data_uri(*uri->string())) continue;
      if (kind == Kind::kBuffer && is_meshopt_fallback(items[i])) continue;
      const auto places = places_of_uri(path.parent_path(), *uri->string(), allow_outside);
      if (!places && kind == Kind::kBuffer) {
        const std::string place = file + ": /" + std::string(key) + "/" + std::to_string(i) + "/uri";
        return Error{places.error().code, place, places.error().detail};
      }
      if (!places) {
        references.push_back({kind, std::string(*uri->string()), {}});
        continue;
      }
      for (const std::filesystem::path& where : *places) {
        if (known.insert(where).second) references.push_back({kind, std::string(*uri->string()), where});
      }
    }
  }
  return references;
}

}  // namespace meshlode::scene
