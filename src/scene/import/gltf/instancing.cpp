// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/instancing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "scene/import/gltf/accessor.h"
#include "scene/import/gltf/check_base.h"

namespace meshlode::scene {

namespace {

constexpr std::string_view kExtension = "EXT_mesh_gpu_instancing";
/// What a node costs as text, as a tree and as an instance, in elements of the budget (24 bytes each), beside its name.
constexpr std::uint64_t kInstanceElements = 16;

/// The attributes of one node's instances. Missing ones are the identity's.
struct InstanceAttributes {
  std::optional<AccessorReader> translation, rotation, scale;
  std::uint64_t count = 0;
};

bool has_type(std::string_view name, const AccessorReader& reader) {
  const bool is_float = reader.component_type() == kGltfFloat;
  if (name != "ROTATION") return is_float && reader.component_count() == 3;
  const bool is_signed = reader.component_type() == kGltfByte || reader.component_type() == kGltfShort;
  return reader.component_count() == 4 && (is_float || (is_signed && reader.is_normalized()));
}

class InstanceExpander {
 public:
  InstanceExpander(GltfAsset& asset, DecodeBudget& budget) : asset_(asset), budget_(budget) {}

  Status run(std::vector<LeftOut>& left_out) {
    const std::size_t node_count = asset_.model.nodes.size();
    for (std::size_t n = 0; n < node_count; ++n) {
      const Json* extensions = nodes()[n].find("extensions");
      const Json* instancing = extensions != nullptr ? extensions->find(kExtension) : nullptr;
      if (instancing == nullptr) continue;
      if (Status status = expand(n, *instancing); !status) return status;
    }
    for (Json& node : new_nodes_) nodes().push_back(std::move(node));
    for (auto& node : new_model_nodes_) asset_.model.nodes.push_back(std::move(node));
    for (const std::string& name : ignored_) {
      left_out.push_back({"instance attribute " + pointer_part(name), "only where an instance stands is kept"});
    }
    if (nodes_without_mesh_ > 0) {
      left_out.push_back({std::string(kExtension) + " of " + std::to_string(nodes_without_mesh_) + " nodes",
                          "they have no mesh that it could copy"});
    }
    return Ok{};
  }

 private:
  Json::Array& nodes() { return std::get<Json::Array>(asset_.root.find("nodes")->value); }

  Result<InstanceAttributes> open(const Json& attributes, const std::string& path) {
    InstanceAttributes out;
    bool is_first = true;
    for (const JsonMember& member : *attributes.object()) {
      const std::string here = path + "/" + pointer_part(member.key);
      const std::uint64_t index = member.value.index().value_or(0);
      const tinygltf::Accessor& accessor = asset_.model.accessors[index];
      if (!is_first && accessor.count != out.count) {
        return asset_.invalid(
            here, std::to_string(accessor.count) + " elements where others have " + std::to_string(out.count));
      }
      out.count = accessor.count;
      is_first = false;
      auto* slot = member.key == "TRANSLATION" ? &out.translation
                   : member.key == "ROTATION"  ? &out.rotation
                   : member.key == "SCALE"     ? &out.scale
                                               : nullptr;
      if (slot == nullptr) {
        ignored_.insert(member.key);
        continue;
      }
      if (!budget_.take(sparse_count_of(accessor))) return no_budget(here);
      auto reader = AccessorReader::open(asset_, index);
      if (!reader) return reader.error();
      if (!has_type(member.key, *reader))
        return asset_.invalid(here, "an accessor type that this attribute cannot have");
      *slot = *reader;
    }
    return out;
  }

  Error no_budget(const std::string& path) const {
    return asset_.invalid(path, "more instances than the size of the file justifies");
  }

  /// The numbers of an attribute of an instance, into both forms of its node. False where they are not finite or no
  /// quaternion.
  static bool set(const std::optional<AccessorReader>& reader, std::uint64_t i, std::string_view key, Json& json,
                  std::vector<double>& model) {
    if (!reader) return true;
    const auto element = reader->element(i);
    const std::size_t count = reader->component_count();
    double length = 1.0;
    if (count == 4) {
      length = 0.0;
      for (const double c : element) length += c * c;
      length = std::sqrt(length);
      if (!(length > 0.0)) return false;
    }
    Json::Array numbers;
    for (std::size_t c = 0; c < count; ++c) {
      const double value = element[c] / length;
      if (!std::isfinite(value)) return false;
      model.push_back(value);
      numbers.push_back(Json::make_number(value));
    }
    json.set(key, Json{std::move(numbers)});
    return true;
  }

  Status expand(std::size_t n, const Json& instancing) {
    const std::string path = "/nodes/" + std::to_string(n) + "/extensions/" + std::string(kExtension) + "/attributes";
    const int mesh = asset_.model.nodes[n].mesh;
    if (mesh < 0) {
      ++nodes_without_mesh_;
      forget_extension(n);
      return Ok{};
    }
    const auto attributes = open(*instancing.find("attributes"), path);
    if (!attributes) return attributes.error();
    const std::string& name = asset_.model.nodes[n].name;
    const std::string stem = name.empty() ? "node " + std::to_string(n) : name;
    const std::uint64_t each = kInstanceElements + stem.size() / 8;
    if (attributes->count > budget_.left_bytes() / DecodeBudget::kElementBytes / each) return no_budget(path);
    if (!budget_.take(attributes->count * each)) return no_budget(path);
    std::vector<int> children;
    for (std::uint64_t i = 0; i < attributes->count; ++i) {
      Json json = Json::make_object();
      tinygltf::Node node;
      node.name = stem + "[" + std::to_string(i) + "]";
      node.mesh = mesh;
      json.set("name", Json::make_string(node.name));
      json.set("mesh", Json::make_index(static_cast<std::uint64_t>(mesh)));
      if (!set(attributes->translation, i, "translation", json, node.translation) ||
          !set(attributes->rotation, i, "rotation", json, node.rotation) ||
          !set(attributes->scale, i, "scale", json, node.scale)) {
        return asset_.invalid(path, "instance " + std::to_string(i) + " is not finite or turned by no quaternion");
      }
      children.push_back(static_cast<int>(asset_.model.nodes.size() + new_nodes_.size()));
      new_nodes_.push_back(std::move(json));
      new_model_nodes_.push_back(std::move(node));
    }
    adopt(n, children);
    forget_extension(n);
    return Ok{};
  }

  /// The node no longer draws the mesh; its new children do, and come first.
  void adopt(std::size_t n, const std::vector<int>& children) {
    tinygltf::Node& model = asset_.model.nodes[n];
    model.mesh = -1;
    model.children.insert(model.children.begin(), children.begin(), children.end());
    Json& json = nodes()[n];
    json.erase("mesh");
    Json::Array list;
    for (const int child : model.children) list.push_back(Json::make_index(static_cast<std::uint64_t>(child)));
    if (list.empty()) {
      json.erase("children");
    } else {
      json.set("children", Json{std::move(list)});
    }
  }

  void forget_extension(std::size_t n) {
    Json& extensions = *nodes()[n].find("extensions");
    extensions.erase(kExtension);
    if (extensions.object()->empty()) nodes()[n].erase("extensions");
  }

  GltfAsset& asset_;
  DecodeBudget& budget_;
  Json::Array new_nodes_;
  std::vector<tinygltf::Node> new_model_nodes_;
  std::set<std::string> ignored_;
  std::size_t nodes_without_mesh_ = 0;
};

}  // namespace

Status expand_instancing(GltfAsset& asset, DecodeBudget& budget, std::vector<LeftOut>& left_out) {
  return InstanceExpander(asset, budget).run(left_out);
}

}  // namespace meshlode::scene
