// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/settings/effective.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "app/settings/settings_file.h"
#include "base/try.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

using scene::Json;

void write_setting(JsonWriter& json, const SettingInfo& info, const std::string& word) {
  json.key(info.name);
  if (is_flag(info.setting)) return json.value(word == "true");
  if (is_list(info.setting)) {
    json.begin_array();
    for (std::string_view rest = word; !rest.empty();) {
      const std::string_view name = rest.substr(0, rest.find(','));
      rest.remove_prefix(std::min(rest.size(), name.size() + 1));
      json.value(name);
    }
    return json.end_array();
  }
  double number = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool is_number = error == std::errc{} && end == word.data() + word.size() && std::isfinite(number);
  const bool is_name = info.setting == Setting::kAggregate;  // of a mesh
  if (is_number && !is_name && takes_number(info.setting)) return json.value(number);
  json.value(word);
}

Error broken(std::string place, const char* what) {
  return {ErrorCode::kInvalid, std::move(place), what};
}

/// The words of an object of settings. `place`: where it is.
Result<SettingWords> read_words(const Json* object, const std::string& place) {
  if (object == nullptr || !object->is_object()) return broken(place, "no object");
  SettingWords words;
  for (const scene::JsonMember& member : *object->object()) {
    const auto setting = setting_of(member.key);
    if (!setting) return broken(place, "holds what is no setting");
    auto word = word_of_value(*setting, member.value);
    if (!word) return broken(place + "/" + member.key, "a value of another type");
    words[static_cast<std::size_t>(*setting)] = std::move(*word);
  }
  return words;
}

}  // namespace

EffectiveSettings effective_settings(const Settled& settled, std::span<const SettingLayer> layers) {
  EffectiveSettings effective{settled.words, {}};
  SettledWord& tier = effective.words[static_cast<std::size_t>(Setting::kErrorTier)];
  if (tier.word == "auto") tier = {format::name_of(settled.options.error_tier), settled[Setting::kPreset].from};
  for (const SettingLayer& layer : layers) {
    for (const SettingLayer::MeshRule& rule : layer.mesh_rules) {
      effective.mesh_rules.push_back({layer.from, rule.glob, rule.words});
    }
  }
  return effective;
}

void write_effective(JsonWriter& json, const EffectiveSettings& settings) {
  json.begin_object();
  json.key("values");
  json.begin_object();
  for (const SettingInfo& info : all_settings()) {
    write_setting(json, info, settings.words[static_cast<std::size_t>(info.setting)].word);
  }
  json.end_object();
  json.key("from");
  json.begin_object();
  for (const SettingInfo& info : all_settings()) {
    const std::string& from = settings.words[static_cast<std::size_t>(info.setting)].from;
    if (from != kDefaultPlace) json.field(info.name, from);
  }
  json.end_object();
  json.key("mesh_rules");
  json.begin_array();
  for (const EffectiveSettings::MeshRule& rule : settings.mesh_rules) {
    json.begin_object();
    json.field("from", rule.from);
    json.field("meshes", rule.glob);
    json.key("values");
    json.begin_object();
    for (const SettingInfo& info : all_settings()) {
      const auto& word = rule.words[static_cast<std::size_t>(info.setting)];
      if (word) write_setting(json, info, *word);
    }
    json.end_object();
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

Result<EffectiveSettings> read_effective(const Json& json) {
  EffectiveSettings settings;
  TRY_LET(values, read_words(json.find("values"), "/values"));
  for (std::size_t i = 0; i < kSettingCount; ++i) {
    if (!(*values)[i]) return broken("/values", "lacks a setting");
    settings.words[i] = {*(*values)[i], kDefaultPlace};
  }
  const Json* from = json.find("from");
  if (from == nullptr || !from->is_object()) return broken("/from", "no object");
  for (const scene::JsonMember& member : *from->object()) {
    const auto setting = setting_of(member.key);
    if (!setting || !member.value.is_string()) return broken("/from", "holds what is no place of a setting");
    settings.words[static_cast<std::size_t>(*setting)].from = *member.value.string();
  }
  const Json* rules = json.find("mesh_rules");
  if (rules == nullptr || !rules->is_array()) return broken("/mesh_rules", "no array");
  for (const Json& rule : *rules->array()) {
    const Json *place = rule.find("from"), *meshes = rule.find("meshes");
    if (place == nullptr || !place->is_string() || meshes == nullptr || !meshes->is_string()) {
      return broken("/mesh_rules", "no rule");
    }
    TRY_LET(words, read_words(rule.find("values"), "/mesh_rules/values"));
    settings.mesh_rules.push_back({std::string(*place->string()), std::string(*meshes->string()), std::move(*words)});
  }
  return settings;
}

}  // namespace meshlode::app
