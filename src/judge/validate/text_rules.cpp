// SPDX-License-Identifier: GPL-3.0-or-later
// The asset's JSON texts; the one file of this room that sees nlohmann-json.
#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "base/json_depth.h"
#include "judge/validate/file_tables.h"

namespace meshlode::judge {

bool is_utf8(std::string_view text) {
  std::size_t i = 0;
  const auto byte = [&](std::size_t k) { return static_cast<unsigned>(static_cast<unsigned char>(text[k])); };
  while (i < text.size()) {
    const unsigned lead = byte(i);
    if (lead < 0x80U) {
      ++i;
      continue;
    }
    const std::size_t count = lead >> 5 == 6U ? 1 : lead >> 4 == 14U ? 2 : lead >> 3 == 30U ? 3 : 0;
    if (count == 0 || count >= text.size() - i) return false;
    unsigned code = lead & (0x3FU >> count);
    for (std::size_t k = 1; k <= count; ++k) {
      if (byte(i + k) >> 6 != 2U) return false;
      code = code << 6 | (byte(i + k) & 0x3FU);
    }
    constexpr unsigned kLeast[] = {0, 0x80, 0x800, 0x10000};
    if (code < kLeast[count] || code > 0x10FFFFU || (code >= 0xD800U && code < 0xE000U)) return false;
    i += count + 1;
  }
  return true;
}

namespace {

/// Nesting beyond this is refused before the parser recurses.
constexpr int kMaxDepth = 512;

nlohmann::json parse(std::string_view text) {
  if (!is_utf8(text) || !is_nested_within(text, kMaxDepth)) return nlohmann::json(nlohmann::json::value_t::discarded);
  return nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
}

nlohmann::json value_at(const nlohmann::json& object, const char* key) {
  return object.is_object() ? object.value(key, nlohmann::json()) : nlohmann::json();
}

std::string text_at(const nlohmann::json& object, const char* key) {
  const nlohmann::json found = value_at(object, key);
  return found.is_string() ? found.get<std::string>() : std::string();
}

std::optional<double> real_at(const nlohmann::json& object, const char* key) {
  const nlohmann::json found = value_at(object, key);
  return found.is_number() ? std::optional(found.get<double>()) : std::nullopt;
}

/// `whole`: what holds where a mesh's own settings say nothing.
MetaFacts::OfMesh mesh_facts_of(const nlohmann::json& settings, const MetaFacts::OfMesh& whole) {
  MetaFacts::OfMesh facts;
  facts.attributes = text_at(settings, "attributes");
  facts.error_tier = text_at(settings, "error_tier");
  facts.uv_error_unit = text_at(settings, "uv_error_unit");
  for (const nlohmann::json& name : value_at(settings, "drop")) {
    if (name.is_string()) facts.dropped.push_back(name.get<std::string>());
  }
  facts.position_error = real_at(settings, "position_error");
  facts.normal_error = real_at(settings, "normal_error");
  facts.uv_error = real_at(settings, "uv_error");
  const nlohmann::json locked = value_at(settings, "lock_borders");
  facts.locks_borders = locked.is_boolean() ? locked.get<bool>() : whole.locks_borders;
  return facts;
}

std::optional<std::uint64_t> number_at(const nlohmann::json& object, const char* key) {
  const nlohmann::json found = value_at(object, key);
  return found.is_number_unsigned() ? std::optional(found.get<std::uint64_t>()) : std::nullopt;
}

std::vector<MetaFacts::Part> parts_of(const nlohmann::json& meta) {
  std::vector<MetaFacts::Part> parts;
  for (const nlohmann::json& entry : value_at(meta, "parts")) {
    const auto mesh = number_at(entry, "mesh"), of = number_at(entry, "of");
    if (!mesh || !of) return {};
    MetaFacts::Part& part = parts.emplace_back(MetaFacts::Part{*mesh, *of, {}});
    for (const nlohmann::json& pieces : value_at(entry, "pieces")) {
      const auto material = number_at(pieces, "material"), triangles = number_at(pieces, "triangles");
      if (!material || !triangles) return {};
      part.most_triangles[*material] = static_cast<std::uint32_t>(std::min<std::uint64_t>(*triangles, format::kNone));
    }
  }
  return parts;
}

MetaFacts facts_of(const nlohmann::json& meta) {
  const nlohmann::json settings = value_at(meta, "settings");
  MetaFacts facts;
  facts.source_hash = text_at(value_at(meta, "source"), "hash");
  facts.whole = mesh_facts_of(settings, {});
  facts.cluster_triangles = number_at(settings, "cluster_triangles");
  facts.cluster_vertices = number_at(settings, "cluster_vertices");
  facts.error_margin = real_at(settings, "error_margin");
  facts.keeps_topology = value_at(settings, "keep_topology") == true;
  facts.textures = text_at(settings, "textures");
  for (const nlohmann::json& apart : value_at(settings, "mesh_settings")) {
    for (const nlohmann::json& mesh : value_at(apart, "meshes")) {
      if (mesh.is_number_unsigned()) facts.apart_of_mesh[mesh.get<std::uint64_t>()] = facts.apart.size();
    }
    facts.apart.push_back(mesh_facts_of(apart, facts.whole));
  }
  facts.parts = parts_of(meta);
  return facts;
}

}  // namespace

MetaFacts read_meta_facts(std::string_view meta) {
  return facts_of(parse(meta));
}

void check_texts(FileTables& file, RuleLog& log) {
  const nlohmann::json meta = file.meta.empty() ? nlohmann::json::object() : parse(file.meta);
  file.facts = facts_of(meta);
  if (log.expect(
          meta.is_object(), Rule::kL013, [] { return std::string("section META"); },
          [] { return std::string("is not a JSON object"); })) {
    const auto has = [&](const char* key, nlohmann::json::value_t type) {
      const auto found = meta.find(key);
      if (found == meta.end()) return false;
      return log.expect(
          found->type() == type, Rule::kL013, [&] { return std::string("section META: /") + key; },
          [] { return std::string("is of another type"); });
    };
    has("generator", nlohmann::json::value_t::string);
    has("settings", nlohmann::json::value_t::object);
    has("parts", nlohmann::json::value_t::array);
    has("plan", nlohmann::json::value_t::array);
    has("left_out", nlohmann::json::value_t::array);
    if (has("source", nlohmann::json::value_t::object)) {
      for (const char* key : {"file", "hash"}) {
        log.expect(
            !meta["source"].contains(key) || meta["source"][key].is_string(), Rule::kL013,
            [&] { return std::string("section META: /source/") + key; }, [] { return std::string("is no string"); });
      }
    }
  }
  log.expect(
      parse(file.scene).is_object(), Rule::kL013, [] { return std::string("section SCNE"); },
      [] { return std::string("is not a JSON object"); });
}

}  // namespace meshlode::judge
