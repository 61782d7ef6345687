// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes form trees (glTF 2.0, section 3.5.2): no node has two parents, none is its own ancestor. Scenes should list
// roots; a node below others passes where no scene shows those (mend_gltf).
#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/gltf.h"

namespace meshlode::scene {

namespace {

class NodeChecker : public JsonChecker {
 public:
  NodeChecker(const Json& root, const std::string& file) : JsonChecker(file), root_(root) {}

  void run() {
    if (!objects(root_, "", "nodes") || !objects(root_, "", "scenes") || !objects(root_, "", "skins") ||
        !objects(root_, "", "cameras") || !optional_index(root_, "", "scene", root_.items("scenes").size())) {
      return;
    }
    const auto& nodes = root_.items("nodes");
    for (std::size_t i = 0; i < nodes.size() && ok(); ++i) check_node(nodes[i], "/nodes/" + std::to_string(i));
    if (ok()) check_trees();
    if (ok()) check_scenes();
    const auto& skins = root_.items("skins");
    for (std::size_t i = 0; i < skins.size() && ok(); ++i) {
      const std::string path = "/skins/" + std::to_string(i);
      optional_indices(skins[i], path, "joints", nodes.size());
      optional_index(skins[i], path, "inverseBindMatrices", root_.items("accessors").size());
    }
  }

 private:
  bool check_node(const Json& node, const std::string& path) {
    if (!optional_string(node, path, "name") || !optional_index(node, path, "mesh", root_.items("meshes").size()) ||
        !optional_index(node, path, "skin", root_.items("skins").size()) ||
        !optional_index(node, path, "camera", root_.items("cameras").size()) ||
        !optional_indices(node, path, "children", root_.items("nodes").size()) ||
        !optional_numbers(node, path, "matrix", 16) || !optional_numbers(node, path, "translation", 3) ||
        !optional_numbers(node, path, "rotation", 4) || !optional_numbers(node, path, "scale", 3) ||
        !optional_object(node, path, "extensions")) {
      return false;
    }
    if (const Json* rotation = node.find("rotation")) {
      bool is_zero = true;
      for (const Json& c : *rotation->array()) is_zero = is_zero && c.number().value_or(0.0) == 0.0;
      if (is_zero) return fail(path + "/rotation", "a quaternion of length zero");
    }
    const Json* extensions = node.find("extensions");
    return extensions == nullptr || (check_light(*extensions, path) && check_instancing(*extensions, path) &&
                                     check_visibility(*extensions, path));
  }

  bool check_light(const Json& extensions, const std::string& path) {
    const Json* light = extensions.find("KHR_lights_punctual");
    if (light == nullptr) return true;
    const std::string here = path + "/extensions/KHR_lights_punctual";
    if (!light->is_object()) return fail(here, "not an object");
    const Json* root_extensions = root_.find("extensions");
    const Json* lights = root_extensions != nullptr ? root_extensions->find("KHR_lights_punctual") : nullptr;
    return required_index(*light, here, "light", lights != nullptr ? lights->items("lights").size() : 0);
  }

  bool check_instancing(const Json& extensions, const std::string& path) {
    const Json* instancing = extensions.find("EXT_mesh_gpu_instancing");
    if (instancing == nullptr) return true;
    const std::string here = path + "/extensions/EXT_mesh_gpu_instancing";
    if (!instancing->is_object()) return fail(here, "not an object");
    const Json* attributes = instancing->find("attributes");
    if (attributes == nullptr || !attributes->is_object() || attributes->object()->empty()) {
      return fail(here + "/attributes", "missing, or without an attribute");
    }
    return index_map(*attributes, here + "/attributes", root_.items("accessors").size());
  }

  bool check_visibility(const Json& extensions, const std::string& path) {
    const Json* visibility = extensions.find("KHR_node_visibility");
    if (visibility == nullptr) return true;
    const std::string here = path + "/extensions/KHR_node_visibility";
    if (!visibility->is_object()) return fail(here, "not an object");
    return optional_bool(*visibility, here, "visible");
  }

  bool check_trees() {
    const auto& nodes = root_.items("nodes");
    parent_.assign(nodes.size(), kNoId);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto& children = nodes[i].items("children");
      for (std::size_t c = 0; c < children.size(); ++c) {
        const std::uint64_t child = children[c].index().value_or(0);
        if (parent_[child] != kNoId) {
          return fail(
              "/nodes/" + std::to_string(i) + "/children/" + std::to_string(c),
              "node " + std::to_string(child) + " already has a parent, node " + std::to_string(parent_[child]));
        }
        parent_[child] = static_cast<std::uint32_t>(i);
      }
    }
    // Each node has at most one parent: walking upward, each node once in all, finds every cycle.
    std::vector<std::uint32_t> mark(nodes.size(), kNoId);
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      std::uint32_t n = i;
      for (; n != kNoId && mark[n] == kNoId; n = parent_[n]) mark[n] = i;
      if (n != kNoId && mark[n] == i) return fail("/nodes/" + std::to_string(n), "the node is its own ancestor");
    }
    return true;
  }

  bool check_scenes() {
    const auto& scenes = root_.items("scenes");
    std::vector<std::size_t> seen_in(root_.items("nodes").size(), scenes.size());
    std::vector<bool> is_listed(seen_in.size(), false);
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const std::string path = "/scenes/" + std::to_string(s);
      if (!optional_string(scenes[s], path, "name") ||
          !optional_indices(scenes[s], path, "nodes", root_.items("nodes").size())) {
        return false;
      }
      const auto& roots = scenes[s].items("nodes");
      for (std::size_t i = 0; i < roots.size(); ++i) {
        const std::uint64_t node = roots[i].index().value_or(0);
        if (seen_in[node] == s) {
          return fail(path + "/nodes/" + std::to_string(i), "node " + std::to_string(node) + " is named twice");
        }
        seen_in[node] = s;
        is_listed[node] = true;
      }
    }
    return check_ancestors(is_listed);
  }

  /// Of two nodes of which one is below the other scenes list one at most: else it is shown twice, or in two places.
  bool check_ancestors(const std::vector<bool>& is_listed) {
    std::vector<bool> is_free(is_listed.size(), false);  // neither it nor what is above it is listed
    const auto& scenes = root_.items("scenes");
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const auto& listed = scenes[s].items("nodes");
      for (std::size_t i = 0; i < listed.size(); ++i) {
        const std::uint64_t node = listed[i].index().value_or(0);
        for (std::uint32_t up = parent_[node]; up != kNoId && !is_free[up]; up = parent_[up]) {
          if (is_listed[up]) {
            return fail(
                "/scenes/" + std::to_string(s) + "/nodes/" + std::to_string(i),
                "a scene lists node " + std::to_string(up) + " too, which is above node " + std::to_string(node));
          }
          is_free[up] = true;
        }
      }
    }
    return true;
  }

  const Json& root_;
  std::vector<std::uint32_t> parent_;
};

}  // namespace

Status check_gltf_nodes(const Json& root, const std::string& file) {
  NodeChecker checker(root, file);
  checker.run();
  return checker.status();
}

}  // namespace meshlode::scene
