// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/write_meta.h"
#include "builder/aggregate/aggregate_choice.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/json_depth.h"
#include "base/version.h"
#include "builder/hooks.h"
#include "builder/measure/measure.h"
#include "builder/plan/attributes.h"
#include "builder/preset.h"
#include "format/names.h"

namespace meshlode::builder {

namespace {

using Json = nlohmann::ordered_json;

double margin_of(format::ErrorTier tier) {
  return tier == format::ErrorTier::kMeasured ? kMeasuredMargin : 1.0;
}

/// What a group's deviation is multiplied by on the way to its error: the least over the meshes, which holds for all.
/// The tier qem has no deviations.
double error_margin_of(const PipelineOptions& options, std::size_t mesh_count) {
  const auto has_tier = [&](format::ErrorTier tier) {
    bool has = mesh_count == 0 && options.error_tier == tier;
    for (std::size_t i = 0; i < mesh_count; ++i) has = has || options.of_mesh(i).error_tier == tier;
    return has;
  };
  const bool is_measured = has_tier(format::ErrorTier::kMeasured) && !has_tier(format::ErrorTier::kCertified);
  return margin_of(is_measured ? format::ErrorTier::kMeasured : format::ErrorTier::kCertified);
}

/// Names that made a difference; one that made none changes no byte.
struct Forced {
  std::uint32_t keep = 0, drop = 0;
  bool operator==(const Forced&) const = default;
};

void put_names(Json& settings, const Forced& forced) {
  if (forced.keep != 0) settings["keep"] = names_of_attributes(forced.keep);
  if (forced.drop != 0) settings["drop"] = names_of_attributes(forced.drop);
}

/// What each mesh may have for itself, in the words of the whole's.
void put_budgets(Json& settings, const MeshOptions& options) {
  settings["position_error"] = options.position_error > 0.0 ? Json(options.position_error) : Json("auto");
  settings["normal_error"] = options.normal_error;
  settings["uv_error"] = options.uv_error;
  settings["uv_error_unit"] = options.uv_error_is_texels ? "texels" : "uv";
}

Json grid_of(const MeshOptions& options) {
  return options.grid_step > 0.0 ? Json(options.grid_step) : Json("auto");
}

/// Settings of one mesh that change its bytes: names only where they do.
struct OwnSettings {
  MeshOptions options;
  Forced forced;
  bool operator==(const OwnSettings&) const = default;
};

std::vector<OwnSettings> own_settings(const PipelineOptions& options, std::span<const PlanDecision> decisions,
                                      std::size_t mesh_count) {
  std::vector<OwnSettings> out(mesh_count);
  for (std::size_t i = 0; i < mesh_count; ++i) {
    out[i].options = options.of_mesh(i);
    out[i].options.keep = out[i].options.drop = 0;
  }
  for (const PlanDecision& decision : decisions) {
    if (decision.mesh >= mesh_count) continue;
    Forced& forced = out[decision.mesh].forced;
    forced.keep |= forced_attributes({&decision, 1}, true);
    forced.drop |= forced_attributes({&decision, 1}, false);
  }
  return out;
}

/// Meshes whose settings are not the whole's, those of equal ones together, in the order of their first.
void put_mesh_settings(Json& settings, const PipelineOptions& options, const std::vector<OwnSettings>& own) {
  MeshOptions whole = options;
  whole.keep = whole.drop = 0;
  std::vector<std::pair<OwnSettings, Json>> groups;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const bool has_names = options.of_mesh(i).keep != options.keep || options.of_mesh(i).drop != options.drop;
    if (own[i].options == whole && !has_names) continue;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == own[i]; });
    if (group == groups.end()) group = groups.insert(groups.end(), {own[i], Json::array()});
    group->second.push_back(i);
  }
  for (const auto& [of_group, meshes] : groups) {
    Json entry;
    entry["meshes"] = meshes;
    entry["error_tier"] = format::name_of(of_group.options.error_tier);
    entry["attributes"] = name_of(of_group.options.attributes);
    put_names(entry, of_group.forced);
    if (aggregate_word(of_group.options) != aggregate_word(options)) {
      entry["aggregate"] = aggregate_word(of_group.options);
    }
    if (of_group.options.lock_borders != options.lock_borders) entry["lock_borders"] = of_group.options.lock_borders;
    entry["grid"] = grid_of(of_group.options);
    put_budgets(entry, of_group.options);
    settings["mesh_settings"].push_back(std::move(entry));
  }
}

/// Of a scene without masked materials nothing is said where masked ones are asked for: the choice is none.
bool may_aggregate(const scene::Scene& scene, const PipelineOptions& options) {
  const auto is_masked = [](const scene::SceneMaterial& material) {
    return material.alpha_mode == scene::AlphaMode::kMask;
  };
  return options.aggregate != AggregateChoice::kNever &&
         (options.aggregate != AggregateChoice::kMasked || std::ranges::any_of(scene.materials, is_masked));
}

Json settings_json(const scene::Scene& scene, const PipelineOptions& options,
                   const std::vector<PlanDecision>& decisions) {
  const std::vector<OwnSettings> own = own_settings(options, decisions, scene.meshes.size());
  Forced forced;
  for (const OwnSettings& mesh : own) {
    forced.keep |= mesh.forced.keep & options.keep;
    forced.drop |= mesh.forced.drop & options.drop;
  }
  Json settings;
  settings["preset"] = name_of(options.preset);
  settings["error_tier"] = format::name_of(options.error_tier);
  settings["error_margin"] = error_margin_of(options, scene.meshes.size());
  settings["attributes"] = name_of(options.attributes);
  put_names(settings, forced);
  settings["grid"] = grid_of(options);
  settings["codec"] = format::name_of(options.codec);
  if (options.strip_effort != StripEffort::kOfPreset) settings["strip_effort"] = name_of(options.strip_effort);
  settings["repair"] = options.repair;
  if (options.linear_colors) settings["linear_colors"] = true;
  if (options.promise != format::Promise::kPosition) settings["promise"] = format::name_of(options.promise);
  if (options.keep_topology) settings["keep_topology"] = true;
  if (options.lock_borders) settings["lock_borders"] = true;
  if (!options.keep_layers) settings["keep_layers"] = false;
  if (may_aggregate(scene, options)) settings["aggregate"] = aggregate_word(options);
  if (!scene.choice.empty()) settings["scene"] = scene.choice;
  settings["cluster_triangles"] = options.max_cluster_triangles;
  settings["cluster_vertices"] = options.max_cluster_vertices;
  if (options.group_clusters != kUsualGroupClusters) settings["group_clusters"] = options.group_clusters;
  if (options.page_kib != kUsualPageKib) settings["page_size"] = options.page_kib;
  if (options.page_order != PageOrder::kLevel) settings["page_order"] = name_of(options.page_order);
  if (options.root_bytes != 0) settings["root_bytes"] = options.root_bytes;
  if (options.page_hints) settings["page_hints"] = true;
  if (!options.textures.is_keep()) settings["textures"] = texture_word(options.textures);
  if (options.hooks != nullptr) settings["experimental"] = Json::parse(options.hooks->record, nullptr, false);
  put_budgets(settings, options);
  put_mesh_settings(settings, options, own);
  return settings;
}

/// Which meshes are parts of others: by material how many triangles a piece has at most that is one of theirs.
Json parts_json(std::span<const scene::MeshPart> parts, std::size_t mesh_count) {
  Json list = Json::array();
  std::size_t mesh = mesh_count - parts.size();
  for (const scene::MeshPart& part : parts) {
    Json pieces = Json::array();
    for (std::size_t m = 0; m < part.most_triangles.size(); ++m) {
      if (part.most_triangles[m] > 0) pieces.push_back({{"material", m}, {"triangles", part.most_triangles[m]}});
    }
    list.push_back({{"mesh", mesh++}, {"of", part.of}, {"pieces", std::move(pieces)}});
  }
  return list;
}

/// Entries of meshes that differ from the whole, and from each other, by more than their tier: those of equal ones
/// together.
Json with_tier(const Json& whole, const Json& entries, format::ErrorTier tier) {
  Json kept = Json::array();
  for (Json entry : entries) {
    if (!entry.is_object() || !entry.contains("meshes") || !entry["meshes"].is_array()) return entries;
    entry["error_tier"] = format::name_of(tier);
    const auto is_same_but_meshes = [&](const Json& other) {
      Json as_this = other;
      as_this["meshes"] = entry["meshes"];
      return as_this == entry;
    };
    const auto is_of_whole = [&](const auto& item) {
      return item.key() == "meshes" || (whole.contains(item.key()) && whole[item.key()] == item.value());
    };
    const auto items = entry.items();
    const bool is_whole = std::all_of(items.begin(), items.end(), is_of_whole);
    if (is_whole) continue;
    const auto same = std::find_if(kept.begin(), kept.end(), is_same_but_meshes);
    if (same == kept.end()) {
      kept.push_back(std::move(entry));
      continue;
    }
    Json& meshes = (*same)["meshes"];
    meshes.insert(meshes.end(), entry["meshes"].begin(), entry["meshes"].end());
    std::sort(meshes.begin(), meshes.end());
  }
  return kept;
}

/// One past the string that begins at `at`. Stays inside any text: the parser that accepted it stops at a zero byte.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  for (++at; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
  }
  return std::min(at + 1, text.size());
}

/// Where the string lies that is the codec of the settings, quotes and all; empty where there is none.
std::pair<std::size_t, std::size_t> find_codec(std::string_view text) {
  int depth = 0;
  bool is_settings = false, is_codec = false;  // the last key at depth 1, at depth 2 below it
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '{' || c == '[') {
      ++depth;
    } else if (c == '}' || c == ']') {
      --depth;
    }
    if (c != '"') {
      ++at;
      continue;
    }
    const std::size_t end = end_of_string(text, at);
    const std::string_view word = text.substr(at, end - at);
    const std::size_t next = text.find_first_not_of(" \t\r\n", end);
    if (next != std::string_view::npos && text[next] == ':') {
      if (depth == 1) is_settings = word == R"("settings")";
      if (depth <= 2) is_codec = depth == 2 && is_settings && word == R"("codec")";
    } else if (depth == 2 && is_codec) {
      return {at, end};
    }
    at = end;
  }
  return {0, 0};
}

}  // namespace

std::string meta_with_codec(std::string_view meta, format::Codec codec) {
  std::string text(meta);
  if (!Json::accept(text)) return text;
  const auto [begin, end] = find_codec(text);
  if (end > begin) text.replace(begin, end - begin, '"' + std::string(format::name_of(codec)) + '"');
  return text;
}

std::string meta_with_tier(std::string_view meta, format::ErrorTier tier) {
  constexpr int kDeepest = 100;  // dump() goes down by recursion
  const std::string text(meta);
  Json json = is_nested_within(meta, kDeepest) ? Json::parse(text, nullptr, false) : Json();
  if (!json.is_object() || !json.contains("settings") || !json["settings"].is_object()) return text;
  Json& settings = json["settings"];
  settings["error_tier"] = format::name_of(tier);
  settings["error_margin"] = margin_of(tier);
  if (settings.contains("mesh_settings") && settings["mesh_settings"].is_array()) {
    settings["mesh_settings"] = with_tier(settings, settings["mesh_settings"], tier);
    if (settings["mesh_settings"].empty()) settings.erase("mesh_settings");
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string meta_json(const scene::Scene& scene, const PipelineOptions& options,
                      const std::vector<PlanDecision>& decisions, std::span<const scene::MeshPart> parts,
                      std::span<const SourceImage> replaced) {
  Json meta;
  meta["generator"] = program_version();
  meta["source"] = {{"file", scene.source_name}, {"hash", scene.source_hash}};
  meta["settings"] = settings_json(scene, options, decisions);
  if (!parts.empty()) meta["parts"] = parts_json(parts, scene.meshes.size());
  for (const SourceImage& image : replaced) {
    meta["source_images"].push_back({{"blob", image.blob},
                                     {"mime_type", image.mime_type},
                                     {"bytes", image.bytes},
                                     {"width", image.width},
                                     {"height", image.height}});
  }
  meta["plan"] = Json::array();
  for (const PlanDecision& decision : decisions) {
    meta["plan"].push_back({{"what", decision.what}, {"kept", decision.kept}, {"reason", decision.reason}});
  }
  meta["left_out"] = Json::array();
  for (const scene::LeftOut& item : scene.left_out)
    meta["left_out"].push_back({{"what", item.what}, {"why", item.why}});
  for (const PlanDecision& decision : decisions) {
    if (!decision.kept) meta["left_out"].push_back({{"what", decision.what}, {"why", decision.reason}});
  }
  // Names come from files: bytes that are not UTF-8 are replaced, never thrown on.
  return meta.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace meshlode::builder
