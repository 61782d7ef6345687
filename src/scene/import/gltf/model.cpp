// SPDX-License-Identifier: GPL-3.0-or-later
// The text that tinygltf reads. It is written from the checked tree rather than taken from the file, because tinygltf
//   opens what buffers and images name and keeps their bytes: both are withheld, and bytes are read where they are
//   mapped;
//   reads 3.0 as no integer, so whole numbers are written as such;
//   refuses strides that are no multiple of 4: they are withheld, and set in its model afterwards;
//   refuses indices whose accessor has no view (Draco's), skins without joints and channels without a node: each gets
//   what says the same and passes;
//   keeps whole numbers of extensions and extras in 32 bits and drops what is empty or null: both stay on the tree, and
//   with them materials, which mean more with their extensions than without, and all that is carried through.
// It checks no bounds: what import reads of its model are members that the checks have looked at, and every one that it
// keeps in an int was found to fit.
#include <exception>
#include <new>

#include "base/guarded.h"
#include "scene/import/gltf/gltf.h"

namespace meshlode::scene {

namespace {

/// Without extensions and extras, 3.0 as 3. `has_names`: the keys are names of attributes, which may be any.
Json plain(const Json& json, bool has_names = false) {
  if (const auto* array = json.array()) {
    Json::Array out;
    out.reserve(array->size());
    for (const Json& item : *array) out.push_back(plain(item, has_names));
    return Json{std::move(out)};
  }
  if (const auto* object = json.object()) {
    Json::Object out;
    for (const JsonMember& member : *object) {
      if (!has_names && (member.key == "extensions" || member.key == "extras")) continue;
      out.push_back({member.key, plain(member.value, member.key == "attributes" || member.key == "targets")});
    }
    return Json{std::move(out)};
  }
  const auto index = json.index();
  return index ? Json::make_index(*index) : json;
}

void set_missing(Json& object, std::string_view key, const Json& value) {
  if (object.find(key) == nullptr) object.set(key, value);
}

/// The list of that name, plain, with `mend` called on each of its objects.
template <class Mend>
Json mended(const Json& object, std::string_view key, const Mend& mend) {
  Json::Array out;
  for (const Json& item : object.items(key)) mend(out.emplace_back(plain(item)));
  return Json{std::move(out)};
}

/// The text, with an empty view after the last one, which accessors without a view name.
std::string text_for_tinygltf(const Json& root) {
  const Json empty_view = Json::make_index(root.items("bufferViews").size());
  const auto leave = [](Json&) {};
  Json out = Json::make_object();
  Json views = mended(root, "bufferViews", [](Json& view) { view.erase("byteStride"); });
  Json view = Json::make_object();
  view.set("buffer", Json::make_index(0));
  view.set("byteLength", Json::make_index(0));
  std::get<Json::Array>(views.value).push_back(std::move(view));
  out.set("bufferViews", std::move(views));
  out.set("accessors", mended(root, "accessors", [&](Json& a) { set_missing(a, "bufferView", empty_view); }));
  for (const std::string_view key : {"meshes", "nodes", "scenes"}) out.set(key, mended(root, key, leave));
  if (const Json* scene = root.find("scene")) out.set("scene", plain(*scene));
  out.set("skins", mended(root, "skins", [](Json& skin) { set_missing(skin, "joints", Json::make_array()); }));
  out.set("animations", mended(root, "animations", [](Json& animation) {
            Json* channels = animation.find("channels");
            if (channels == nullptr) return;
            for (Json& channel : std::get<Json::Array>(channels->value)) {
              set_missing(*channel.find("target"), "node", Json{std::int64_t{-1}});  // what tinygltf takes for none
            }
          }));
  return dump_json(out);
}

/// tinygltf's model of a text that names no file. `problems`: what it says beside refusing. What it throws is the
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

/// tinygltf leaves out a primitive or a channel that it does not understand; nothing may be missing quietly, and what
/// stays on the tree is found by its place.
bool is_whole(const tinygltf::Model& model, const Json& root) {
  const auto is_all = [](const auto& list, const Json& object, std::string_view key) {
    return list.size() == object.items(key).size();
  };
  bool out = is_all(model.bufferViews, root, "bufferViews") && is_all(model.accessors, root, "accessors") &&
             is_all(model.meshes, root, "meshes") && is_all(model.nodes, root, "nodes") &&
             is_all(model.scenes, root, "scenes") && is_all(model.skins, root, "skins") &&
             is_all(model.animations, root, "animations");
  const auto& meshes = root.items("meshes");
  for (std::size_t i = 0; out && i < meshes.size(); ++i) {
    out = is_all(model.meshes[i].primitives, meshes[i], "primitives");
  }
  const auto& animations = root.items("animations");
  for (std::size_t i = 0; out && i < animations.size(); ++i) {
    out = is_all(model.animations[i].channels, animations[i], "channels") &&
          is_all(model.animations[i].samplers, animations[i], "samplers");
  }
  return out;
}

}  // namespace

Result<tinygltf::Model> read_gltf_model(const Json& root) {
  const std::string text = text_for_tinygltf(root);
  if (text.size() > kMaxTextBytes) return Error{ErrorCode::kUnsupported, "", "more than 2 GiB of glTF text"};
  std::string problems;
  auto model = load_model(text, problems);
  if (!model) return model;
  const int empty_view = static_cast<int>(root.items("bufferViews").size());
  for (auto& accessor : model->accessors) {
    if (accessor.bufferView == empty_view) accessor.bufferView = -1;
  }
  if (!model->bufferViews.empty()) model->bufferViews.pop_back();
  const auto& views = root.items("bufferViews");
  for (std::size_t v = 0; v < views.size() && v < model->bufferViews.size(); ++v) {
    const Json* stride = views[v].find("byteStride");
    if (stride != nullptr) model->bufferViews[v].byteStride = stride->index().value_or(0);
  }
  if (!is_whole(*model, root)) {
    return Error{ErrorCode::kInvalid, "", "tinygltf did not understand every part of it: " + problems};
  }
  return model;
}

}  // namespace meshlode::scene
