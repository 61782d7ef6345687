// SPDX-License-Identifier: GPL-3.0-or-later
// The one file that sees tinygltf. It checks no bounds, opens what URIs name and throws, so it gets neither the file
// nor its buffers: only a skeleton of views, accessors, meshes and nodes, written from a tree that has been checked,
// with callbacks that refuse every file. Images and materials never pass through it.
//
// The namespace is renamed: Debian's TinyGLTF library is the same code with other options, and a program that links
// both must not mix them.
#include "scene/import/gltf/gltf.h"

#include <exception>
#include <fstream>
#include <new>

#define tinygltf meshlode_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include "base/guarded.h"

namespace meshlode::scene {

namespace {

Json copy_members(const Json& from, std::initializer_list<std::string_view> keys) {
  Json out = Json::make_object();
  for (const std::string_view key : keys) {
    if (const Json* member = from.find(key)) out.set(key, *member);
  }
  return out;
}

/// tinygltf reads integers with get<int>(), which accepts only JSON integers: 3.0 is written as 3.
void normalize_integers(Json& json) {
  if (auto* array = std::get_if<Json::Array>(&json.value)) {
    for (Json& item : *array) normalize_integers(item);
  } else if (auto* object = std::get_if<Json::Object>(&json.value)) {
    for (JsonMember& member : *object) normalize_integers(member.value);
  } else if (std::holds_alternative<double>(json.value)) {
    if (const auto index = json.index()) json = Json::make_index(*index);
  }
}

/// The skeleton. Index accessors without a view (as Draco's are) point to a sentinel view after the last one, because
/// tinygltf refuses them otherwise.
Json make_skeleton(const Json& root) {
  const std::uint64_t sentinel = root.items("bufferViews").size();
  Json out = Json::make_object();
  Json asset = Json::make_object();
  asset.set("version", Json::make_string("2.0"));
  out.set("asset", std::move(asset));

  Json::Array views;
  for (const Json& view : root.items("bufferViews")) {
    views.push_back(copy_members(view, {"buffer", "byteOffset", "byteLength", "byteStride"}));
  }
  Json last = Json::make_object();
  last.set("buffer", Json::make_index(0));
  last.set("byteLength", Json::make_index(0));
  views.push_back(std::move(last));
  Json::Array accessors;
  for (const Json& accessor : root.items("accessors")) {
    Json item = copy_members(accessor, {"bufferView", "byteOffset", "componentType", "normalized", "count", "type"});
    if (item.find("bufferView") == nullptr) item.set("bufferView", Json::make_index(sentinel));
    if (const Json* sparse = accessor.find("sparse")) {
      Json part = copy_members(*sparse, {"count"});
      part.set("indices", copy_members(*sparse->find("indices"), {"bufferView", "byteOffset", "componentType"}));
      part.set("values", copy_members(*sparse->find("values"), {"bufferView", "byteOffset"}));
      item.set("sparse", std::move(part));
    }
    accessors.push_back(std::move(item));
  }
  Json::Array meshes;
  for (const Json& mesh : root.items("meshes")) {
    Json item = copy_members(mesh, {"name"});
    Json::Array primitives;
    for (const Json& primitive : mesh.items("primitives")) {
      primitives.push_back(copy_members(primitive, {"attributes", "indices", "material", "mode", "targets"}));
    }
    item.set("primitives", Json{std::move(primitives)});
    meshes.push_back(std::move(item));
  }
  Json::Array nodes;
  for (const Json& node : root.items("nodes")) {
    nodes.push_back(
        copy_members(node, {"name", "mesh", "skin", "children", "matrix", "translation", "rotation", "scale"}));
  }
  out.set("bufferViews", Json{std::move(views)});
  out.set("accessors", Json{std::move(accessors)});
  out.set("meshes", Json{std::move(meshes)});
  out.set("nodes", Json{std::move(nodes)});
  normalize_integers(out);
  return out;
}

std::uint32_t to_index(int value) {
  return value < 0 ? kNoIndex : static_cast<std::uint32_t>(value);
}

GltfModel convert(const tinygltf::Model& model) {
  GltfModel out;
  const std::size_t sentinel = model.bufferViews.size() - 1;
  for (std::size_t i = 0; i < sentinel; ++i) {
    const auto& view = model.bufferViews[i];
    out.views.push_back(
        {to_index(view.buffer), view.byteOffset, view.byteLength, static_cast<std::uint32_t>(view.byteStride)});
  }
  for (const auto& accessor : model.accessors) {
    GltfAccessor a;
    if (to_index(accessor.bufferView) < sentinel) a.view = to_index(accessor.bufferView);
    a.offset = accessor.byteOffset;
    a.count = accessor.count;
    a.component_type = static_cast<std::uint32_t>(accessor.componentType);
    a.component_count =
        static_cast<std::uint32_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
    a.normalized = accessor.normalized;
    if (accessor.sparse.isSparse) {
      const auto& s = accessor.sparse;
      a.sparse = GltfSparse{static_cast<std::uint64_t>(s.count),
                            to_index(s.indices.bufferView),
                            to_index(s.values.bufferView),
                            static_cast<std::uint64_t>(s.indices.byteOffset),
                            static_cast<std::uint64_t>(s.values.byteOffset),
                            static_cast<std::uint32_t>(s.indices.componentType)};
    }
    out.accessors.push_back(a);
  }
  for (const auto& mesh : model.meshes) {
    GltfMesh m{mesh.name, {}};
    for (const auto& primitive : mesh.primitives) {
      GltfPrimitive p;
      for (const auto& [name, index] : primitive.attributes) p.attributes[name] = to_index(index);
      p.indices = to_index(primitive.indices);
      p.material = to_index(primitive.material);
      p.mode = static_cast<std::uint32_t>(primitive.mode);
      p.target_count = primitive.targets.size();
      m.primitives.push_back(std::move(p));
    }
    out.meshes.push_back(std::move(m));
  }
  for (const auto& node : model.nodes) {
    GltfNode n{node.name,   to_index(node.mesh), to_index(node.skin), {},
               node.matrix, node.translation,    node.rotation,       node.scale};
    for (const int child : node.children) n.children.push_back(to_index(child));
    out.nodes.push_back(std::move(n));
  }
  return out;
}

/// tinygltf's own model of a text that names no file. `problems`: what it says beside refusing. What it throws is the
/// text's fault: that was checked, but by our rules.
Result<tinygltf::Model> load_model(const std::string& text, std::string& problems) {
  tinygltf::TinyGLTF loader;
  tinygltf::FsCallbacks no_files{};
  no_files.FileExists = [](const std::string&, void*) { return false; };
  no_files.ExpandFilePath = [](const std::string& path, void*) { return path; };
  no_files.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; };
  no_files.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  loader.SetFsCallbacks(no_files);
  tinygltf::Model model;
  std::string warnings;
  try {
    if (!loader.LoadASCIIFromString(&model, &problems, &warnings, text.c_str(), static_cast<unsigned int>(text.size()),
                                    "", tinygltf::NO_REQUIRE)) {
      return Error{ErrorCode::kInvalid, "", "tinygltf: " + problems};
    }
  } catch (const std::bad_alloc&) {
    return out_of_memory({});
  } catch (const std::exception& error) {
    return Error{ErrorCode::kInvalid, "", std::string("tinygltf: ") + error.what()};
  }
  return model;
}

/// tinygltf leaves out a primitive that it does not understand; nothing may be missing quietly.
bool is_whole(const tinygltf::Model& model, const Json& root) {
  const auto& meshes = root.items("meshes");
  bool out = model.meshes.size() == meshes.size() && model.nodes.size() == root.items("nodes").size() &&
             model.accessors.size() == root.items("accessors").size() &&
             model.bufferViews.size() == root.items("bufferViews").size() + 1;
  for (std::size_t i = 0; out && i < meshes.size(); ++i) {
    out = model.meshes[i].primitives.size() == meshes[i].items("primitives").size();
  }
  return out;
}

}  // namespace

Result<GltfModel> parse_gltf_model(const Json& root) {
  const Json skeleton = make_skeleton(root);
  const std::string text = dump_json(skeleton);
  if (text.size() > 0x7FFFFFFFu) return Error{ErrorCode::kUnsupported, "", "more than 2 GiB of glTF text"};
  std::string problems;
  const auto model = load_model(text, problems);
  if (!model) return model.error();
  if (!is_whole(*model, root)) {
    return Error{ErrorCode::kInvalid, "", "tinygltf did not understand every part of it: " + problems};
  }
  return convert(*model);
}

}  // namespace meshlode::scene
