// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of common writers that leave no doubt about what a scene shows. UniGLTF puts its objects below a "tmpParent"
// and lists the objects as the scene; Babylon's exporter for Maya writes 0 for the interpolation LINEAR.
#include "base/ids.h"
#include "scene/import/gltf/gltf.h"

namespace meshlode::scene {

namespace {

/// A scene shows what it lists, without what is above it. That is in no scene: the check has seen to it.
std::size_t cut_parents(Json& root) {
  Json* nodes = root.find("nodes");
  if (nodes == nullptr) return 0;
  auto& list = std::get<Json::Array>(nodes->value);
  std::vector<bool> is_listed(list.size(), false);
  for (const Json& scene : root.items("scenes")) {
    for (const Json& node : scene.items("nodes")) is_listed[node.index().value_or(0)] = true;
  }
  std::size_t cut = 0;
  for (Json& node : list) {
    Json* children = node.find("children");
    if (children == nullptr) continue;
    auto& below = std::get<Json::Array>(children->value);
    const std::size_t before = below.size();
    below.erase_if([&](const Json& child) { return is_listed[child.index().value_or(0)]; });
    cut += before - below.size();
    if (before != 0 && below.empty()) node.erase("children");
  }
  return cut;
}

std::size_t drop_zero_interpolations(Json& root) {
  Json* animations = root.find("animations");
  if (animations == nullptr) return 0;
  std::size_t dropped = 0;
  for (Json& animation : std::get<Json::Array>(animations->value)) {
    Json* samplers = animation.find("samplers");
    if (samplers == nullptr) continue;
    for (Json& sampler : std::get<Json::Array>(samplers->value)) {
      const Json* interpolation = sampler.find("interpolation");
      if (interpolation == nullptr || interpolation->is_string()) continue;
      sampler.erase("interpolation");
      ++dropped;
    }
  }
  return dropped;
}

}  // namespace

void mend_gltf(Json& root, std::vector<LeftOut>& left_out) {
  if (const std::size_t cut = cut_parents(root); cut != 0) {
    left_out.push_back({"parents of nodes that a scene lists (" + std::to_string(cut) + ")",
                        "a scene shows what it lists, without what is above it"});
  }
  if (const std::size_t dropped = drop_zero_interpolations(root); dropped != 0) {
    left_out.push_back({"interpolations of animation samplers (" + std::to_string(dropped) + ")",
                        "0 is not one of glTF, and counts as LINEAR"});
  }
}

}  // namespace meshlode::scene
