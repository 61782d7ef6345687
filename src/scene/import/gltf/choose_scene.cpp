// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/choose_scene.h"

#include <charconv>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/import/gltf/check_base.h"

namespace meshlode::scene {

namespace {

/// All of the text is a whole number.
std::optional<std::size_t> as_index(std::string_view text) {
  std::size_t index = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc{} || rest != text.data() + text.size()) return std::nullopt;
  return index;
}

/// "0 'day', 1": what could have been asked for; not all of many.
std::string list_scenes(const std::vector<tinygltf::Scene>& scenes) {
  constexpr std::size_t kMost = 8;
  std::string out;
  for (std::size_t i = 0; i < scenes.size() && i < kMost; ++i) {
    out += (i == 0 ? "" : ", ") + std::to_string(i);
    if (!scenes[i].name.empty()) out += " '" + pointer_part(scenes[i].name) + "'";
  }
  return scenes.size() > kMost ? out + " …" : out;
}

/// A scene with the roots of all others, in their order.
void add_every_scene(GltfAsset& asset) {
  std::vector<bool> is_in(asset.model.nodes.size(), false);
  tinygltf::Scene every;
  every.name = "all scenes";
  Json::Array roots;
  for (const tinygltf::Scene& scene : asset.model.scenes) {
    for (const int node : scene.nodes) {
      if (is_in[node]) continue;
      is_in[node] = true;
      every.nodes.push_back(node);
      roots.push_back(Json::make_index(static_cast<std::uint64_t>(node)));
    }
  }
  Json json = Json::make_object();
  json.set("name", Json::make_string(every.name));
  if (!roots.empty()) json.set("nodes", Json{std::move(roots)});
  std::get<Json::Array>(asset.root.find("scenes")->value).push_back(std::move(json));
  asset.model.scenes.push_back(std::move(every));
}

}  // namespace

Status choose_scene(GltfAsset& asset, std::string_view choice) {
  if (choice.empty()) return Ok{};
  auto& scenes = asset.model.scenes;
  std::optional<std::size_t> chosen;
  std::size_t named = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (scenes[i].name != choice) continue;
    chosen = i;
    ++named;
  }
  const auto usage = [&](const std::string& why) {
    return Error{ErrorCode::kUsage, asset.file,
                 "--scene " + pointer_part(choice) + ": " + why +
                     (scenes.empty() ? ", the file has none" : "; its scenes are " + list_scenes(scenes))};
  };
  if (named > 1) return usage("several scenes have this name, give an index");
  if (!chosen && choice == kEveryScene) {
    if (scenes.size() < 2) return Ok{};  // the only one, or every root where there is none
    add_every_scene(asset);
    asset.has_every_scene = true;
    chosen = scenes.size() - 1;
  }
  if (!chosen) chosen = as_index(choice);
  if (!chosen || *chosen >= scenes.size()) return usage("there is no such scene");
  asset.root.set("scene", Json::make_index(*chosen));
  asset.model.defaultScene = static_cast<int>(*chosen);
  return Ok{};
}

}  // namespace meshlode::scene
