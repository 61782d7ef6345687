// SPDX-License-Identifier: GPL-3.0-or-later
// nlohmann-json, seen by this file alone in this room.
#include "app/report/read_meta.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include <nlohmann/json.hpp>

#include "base/gltf_textures.h"
#include "base/json_depth.h"
#include "base/json_handle.h"

namespace meshlode::app {

namespace {

using Json = nlohmann::ordered_json;

/// nlohmann parses without recursion but dumps with it, so that deep nesting must not get in.
constexpr int kMaxDepth = 200;

Json parse_object(std::string_view text) {
  if (!is_nested_within(text, kMaxDepth)) return {};
  Json json = Json::parse(text.begin(), text.end(), nullptr, false);
  return json.is_object() ? json : Json{};
}

std::string string_at(const Json& object, const char* key) {
  if (!object.is_object()) return {};
  const auto it = object.find(key);
  if (it == object.end()) return {};
  return it->is_string() ? it->get<std::string>() : it->dump(-1, ' ', false, Json::error_handler_t::replace);
}

const Json* child(const Json& object, const char* key, Json::value_t type) {
  if (!object.is_object()) return nullptr;
  const auto it = object.find(key);
  return it != object.end() && it->type() == type ? &*it : nullptr;
}

std::int64_t signed_or_none(std::optional<std::uint64_t> index) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max();
  return index && *index <= kLargest ? static_cast<std::int64_t>(*index) : -1;
}

/// "preset default, error_tier measured, …"
std::string line_of(const Json& settings) {
  std::string line;
  for (const auto& [key, value] : settings.items()) {
    if (key == "mesh_settings") continue;
    line += (line.empty() ? "" : ", ") + key + " " + string_at(settings, key.c_str());
  }
  return line;
}

std::vector<std::string> lines_of(const Json& settings) {
  std::vector<std::string> lines{line_of(settings)};
  if (const Json* apart = child(settings, "mesh_settings", Json::value_t::array)) {
    for (const Json& entry : *apart) {
      if (entry.is_object()) lines.push_back(line_of(entry));
    }
  }
  return lines;
}

}  // namespace

MetaInfo read_meta(std::string_view meta_json) {
  MetaInfo meta;
  const Json json = parse_object(meta_json);
  if (json.is_null()) return meta;
  meta.is_valid = true;
  meta.generator = string_at(json, "generator");
  if (const Json* source = child(json, "source", Json::value_t::object)) {
    meta.source_file = string_at(*source, "file");
    meta.source_hash = string_at(*source, "hash");
  }
  const auto dump = [](const Json& j) { return j.dump(-1, ' ', false, Json::error_handler_t::replace); };
  if (const Json* settings = child(json, "settings", Json::value_t::object)) {
    meta.settings = dump(*settings);
    meta.setting_lines = lines_of(*settings);
    meta.preset = string_at(*settings, "preset");
    meta.codec = string_at(*settings, "codec");
    meta.scene = string_at(*settings, "scene");
    meta.repair = settings->contains("repair") && (*settings)["repair"] == true;
    meta.linear_colors = settings->contains("linear_colors") && (*settings)["linear_colors"] == true;
    for (const char* key : {"cluster_triangles", "max_cluster_triangles", "triangles_per_cluster"}) {
      const auto cap = TreeHandle(*settings).find(key).index().value_or(0);
      if (cap >= 1 && cap <= 256) meta.cluster_triangles = static_cast<std::uint32_t>(cap);
    }
  }
  if (const Json* parts = child(json, "parts", Json::value_t::array)) {
    for (const Json& entry : *parts) {
      const auto mesh = TreeHandle(entry).find("mesh").index(), of = TreeHandle(entry).find("of").index();
      if (mesh && of) meta.parts.push_back({*mesh, *of});
    }
  }
  if (const Json* images = child(json, "source_images", Json::value_t::array)) {
    for (const Json& entry : *images) {
      const auto number = [&](const char* key) { return TreeHandle(entry).find(key).index(); };
      const auto side = [&](const char* key) {
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(number(key).value_or(0), 0xFFFFFFFFU));
      };
      const auto blob = number("blob"), bytes = number("bytes");
      if (!blob || !bytes) continue;
      meta.source_images.push_back({*blob, *bytes, side("width"), side("height"), string_at(entry, "mime_type")});
    }
  }
  if (const Json* plan = child(json, "plan", Json::value_t::array)) {
    meta.plan = dump(*plan);
    for (const Json& entry : *plan) {
      const bool is_left_out = entry.is_object() && entry.contains("kept") && entry["kept"] == false;
      meta.decisions.push_back({string_at(entry, "what"), string_at(entry, "reason"), !is_left_out});
    }
  }
  if (const Json* left_out = child(json, "left_out", Json::value_t::array)) {
    meta.left_out = dump(*left_out);
    for (const Json& entry : *left_out) meta.left_outs.push_back({string_at(entry, "what"), string_at(entry, "why")});
  }
  return meta;
}

std::vector<std::size_t> origins_of_meshes(const MetaInfo& meta, std::size_t mesh_count) {
  std::vector<std::size_t> origins(mesh_count);
  std::iota(origins.begin(), origins.end(), std::size_t{0});
  for (const auto& [mesh, of] : meta.parts) {
    if (mesh < mesh_count && of < mesh && origins[of] == of) origins[mesh] = of;
  }
  return origins;
}

std::vector<TextureInfo> read_textures(std::string_view scene_json) {
  std::vector<TextureInfo> textures;
  const Json json = parse_object(scene_json);
  if (const Json* array = child(json, "textures", Json::value_t::array)) {
    for (const Json& texture : *array) {
      const TreeHandle handle(texture);
      textures.push_back({string_at(texture, "name"), signed_or_none(image_of_texture(handle)),
                          signed_or_none(handle.find("sampler").index())});
    }
  }
  return textures;
}

}  // namespace meshlode::app
