// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/measurement_json.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/enum_names.h"
#include "base/json_depth.h"

namespace meshlode::lab {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<EnumName<MeasurementKind>, 4> kKindNames{{{MeasurementKind::kBuild, "build"},
                                                               {MeasurementKind::kAsset, "asset"},
                                                               {MeasurementKind::kDraw, "draw"},
                                                               {MeasurementKind::kFrames, "frames"}}};

template <class T>
Json optional_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <class T>
std::optional<T> read_optional(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<T>();
}

/// Anything else is no count: a conversion would make one of it, or worse.
std::uint64_t count_of(const Json& json) {
  if (!json.is_number_unsigned()) throw std::domain_error("no count");
  return json.get<std::uint64_t>();
}

Json asset_json(const AssetFacts& asset) {
  Json json = {{"content_hash", asset.content_hash},
               {"settings", asset.settings},
               {"clusters", asset.clusters},
               {"groups", asset.groups},
               {"levels", asset.levels},
               {"stuck_groups", asset.stuck_groups},
               {"stored_triangles", asset.stored_triangles},
               {"stored_vertices", asset.stored_vertices},
               {"level_triangles", asset.level_triangles},
               {"sections", Json::array()}};
  for (const SectionBytes& s : asset.sections) json["sections"].push_back({s.name, s.bytes, s.bytes_decoded});
  return json;
}

AssetFacts read_asset(const Json& json) {
  AssetFacts asset;
  asset.content_hash = json.at("content_hash").get<std::string>();
  asset.settings = json.at("settings").get<std::string>();
  if (!is_nested_within(asset.settings, 64) || !Json::accept(asset.settings)) asset.settings = "{}";
  asset.clusters = count_of(json.at("clusters"));
  asset.groups = count_of(json.at("groups"));
  asset.levels = count_of(json.at("levels"));
  asset.stuck_groups = count_of(json.at("stuck_groups"));
  asset.stored_triangles = count_of(json.at("stored_triangles"));
  asset.stored_vertices = count_of(json.at("stored_vertices"));
  for (const Json& level : json.at("level_triangles")) asset.level_triangles.push_back(count_of(level));
  for (const Json& s : json.at("sections")) {
    asset.sections.push_back({s.at(0).get<std::string>(), count_of(s.at(1)), count_of(s.at(2))});
  }
  return asset;
}

Json rows_json(const Measurement& m) {
  Json json = {{"cuts", Json::array()}, {"equal", Json::array()}, {"pictures", Json::array()}};
  for (const CutRow& c : m.cuts) {
    json["cuts"].push_back(
        {c.threshold, c.triangles, c.stored, c.max, c.rms, optional_json(c.normal), optional_json(c.uv)});
  }
  for (const EqualRow& e : m.equal) {
    json["equal"].push_back({e.figure, e.x, optional_json(e.triangles), optional_json(e.threshold)});
  }
  for (const PictureRow& p : m.pictures) {
    json["pictures"].push_back({p.view, p.triangles, p.clusters, optional_json(p.psnr), p.flip_mean, p.flip_median,
                                p.flip_max, p.picture, p.heat});
  }
  return json;
}

void read_rows(const Json& json, Measurement& m) {
  for (const Json& c : json.at("cuts")) {
    m.cuts.push_back({c.at(0).get<double>(), count_of(c.at(1)), c.at(2).get<double>(), c.at(3).get<double>(),
                      c.at(4).get<double>(), read_optional<double>(c.at(5)), read_optional<double>(c.at(6))});
  }
  for (const Json& e : json.at("equal")) {
    EqualRow row{e.at(0).get<std::string>(), e.at(1).get<double>(), std::nullopt, read_optional<double>(e.at(3))};
    if (!e.at(2).is_null()) row.triangles = count_of(e.at(2));
    m.equal.push_back(std::move(row));
  }
  for (const Json& p : json.at("pictures")) {
    m.pictures.push_back({p.at(0).get<std::string>(), count_of(p.at(1)), count_of(p.at(2)),
                          read_optional<double>(p.at(3)), p.at(4).get<double>(), p.at(5).get<double>(),
                          p.at(6).get<double>(), p.at(7).get<std::string>(), p.at(8).get<std::string>()});
  }
}

}  // namespace

std::string measurement_line(const Measurement& m) {
  Json json = {{"kind", name_in(kKindNames, m.kind)},
               {"key", m.key},
               {"round", m.round},
               {"seconds", m.seconds},
               {"error", m.error},
               {"figures", Json::object()}};
  for (const auto& [key, value] : m.figures) json["figures"][key] = value;
  if (m.kind == MeasurementKind::kAsset) json["asset"] = asset_json(m.asset);
  json["rows"] = rows_json(m);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<Measurement> read_measurement(std::string_view line) {
  constexpr int kLevels = 8;
  if (!is_nested_within(line, kLevels)) return std::nullopt;
  try {
    const Json json = Json::parse(line);
    Measurement m;
    const auto kind = value_in(kKindNames, json.at("kind").get<std::string>());
    if (!kind) return std::nullopt;
    m.kind = *kind;
    m.key = json.at("key").get<std::string>();
    m.round = static_cast<std::uint32_t>(std::min<std::uint64_t>(count_of(json.at("round")), 1U << 20U));
    m.seconds = json.at("seconds").get<double>();
    m.error = json.at("error").get<std::string>();
    for (const auto& [key, value] : json.at("figures").items()) m.figures[key] = value.get<double>();
    if (m.kind == MeasurementKind::kAsset) m.asset = read_asset(json.at("asset"));
    read_rows(json.at("rows"), m);
    m.is_stored = true;
    return m;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace meshlode::lab
