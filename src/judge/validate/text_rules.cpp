// SPDX-License-Identifier: GPL-3.0-or-later
// The asset's JSON texts; the one file of this room that sees nlohmann-json.
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

MetaFacts facts_of(const nlohmann::json& meta) {
  const auto value = [&](const char* section, const char* key) -> nlohmann::json {
    if (!meta.is_object() || !meta.contains(section) || !meta[section].is_object()) return {};
    return meta[section].value(key, nlohmann::json());
  };
  const auto text = [&](const char* section, const char* key) {
    const nlohmann::json found = value(section, key);
    return found.is_string() ? found.get<std::string>() : std::string();
  };
  const auto number = [&](const char* key) {
    const nlohmann::json found = value("settings", key);
    return found.is_number_unsigned() ? std::optional(found.get<std::uint64_t>()) : std::nullopt;
  };
  const auto real = [&](const char* key) {
    const nlohmann::json found = value("settings", key);
    return found.is_number() ? std::optional(found.get<double>()) : std::nullopt;
  };
  MetaFacts facts;
  facts.source_hash = text("source", "hash");
  facts.attributes = text("settings", "attributes");
  for (const nlohmann::json& name : value("settings", "drop")) {
    if (name.is_string()) facts.dropped.push_back(name.get<std::string>());
  }
  facts.error_tier = text("settings", "error_tier");
  facts.uv_error_unit = text("settings", "uv_error_unit");
  facts.cluster_triangles = number("cluster_triangles");
  facts.cluster_vertices = number("cluster_vertices");
  facts.error_margin = real("error_margin");
  facts.position_error = real("position_error");
  facts.normal_error = real("normal_error");
  facts.uv_error = real("uv_error");
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
