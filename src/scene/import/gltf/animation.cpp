// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid node animation travels as it is; its accessors are compacted into one buffer. A channel that moves only joints
// or weights has nothing left to move in a static asset and is left out.
#include <cstring>
#include <map>

#include "base/try.h"
#include "scene/import/gltf/accessor.h"
#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/gltf_import.h"

namespace meshlode::scene {

namespace {

/// Copies accessors into one buffer, each once.
class AccessorPacker {
 public:
  AccessorPacker(const GltfAsset& asset, DecodeBudget& budget) : asset_(asset), budget_(budget) {}

  /// The new index of an accessor.
  Result<std::uint64_t> add(int source) {
    if (const auto known = index_of_.find(source); known != index_of_.end()) return known->second;
    const std::string path = "/accessors/" + std::to_string(source);
    const tinygltf::Accessor& accessor = asset_.model.accessors[source];
    if (!budget_.take(accessor.count) || !budget_.take(sparse_count_of(accessor))) {
      return asset_.invalid(path + "/count", "more elements than the size of the file justifies");
    }
    TRY_LET(reader, AccessorReader::open(asset_, source));
    const std::size_t size = std::size_t{component_size(accessor.componentType)} * component_count_of(accessor);
    bytes.resize((bytes.size() + 3) / 4 * 4);
    const std::size_t offset = bytes.size();
    bytes.resize(offset + size * accessor.count);
    for (std::uint64_t i = 0; i < accessor.count; ++i) {
      if (const std::uint8_t* raw = reader->raw(i)) std::memcpy(bytes.data() + offset + i * size, raw, size);
    }
    Json view = Json::make_object();
    view.set("buffer", Json::make_index(0));
    view.set("byteOffset", Json::make_index(offset));
    view.set("byteLength", Json::make_index(size * accessor.count));
    Json packed = asset_.root.items("accessors")[source];
    packed.erase("byteOffset");
    packed.erase("sparse");
    packed.set("bufferView", Json::make_index(views.size()));
    views.push_back(std::move(view));
    accessors.push_back(std::move(packed));
    index_of_[source] = accessors.size() - 1;
    return accessors.size() - 1;
  }

  std::vector<std::uint8_t> bytes;
  Json::Array views, accessors;

 private:
  const GltfAsset& asset_;
  DecodeBudget& budget_;
  std::map<int, std::uint64_t> index_of_;
};

/// Nodes that still matter when skins are gone: they or one of their descendants draw, light or look.
std::vector<bool> find_visible_nodes(const GltfAsset& asset) {
  const auto& nodes = asset.model.nodes;
  const auto& json = asset.root.items("nodes");
  std::vector<std::size_t> parent(nodes.size(), nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    for (const int child : nodes[n].children) parent[child] = n;
  }
  std::vector<bool> visible(nodes.size(), false);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const bool draws = nodes[n].mesh >= 0 || nodes[n].camera >= 0 || json[n].find("extensions") != nullptr;
    if (!draws) continue;
    for (std::size_t up = n; up != nodes.size() && !visible[up]; up = parent[up]) visible[up] = true;
  }
  return visible;
}

bool is_packable(const tinygltf::Accessor& accessor) {
  return component_count_of(accessor) <= 4 && accessor.count > 0;
}

}  // namespace

Status carry_animations(const GltfAsset& asset, DecodeBudget& budget, Json& document, Scene& scene) {
  const std::vector<bool> visible = find_visible_nodes(asset);
  std::vector<bool> is_joint(asset.model.nodes.size(), false);
  for (const tinygltf::Skin& skin : asset.model.skins) {
    for (const int joint : skin.joints) is_joint[joint] = true;
  }
  const auto& accessors = asset.model.accessors;
  const auto is_rigid = [&](const tinygltf::AnimationChannel& channel, const tinygltf::AnimationSampler& sampler) {
    const int node = channel.target_node;
    const std::string& path = channel.target_path;
    return node >= 0 && (path == "translation" || path == "rotation" || path == "scale") &&
           !(is_joint[node] && !visible[node]) && is_packable(accessors[sampler.input]) &&
           is_packable(accessors[sampler.output]);
  };
  AccessorPacker packer(asset, budget);
  Json::Array animations;
  const auto& sources = asset.root.items("animations");
  for (std::size_t a = 0; a < sources.size(); ++a) {
    const tinygltf::Animation& source = asset.model.animations[a];
    const auto& channel_texts = sources[a].items("channels");
    const auto& sampler_texts = sources[a].items("samplers");
    Json::Array channels;
    Json::Array samplers;
    std::map<int, std::size_t> sampler_of;
    std::size_t skipped = 0;
    for (std::size_t c = 0; c < source.channels.size(); ++c) {
      const int old = source.channels[c].sampler;
      const tinygltf::AnimationSampler& sampler = source.samplers[old];
      if (!is_rigid(source.channels[c], sampler)) {
        ++skipped;
        continue;
      }
      auto known = sampler_of.find(old);
      if (known == sampler_of.end()) {
        TRY_LET(packed_input, packer.add(sampler.input));
        TRY_LET(packed_output, packer.add(sampler.output));
        Json packed = sampler_texts[old];
        packed.set("input", Json::make_index(*packed_input));
        packed.set("output", Json::make_index(*packed_output));
        known = sampler_of.emplace(old, samplers.size()).first;
        samplers.push_back(std::move(packed));
      }
      Json carried = channel_texts[c];
      carried.set("sampler", Json::make_index(known->second));
      channels.push_back(std::move(carried));
    }
    if (skipped != 0) {
      scene.left_out.push_back({"animation " + std::to_string(a) + ": " + std::to_string(skipped) + " channels",
                                "only rigid node animation is kept"});
    }
    if (channels.empty()) continue;
    Json animation = sources[a];
    animation.set("channels", Json{std::move(channels)});
    animation.set("samplers", Json{std::move(samplers)});
    animations.push_back(std::move(animation));
  }
  if (animations.empty()) return Ok{};
  document.set("animations", Json{std::move(animations)});
  document.set("accessors", Json{std::move(packer.accessors)});
  document.set("bufferViews", Json{std::move(packer.views)});
  Json buffer = Json::make_object();
  buffer.set("byteLength", Json::make_index(packer.bytes.size()));
  buffer.set("blob", Json::make_index(scene.blobs.size()));
  Json::Array buffers;
  buffers.push_back(std::move(buffer));
  document.set("buffers", Json{std::move(buffers)});
  SceneBlob blob;
  blob.kind = SceneBlob::Kind::kBuffer;
  blob.name = "animations";
  blob.mime_type = "application/octet-stream";
  blob.bytes = std::move(packer.bytes);
  scene.blobs.push_back(std::move(blob));
  return Ok{};
}

}  // namespace meshlode::scene
