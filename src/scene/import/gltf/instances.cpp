// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes to instances: local transforms composed in doubles from the roots down (glTF 2.0, section 3.5.3). What
// KHR_node_visibility hides is not instanced, with all that is below it.
#include <algorithm>
#include <cmath>

#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/gltf_import.h"

namespace meshlode::scene {

Mat4d local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) {
    Mat4d m;
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r) m[c][r] = node.matrix[4 * c + r];
    }
    return m;
  }
  Mat4d m(1.0);
  if (node.rotation.size() == 4) {
    double x = node.rotation[0];
    double y = node.rotation[1];
    double z = node.rotation[2];
    double w = node.rotation[3];
    const double length = std::sqrt(x * x + y * y + z * z + w * w);
    x /= length;
    y /= length;
    z /= length;
    w /= length;
    m[0] = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w), 0.0};
    m[1] = {2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w), 0.0};
    m[2] = {2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y), 0.0};
  }
  if (node.scale.size() == 3) {
    for (int c = 0; c < 3; ++c) m[c] *= node.scale[c];
  }
  if (node.translation.size() == 3) m[3] = {node.translation[0], node.translation[1], node.translation[2], 1.0};
  return m;
}

bool is_hidden(const Json& node) {
  const Json* extensions = node.find("extensions");
  const Json* visibility = extensions != nullptr ? extensions->find("KHR_node_visibility") : nullptr;
  const Json* visible = visibility != nullptr ? visibility->find("visible") : nullptr;
  return visible != nullptr && !std::get<bool>(visible->value);
}

namespace {

/// The roots of the default scene.
std::vector<int> find_roots(const GltfAsset& asset, std::string_view choice, std::vector<LeftOut>& left_out) {
  const auto& nodes = asset.model.nodes;
  const auto& scenes = asset.model.scenes;
  std::vector<int> roots;
  if (scenes.empty()) {
    std::vector<bool> has_parent(nodes.size(), false);
    for (const tinygltf::Node& node : nodes) {
      for (const int child : node.children) has_parent[child] = true;
    }
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (!has_parent[n]) roots.push_back(static_cast<int>(n));
    }
  } else {
    roots = scenes[std::max(asset.model.defaultScene, 0)].nodes;
    if (scenes.size() > 1 && !asset.has_every_scene) {
      left_out.push_back(
          {"instances of " + std::to_string(scenes.size() - 1) + " other scenes",
           choice.empty() ? "only the default scene is instanced" : "only the scene that was asked for is instanced"});
    }
  }
  return roots;
}

}  // namespace

std::vector<SceneInstance> read_instances(const GltfAsset& asset, std::string_view choice,
                                          std::vector<LeftOut>& left_out) {
  const auto& nodes = asset.model.nodes;
  const auto& json_nodes = asset.root.items("nodes");
  const std::vector<int> roots = find_roots(asset, choice, left_out);
  std::vector<SceneInstance> out;
  std::size_t hidden_count = 0;
  struct Visit {
    int node;
    Mat4d parent;
    bool is_hidden = false;
  };
  std::vector<Visit> stack;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.push_back({*root, Mat4d(1.0), false});
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const tinygltf::Node& node = nodes[visit.node];
    const Mat4d world = visit.parent * local_transform(node);
    const bool is_out = visit.is_hidden || is_hidden(json_nodes[visit.node]);
    if (node.mesh >= 0 && is_out) {
      ++hidden_count;
    } else if (node.mesh >= 0) {
      out.push_back(
          {node.name, static_cast<std::uint32_t>(visit.node), MeshId(static_cast<std::size_t>(node.mesh)), world});
    }
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      stack.push_back({*child, world, is_out});
    }
  }
  if (hidden_count > 0) {
    left_out.push_back({std::to_string(hidden_count) + " instances that KHR_node_visibility hides",
                        "what is invisible is not instanced; its meshes are in the asset"});
  }
  return out;
}

}  // namespace meshlode::scene
