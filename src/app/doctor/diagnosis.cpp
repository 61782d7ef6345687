// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/doctor/diagnosis.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/append_format.h"
#include "base/nearest_name.h"
#include "base/printable.h"

namespace meshlode::app {

namespace {

constexpr double kHighShare = 0.1, kMediumShare = 0.01;
constexpr std::string_view kHigh = "high", kMedium = "medium", kLow = "low", kAny = "any";
constexpr std::size_t kMaxPlaces = 4;  ///< of a diagnosis in the text; JSON has all

void add_place_text(const DiagnosisPlace& place, std::string& text) {
  text += "     " + place.where + ": " + place.detail + "\n";
  if (!place.costs.empty()) {
    text += "       costs";
    for (std::size_t i = 0; i < place.costs.size(); ++i) {
      text += (i == 0 ? " " : ", ") + cost_text(place.costs[i]);
    }
    text += '\n';
  }
  if (!place.triangles.empty()) {
    text += "       triangles (primitive:triangle)";
    for (const DiagnosisTriangle& one : place.triangles) {
      append_format(text, " %u:%u", one.primitive, one.triangle);
    }
    text += place.triangle_count > place.triangles.size() ? " …\n" : "\n";
  }
  if (!place.groups.empty()) {
    text += "       groups";
    for (const std::uint32_t group : place.groups) append_format(text, " %u", group);
    text += place.count > place.groups.size() ? " …\n" : "\n";
  }
}

void write_place(const DiagnosisPlace& place, JsonWriter& json) {
  json.begin_object();
  json.field("where", place.where);
  json.key("mesh");
  if (place.mesh == ~0U) {
    json.null();
  } else {
    json.value(place.mesh);
  }
  json.field("count", place.count);
  json.field("detail", place.detail);
  json.field("share", place.share);
  json.key("costs");
  json.begin_array();
  for (const DiagnosisCost& cost : place.costs) {
    json.begin_object();
    json.field("kind", cost.kind);
    json.field("amount", cost.amount);
    json.field("unit", cost.unit);
    json.end_object();
  }
  json.end_array();
  json.field("triangle_count", place.triangle_count);
  json.key("triangles");
  json.begin_array();
  for (const DiagnosisTriangle& one : place.triangles) {
    json.begin_object();
    json.field("primitive", one.primitive);
    json.field("triangle", one.triangle);
    json.end_object();
  }
  json.end_array();
  json.key("groups");
  json.begin_array();
  for (const std::uint32_t group : place.groups) json.value(group);
  json.end_array();
  json.end_object();
}

}  // namespace

std::string mesh_words(std::uint32_t mesh, std::string_view name) {
  return "mesh " + std::to_string(mesh) + (name.empty() ? "" : " '" + printable(name) + "'");
}

std::string counted(std::uint64_t count, std::string_view many) {
  if (count != 1) return grouped_digits(count) + " " + std::string(many);
  if (many == "vertices") return "1 vertex";
  many.remove_suffix(many.ends_with("shes") ? 2 : 1);
  return "1 " + std::string(many);
}

void add_left_out(std::vector<Diagnosis>& diagnoses, std::string_view what, std::string_view why) {
  Diagnosis words;
  words.id = kLeftOutId;
  words.title = "parts of the source that assets do not store";
  words.remedy = "to keep it, export it in a supported form (docs/reference/input.md), and put missing files in place";
  DiagnosisPlace place;
  place.where = printable(what, 120);
  place.count = 1;
  place.detail = printable(why, 160);
  add_place(diagnoses, words, std::move(place));
}

const char* severity_of(double share) {
  if (share >= kHighShare) return kHigh.data();
  return share >= kMediumShare ? kMedium.data() : kLow.data();
}

void add_place(std::vector<Diagnosis>& diagnoses, const Diagnosis& words, DiagnosisPlace place) {
  const auto is_it = [&](const Diagnosis& one) { return one.id == words.id; };
  auto at = std::find_if(diagnoses.begin(), diagnoses.end(), is_it);
  if (at == diagnoses.end()) {
    diagnoses.push_back(words);
    at = diagnoses.end() - 1;
  }
  at->count += place.count;
  at->share = std::min(1.0, at->share + place.share);
  at->places.push_back(std::move(place));
}

void rank(std::vector<Diagnosis>& diagnoses) {
  for (Diagnosis& diagnosis : diagnoses) {
    std::stable_sort(diagnosis.places.begin(), diagnosis.places.end(),
                     [](const DiagnosisPlace& a, const DiagnosisPlace& b) { return a.share > b.share; });
  }
  std::sort(diagnoses.begin(), diagnoses.end(),
            [](const Diagnosis& a, const Diagnosis& b) { return std::tie(b.share, a.id) < std::tie(a.share, b.id); });
}

std::string share_text(double share) {
  std::string text = severity_of(share);
  const double percent = 100.0 * share;
  if (percent > 0.0) append_format(text, percent < 10.0 ? ", %.2g%%" : ", %.0f%%", percent);
  return text;
}

std::string cost_text(const DiagnosisCost& cost) {
  std::string text = cost.kind;
  const auto whole = static_cast<std::uint64_t>(std::clamp(cost.amount, 0.0, 0x1p63));
  if (cost.unit == "object units") {
    append_format(text, " (%.3g object units)", cost.amount);
  } else if (cost.unit == "triangles") {
    text += " (" + counted(whole, cost.unit) + ")";
  } else {
    const bool is_estimate = cost.unit == "asset bytes";
    append_format(text, " (%s%s of the %s)", is_estimate ? "about " : "", grouped_digits(whole).c_str(),
                  is_estimate ? "asset" : "source");
  }
  return text;
}

std::string doctor_text(const DoctorReport& report) {
  std::string text =
      report.file + ": " + counted(report.triangles, "triangles") + " in " + counted(report.meshes, "meshes") + ", ";
  text += report.diagnoses.empty() ? "nothing found\n" : counted(report.diagnoses.size(), "faults") + ", worst first\n";
  std::size_t number = 0;
  for (const Diagnosis& diagnosis : report.diagnoses) {
    append_format(text, "\n%2zu. %s [", ++number, diagnosis.id.c_str());
    text += share_text(diagnosis.share) + "]: " + diagnosis.title;
    if (diagnosis.places.size() > 1) text += ", " + grouped_digits(diagnosis.count) + " in all";
    text += '\n';
    for (std::size_t i = 0; i < std::min(kMaxPlaces, diagnosis.places.size()); ++i) {
      add_place_text(diagnosis.places[i], text);
    }
    if (diagnosis.places.size() > kMaxPlaces) {
      append_format(text, "     … and %zu more (--format json lists all)\n", diagnosis.places.size() - kMaxPlaces);
    }
    text += "     remedy: " + diagnosis.remedy + "\n";
    if (!diagnosis.hard_case.empty()) text += "     case: docs/reference/hard-cases.md#" + diagnosis.hard_case + "\n";
  }
  return text;
}

void write_diagnoses(JsonWriter& json, const std::vector<Diagnosis>& diagnoses) {
  json.begin_array();
  for (const Diagnosis& diagnosis : diagnoses) {
    json.begin_object();
    json.field("id", diagnosis.id);
    json.field("title", diagnosis.title);
    json.field("severity", severity_of(diagnosis.share));
    json.field("share", diagnosis.share);
    json.field("count", diagnosis.count);
    json.field("remedy", diagnosis.remedy);
    if (!diagnosis.hard_case.empty()) json.field("hard_case", diagnosis.hard_case);
    json.key("places");
    json.begin_array();
    for (const DiagnosisPlace& place : diagnosis.places) write_place(place, json);
    json.end_array();
    json.end_object();
  }
  json.end_array();
}

std::string doctor_json(const DoctorReport& report) {
  JsonWriter json;
  json.begin_object();
  json.field("file", report.file);
  json.field("kind", report.is_asset ? "asset" : "scene");
  json.field("meshes", report.meshes);
  json.field("triangles", report.triangles);
  json.key("faults");
  write_diagnoses(json, report.diagnoses);
  json.key("failed_on");
  json.begin_array();
  for (const std::string& id : report.failed_on) json.value(id);
  json.end_array();
  json.end_object();
  return json.text();
}

Result<std::vector<std::string>> find_failures(std::string_view words, const std::vector<std::string>& known,
                                               const std::vector<Diagnosis>& diagnoses) {
  std::vector<std::string> failed, names = known;
  for (const std::string_view name : {kHigh, kMedium, kAny}) names.emplace_back(name);
  const auto fail_on = [&](std::string_view word) {
    for (const Diagnosis& one : diagnoses) {
      const bool is_high = severity_of(one.share) == kHigh, is_low = severity_of(one.share) == kLow;
      const bool is_asked =
          one.id == word || word == kAny || (word == kHigh && is_high) || (word == kMedium && !is_low);
      if (is_asked && std::find(failed.begin(), failed.end(), one.id) == failed.end()) failed.push_back(one.id);
    }
  };
  do {
    const std::string_view word = words.substr(0, words.find(','));
    words.remove_prefix(std::min(words.size(), word.size() + 1));
    if (word.empty())
      return Error{ErrorCode::kUsage, "--fail-on", "give fault ids, high, medium or any, comma-separated"};
    if (std::find(names.begin(), names.end(), word) == names.end()) {
      return Error{ErrorCode::kUsage, "--fail-on",
                   "no fault is called '" + printable(word) + "'" + nearest_or_all(word, names)};
    }
    fail_on(word);
  } while (!words.empty());
  return failed;
}

}  // namespace meshlode::app
