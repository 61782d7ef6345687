// SPDX-License-Identifier: GPL-3.0-or-later
// nlohmann-json, seen by this file alone in this room.
#include "app/compare/documents.h"

#include <set>

#include <nlohmann/json.hpp>

#include "base/json_depth.h"

namespace meshlode::app {

namespace {

using Json = nlohmann::json;  // sorted: an ordered one looks for each key among all, and a file chooses how many

/// nlohmann parses without recursion but dumps and compares with it, so that deep nesting must not get in.
constexpr int kMaxDepth = 200;

Json parse_object(std::string_view text) {
  if (!is_nested_within(text, kMaxDepth)) return Json::object();
  Json json = Json::parse(text.begin(), text.end(), nullptr, false);
  return json.is_object() ? json : Json::object();
}

std::string text_of(const Json& object, const std::string& key) {
  const auto found = object.find(key);
  return found == object.end() ? "null" : found->dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// An object, empty where there is none.
const Json& material_at(const Json& document, std::size_t index) {
  static const Json no_material = Json::object();
  const auto materials = document.find("materials");
  if (materials == document.end() || !materials->is_array() || index >= materials->size()) return no_material;
  const Json& material = (*materials)[index];
  return material.is_object() ? material : no_material;
}

}  // namespace

std::vector<SettingChange> compare_settings(std::string_view before, std::string_view after) {
  const Json old_settings = parse_object(before), new_settings = parse_object(after);
  std::vector<SettingChange> changes;
  const auto add = [&](const std::string& key) {
    SettingChange change{key, text_of(old_settings, key), text_of(new_settings, key)};
    if (change.before != change.after) changes.push_back(std::move(change));
  };
  for (const auto& [key, value] : old_settings.items()) add(key);
  for (const auto& [key, value] : new_settings.items()) {
    if (!old_settings.contains(key)) add(key);
  }
  return changes;
}

std::vector<std::vector<std::string>> compare_document_materials(
    std::string_view before, std::string_view after, const std::vector<std::pair<std::size_t, std::size_t>>& pairs) {
  const Json old_document = parse_object(before), new_document = parse_object(after);
  std::vector<std::vector<std::string>> changes;
  std::set<std::size_t> old_seen, new_seen;
  for (const auto& [old_index, new_index] : pairs) {
    std::vector<std::string>& differing = changes.emplace_back();
    const bool is_new_pair = old_seen.insert(old_index).second;
    if (!new_seen.insert(new_index).second || !is_new_pair) continue;
    const Json& old_material = material_at(old_document, old_index);
    const Json& new_material = material_at(new_document, new_index);
    std::set<std::string> keys;
    for (const auto& [key, value] : old_material.items()) keys.insert(key);
    for (const auto& [key, value] : new_material.items()) keys.insert(key);
    for (const std::string& key : keys) {
      if (key != "name" && text_of(old_material, key) != text_of(new_material, key)) differing.push_back(key);
    }
  }
  return changes;
}

}  // namespace meshlode::app
