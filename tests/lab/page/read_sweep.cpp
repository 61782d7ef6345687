// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/read_sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/import/json.h"

namespace meshlode::lab::page {

namespace {

using scene::Json;

const Json::Array kNothing;
constexpr double kLargest = 1e300;

/// Members as values, nothing where they are missing or null. The first of another type is remembered, and reading goes
/// on.
class Reader {
 public:
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  void refuse(std::string_view key, const char* expected) {
    if (!error_) error_ = Error{ErrorCode::kInvalid, "sweep.json: " + std::string(key), expected};
  }
  const Json* member(const Json& from, std::string_view key) {
    const Json* const found = from.find(key);
    return found == nullptr || std::holds_alternative<scene::JsonNull>(found->value) ? nullptr : found;
  }
  std::optional<std::string> maybe_text(const Json& from, std::string_view key) {
    const Json* const found = member(from, key);
    if (found == nullptr) return std::nullopt;
    if (found->is_string()) return std::string(*found->string());
    refuse(key, "no text");
    return std::nullopt;
  }
  std::string text(const Json& from, std::string_view key) { return maybe_text(from, key).value_or(""); }
  std::optional<double> maybe_number(const Json& from, std::string_view key) {
    const Json* const found = member(from, key);
    if (found == nullptr) return std::nullopt;
    const std::optional<double> number = found->number();
    if (number && std::abs(*number) <= kLargest) return number;
    refuse(key, "no number of at most 1e300");
    return std::nullopt;
  }
  double number(const Json& from, std::string_view key) { return maybe_number(from, key).value_or(0.0); }
  std::optional<std::uint64_t> maybe_count(const Json& from, std::string_view key) {
    const Json* const found = member(from, key);
    if (found == nullptr) return std::nullopt;
    const std::optional<std::uint64_t> count = found->index();
    if (!count) refuse(key, "no whole number of at most 2^53");
    return count;
  }
  std::uint64_t count(const Json& from, std::string_view key) { return maybe_count(from, key).value_or(0); }
  bool truth(const Json& from, std::string_view key) {
    const Json* const found = member(from, key);
    if (found == nullptr) return false;
    if (found->is_bool()) return std::get<bool>(found->value);
    refuse(key, "neither true nor false");
    return false;
  }
  const Json::Array& list(const Json& from, std::string_view key) {
    const Json* const found = member(from, key);
    if (found != nullptr && !found->is_array()) refuse(key, "no list");
    return found != nullptr && found->is_array() ? *found->array() : kNothing;
  }
  std::vector<std::string> texts(const Json& from, std::string_view key) {
    std::vector<std::string> out;
    for (const Json& item : list(from, key)) {
      if (item.is_string()) {
        out.emplace_back(*item.string());
      } else {
        refuse(key, "no list of texts");
      }
    }
    return out;
  }
  /// An object; an empty one where it is missing.
  const Json& object(const Json& from, std::string_view key) {
    static const Json no_members = Json::make_object();
    const Json* const found = member(from, key);
    if (found != nullptr && !found->is_object()) refuse(key, "no object");
    return found != nullptr && found->is_object() ? *found : no_members;
  }

 private:
  std::optional<Error> error_;
};

Figure read_figure(Reader& in, const Json& json) {
  Figure figure;
  figure.value = in.number(json, "value");
  figure.low = in.maybe_number(json, "min").value_or(figure.value);
  figure.high = in.maybe_number(json, "max").value_or(figure.value);
  figure.count = in.maybe_count(json, "n").value_or(1);
  const auto low = in.maybe_number(json, "range_low"), high = in.maybe_number(json, "range_high");
  if (low && high) figure.range = Figure::Range{*low, *high};
  return figure;
}

std::vector<Cut> read_cuts(Reader& in, const Json& json) {
  std::vector<Cut> cuts;
  for (const Json& one : in.list(json, "cuts")) {
    cuts.push_back({in.number(one, "threshold"), in.number(one, "stored"), in.number(one, "max"), in.number(one, "rms"),
                    in.count(one, "triangles")});
  }
  return cuts;
}

std::vector<CutPicture> read_cut_pictures(Reader& in, const Json& json) {
  std::vector<CutPicture> pictures;
  for (const Json& one : in.list(json, "pictures")) {
    CutPicture picture;
    picture.view = in.text(one, "view");
    picture.triangles = in.count(one, "triangles");
    picture.clusters = in.count(one, "clusters");
    picture.psnr = in.maybe_number(one, "psnr");
    picture.flip_mean = in.number(one, "flip_mean");
    picture.flip_median = in.number(one, "flip_median");
    picture.flip_max = in.number(one, "flip_max");
    picture.picture = in.text(one, "picture");
    picture.heat = in.text(one, "heat");
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

Point read_point(Reader& in, const Json& json) {
  Point point;
  point.id = in.text(json, "id");
  point.label = in.text(json, "label");
  point.why = in.text(json, "why");
  point.command = in.text(json, "command");
  point.draw_command = in.text(json, "draw_command");
  if (in.text(json, "status") == "failed") point.error = in.text(json, "error");
  point.content_hash = in.text(json, "content_hash");
  point.same_asset_as = in.text(json, "same_asset_as");
  point.is_experimental = in.truth(json, "experimental");
  point.changed = in.texts(json, "changed");
  point.dominated_by = in.texts(json, "dominated_by");
  for (const scene::JsonMember& setting : *in.object(json, "settings").object()) {
    if (setting.value.is_string()) {
      point.settings[setting.key] = *setting.value.string();
    } else {
      in.refuse("settings", "a setting that is not a text");
    }
  }
  for (const scene::JsonMember& figure : *in.object(json, "figures").object()) {
    if (in.member(figure.value, "value") == nullptr) in.refuse(figure.key, "a figure without a value");
    point.figures[figure.key] = read_figure(in, figure.value);
  }
  const Json& asset = in.object(json, "asset");
  point.error_tier = in.text(in.object(asset, "settings"), "error_tier");
  for (const Json& one : in.list(asset, "sections")) {
    point.sections.push_back({in.text(one, "name"), in.count(one, "bytes"), in.count(one, "bytes_decoded")});
  }
  point.cuts = read_cuts(in, json);
  for (const Json& one : in.list(json, "equal")) {
    point.equal.push_back({in.text(one, "figure") == "rms", in.number(one, "x"), in.maybe_count(one, "triangles")});
  }
  point.pictures = read_cut_pictures(in, json);
  return point;
}

void read_head(Reader& in, const Json& json, ReportData& data) {
  const Json& scene = in.object(json, "scene");
  data.scene_file = in.text(scene, "file");
  data.scene_hash = in.text(scene, "hash");
  data.meshes = in.count(scene, "meshes");
  data.instances = in.count(scene, "instances");
  data.triangles = in.count(scene, "triangles");
  data.vertices = in.count(scene, "vertices");
  const Json& program = in.object(json, "program");
  data.program_version = in.text(program, "version");
  data.program_id = in.text(program, "id");
  const Json& machine = in.object(json, "machine");
  data.machine = in.text(machine, "name");
  data.threads = in.count(machine, "threads");
  data.memory_bytes = in.count(machine, "memory_bytes");
  data.system = in.text(machine, "system");
  data.vulkan = in.text(machine, "vulkan");
  data.vulkan_reason = in.text(machine, "vulkan_reason");
  data.command = in.text(json, "command");
  data.budget_seconds = in.maybe_number(json, "budget_seconds");
  data.spent_seconds = in.number(json, "spent_seconds");
  data.rounds = in.count(json, "rounds");
  data.is_complete = in.truth(json, "complete");
  data.samples = in.count(json, "samples");
  data.seed = in.count(json, "seed");
  data.baseline = in.text(json, "baseline");
}

void read_axes(Reader& in, const Json& json, ReportData& data) {
  for (const Json& one : in.list(json, "knobs")) {
    data.knobs.push_back({in.text(one, "name"), in.text(one, "title"), in.text(one, "option"), in.text(one, "unit"),
                          in.text(one, "usual"), in.texts(one, "values")});
  }
  for (const Json& one : in.list(json, "metrics")) {
    data.metrics.push_back({in.text(one, "key"), in.text(one, "title"), in.text(one, "unit"), in.text(one, "group"),
                            in.text(one, "description"), in.text(one, "better") != "more", in.truth(one, "timed")});
  }
  for (const Json& one : in.list(json, "views")) {
    data.views.push_back({in.text(one, "name"), in.text(one, "picture")});
  }
}

void read_answers(Reader& in, const Json& json, ReportData& data) {
  for (const Json& one : in.list(json, "left_out")) {
    data.left_out.push_back(
        {in.text(one, "label"), in.text(one, "reason"), in.text(one, "command"), in.number(one, "estimated_seconds")});
  }
  for (const Json& one : in.list(json, "frontiers")) {
    data.frontiers.push_back({in.text(one, "x"), in.text(one, "y"), in.texts(one, "points")});
  }
  for (const Json& one : in.list(json, "recommendations")) {
    data.recommendations.push_back({in.text(one, "want"), in.text(one, "goal"), in.text(one, "why"),
                                    in.maybe_text(one, "point"), in.maybe_text(one, "command"),
                                    in.maybe_number(one, "value"), in.texts(one, "as_good"),
                                    in.texts(one, "not_compared")});
  }
}

app::Diagnosis read_fault(Reader& in, const Json& json) {
  app::Diagnosis fault;
  fault.id = in.text(json, "id");
  fault.title = in.text(json, "title");
  fault.remedy = in.text(json, "remedy");
  fault.hard_case = in.text(json, "hard_case");
  fault.count = in.count(json, "count");
  fault.share = std::clamp(in.number(json, "share"), 0.0, 1.0);
  for (const Json& one : in.list(json, "places")) {
    app::DiagnosisPlace place;
    place.where = in.text(one, "where");
    place.detail = in.text(one, "detail");
    for (const Json& cost : in.list(one, "costs")) {
      place.costs.push_back(
          {in.text(cost, "kind"), in.maybe_number(cost, "amount").value_or(HUGE_VAL), in.text(cost, "unit")});
    }
    fault.places.push_back(std::move(place));
  }
  return fault;
}

void read_doctor(Reader& in, const Json& json, ReportData& data) {
  if (in.member(json, "doctor") == nullptr) return;
  const Json& doctor = in.object(json, "doctor");
  data.scene_faults.emplace().command = in.text(doctor, "command");
  for (const Json& one : in.list(doctor, "faults")) data.scene_faults->ranked.push_back(read_fault(in, one));
}

}  // namespace

Result<ReportData> read_sweep(std::string_view text) {
  auto json = scene::parse_json(text);
  if (!json) return Error{json.error().code, "sweep.json", json.error().message()};
  Reader in;
  if (!json->is_object() || in.count(*json, "sweep_version") != 1) {
    return Error{ErrorCode::kInvalid, "sweep.json", "no sweep of version 1"};
  }
  ReportData data;
  read_head(in, *json, data);
  read_axes(in, *json, data);
  for (const Json& one : in.list(*json, "points")) data.points.push_back(read_point(in, one));
  read_answers(in, *json, data);
  read_doctor(in, *json, data);
  if (in.error()) return *in.error();
  return data;
}

}  // namespace meshlode::lab::page
