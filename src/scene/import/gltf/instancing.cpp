// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/instancing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "base/try.h"
#include "scene/import/gltf/accessor.h"
#include "scene/import/gltf/check_base.h"

namespace meshlode::scene {

namespace {

constexpr std::string_view kExtension = "EXT_mesh_gpu_instancing";
/// What an instance takes of the budget beside its name, and what it takes of memory in the course of a build: as a
/// tree, as a node of the model, as text, as an instance (measured: 3.9 KB).
constexpr std::uint64_t kInstanceElements = 16, kInstanceBytes = 4096;
/// 32 bytes of attributes are what an instance usually has.
constexpr std::uint64_t kMemoryOfAByte = kInstanceBytes / 32;

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
  InstanceExpander(GltfAsset& asset, DecodeBudget& budget, std::uint64_t max_bytes)
      : asset_(asset), budget_(budget), left_bytes_(max_bytes) {}

  Status run(std::vector<LeftOut>& left_out) {
    const std::size_t node_count = asset_.model.nodes.size();
    std::uint64_t instance_count = 0;
    for (std::size_t n = 0; n < node_count; ++n) {
      const Json* attributes = attributes_of(n);
      if (attributes == nullptr || asset_.model.nodes[n].mesh < 0) continue;
      const std::uint64_t count = count_of(*attributes);
      if (!take(count, stem_of(n).size())) return no_budget(path_of(n));
      instance_count += count;
    }
    if (node_count == 0) return Ok{};
    nodes().reserve(node_count + instance_count);  // nothing moves from here on
    asset_.model.nodes.reserve(node_count + instance_count);
    for (std::size_t n = 0; n < node_count; ++n) {
      const Json* attributes = attributes_of(n);
      if (attributes == nullptr) continue;
      if (Status status = expand(n, *attributes); !status) return status;
    }
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

  const Json* attributes_of(std::size_t n) {
    const Json* extensions = asset_.root.items("nodes")[n].find("extensions");
    const Json* instancing = extensions != nullptr ? extensions->find(kExtension) : nullptr;
    return instancing != nullptr ? instancing->find("attributes") : nullptr;
  }

  /// All attributes have as many elements, or are refused later.
  [[nodiscard]] std::uint64_t count_of(const Json& attributes) const {
    return asset_.model.accessors[(*attributes.object())[0].value.index().value_or(0)].count;
  }

  [[nodiscard]] std::string stem_of(std::size_t n) const {
    const std::string& name = asset_.model.nodes[n].name;
    return name.empty() ? "node " + std::to_string(n) : name;
  }

  static std::string path_of(std::size_t n) {
    return "/nodes/" + std::to_string(n) + "/extensions/" + std::string(kExtension) + "/attributes";
  }

  /// The budget and the memory of so many instances. \pre count < 2^31 and name_bytes too
  bool take(std::uint64_t count, std::uint64_t name_bytes) {
    const std::uint64_t bytes_each = kInstanceBytes + 8 * name_bytes;
    if (count > left_bytes_ / bytes_each) return false;
    left_bytes_ -= count * bytes_each;
    return budget_.take(count * (kInstanceElements + name_bytes / 8));
  }

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
      TRY_LET(reader, AccessorReader::open(asset_, index));
      if (!has_type(member.key, *reader))
        return asset_.invalid(here, "an accessor type that this attribute cannot have");
      *slot = *reader;
    }
    return out;
  }

  Error no_budget(const std::string& path) const {
    return asset_.invalid(path, "more instances than the size of the file, and --max-decoded, justify");
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
    numbers.reserve(count);
    model.reserve(count);
    for (std::size_t c = 0; c < count; ++c) {
      const double value = element[c] / length;
      if (!std::isfinite(value)) return false;
      model.push_back(value);
      numbers.push_back(Json::make_number(value));
    }
    json.set(key, Json{std::move(numbers)});
    return true;
  }

  Status expand(std::size_t n, const Json& attribute_list) {
    const std::string path = path_of(n);
    const int mesh = asset_.model.nodes[n].mesh;
    if (mesh < 0) {
      ++nodes_without_mesh_;
      forget_extension(n);
      return Ok{};
    }
    TRY_LET(attributes, open(attribute_list, path));
    const std::string stem = stem_of(n);
    std::vector<int> children;
    for (std::uint64_t i = 0; i < attributes->count; ++i) {
      Json json = Json::make_object();
      std::get<Json::Object>(json.value).reserve(5);
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
      children.push_back(static_cast<int>(asset_.model.nodes.size()));
      nodes().push_back(std::move(json));
      asset_.model.nodes.push_back(std::move(node));
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
  std::uint64_t left_bytes_;
  std::set<std::string> ignored_;
  std::size_t nodes_without_mesh_ = 0;
};

}  // namespace

Status expand_instancing(GltfAsset& asset, DecodeBudget& budget, std::uint64_t file_bytes, std::uint64_t max_decoded,
                         std::vector<LeftOut>& left_out) {
  const std::uint64_t max_bytes = std::max(max_decoded, kMemoryOfAByte * file_bytes);
  return InstanceExpander(asset, budget, max_bytes).run(left_out);
}

}  // namespace meshlode::scene
