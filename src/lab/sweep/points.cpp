// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/points.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "base/append_format.h"
#include "base/hash.h"

namespace meshlode::lab {

namespace {

/// A knob's first other value says whether it matters at all; further ones say how it bends. Any value of a knob of
/// accuracy is worth more than all others.
constexpr double kFirst = 1.0, kSecond = 0.8, kThird = 0.5, kCornerWorth = 0.6, kOfStudy = 0.3, kOfAccuracy = 1.0;

/// The nearest of 1, 2 and 5 times a power of ten, as a word: what a person would write.
std::string round_word(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  double best = power;
  for (const double step : {2.0, 5.0, 10.0}) {
    if (std::abs(std::log(step * power / value)) < std::abs(std::log(best / value))) best = step * power;
  }
  std::string text;
  append_format(text, "%.6g", best);
  return text;
}

Knob position_knob(double diagonal) {
  Knob knob{"position_error", "position budget", "--position-error", "mesh units", KnobKind::kBuild, 0, {}};
  knob.values.push_back({"auto", 1.0, 0.0});
  // Six with the usual one: a curve.
  constexpr std::pair<double, double> kShares[] = {
      {1e-5, kSecond}, {3e-5, kSecond}, {1e-4, kFirst}, {3e-4, kSecond}, {1e-3, kSecond}};
  for (const auto& [share, worth] : kShares) knob.values.push_back({round_word(share * diagonal), 1.0, worth});
  return knob;
}

struct Setting {
  const char* knob;
  const char* word;
};
/// Settings that interact: what a strip costs depends on how long clusters let it be, what a proof costs on who asks.
const std::vector<Setting> kCorners[] = {
    {{"preset", "fast"}, {"codec", "none"}},
    {{"preset", "best"}, {"codec", "none"}},
    {{"strip_effort", "best"}, {"cluster_triangles", "256"}},
    {{"strip_effort", "best"}, {"cluster_triangles", "64"}},
    {{"preset", "fast"}, {"error_tier", "measured"}},
    {{"preset", "best"}, {"error_tier", "certified"}},
    {{"strip_effort", "best"}, {"normal_error", "1"}},
};

std::optional<std::size_t> find_value(const Knob& knob, const std::string& word) {
  for (std::size_t i = 0; i < knob.values.size(); ++i) {
    if (knob.values[i].word == word) return i;
  }
  return std::nullopt;
}

/// Nothing where the sweep has not all of its knobs.
std::optional<Point> corner_of(std::span<const Knob> knobs, const Point& baseline, const std::vector<Setting>& corner) {
  Point point = baseline;
  point.kind = PointKind::kCorner;
  point.worth = kCornerWorth;
  for (const Setting& setting : corner) {
    const auto knob = std::find_if(knobs.begin(), knobs.end(), [&](const Knob& k) { return k.name == setting.knob; });
    if (knob == knobs.end()) return std::nullopt;
    const auto value = find_value(*knob, setting.word);
    if (!value) return std::nullopt;
    point.values[static_cast<std::size_t>(knob - knobs.begin())] = *value;
  }
  return point;
}

enum class KeyOf : std::uint8_t { kSettings, kBuild, kContent };

std::string key_of(std::span<const Knob> knobs, const Point& point, KeyOf what) {
  std::string key;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    // Usual values are left out: a knob that comes to be changes no key of what was measured without it.
    if (point.values[k] == knobs[k].usual) continue;
    if (knobs[k].kind == KnobKind::kDraw && what != KeyOf::kSettings) continue;
    if (knobs[k].is_of_pages && what == KeyOf::kContent) continue;
    key += knobs[k].name + "=" + knobs[k].values[point.values[k]].word + "\n";
  }
  return key;
}

std::vector<std::string> arguments_of(std::span<const Knob> knobs, const Point& point, bool of_draw) {
  std::vector<std::string> arguments;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    const bool is_meant = (knobs[k].kind == KnobKind::kDraw) == of_draw || (of_draw && knobs[k].is_drawn_too);
    if (point.values[k] == knobs[k].usual || !is_meant) continue;
    arguments.push_back(knobs[k].option);
    arguments.push_back(knobs[k].values[point.values[k]].word);
  }
  return arguments;
}

}  // namespace

namespace {

void add_codec_knobs(std::vector<Knob>& knobs) {
  knobs.push_back(
      {"codec", "codec", "--codec", "", KnobKind::kBuild, 0, {{"strips", 1.0, 0.0}, {"none", 1.0, kFirst}}, true});
  knobs.push_back({"strip_effort",
                   "strip effort",
                   "--strip-effort",
                   "",
                   KnobKind::kBuild,
                   0,
                   {{"auto", 1.0, 0.0}, {"fast", 0.9, kFirst}, {"best", 1.2, kThird}}});
}

void add_study_knobs(std::vector<Knob>& knobs) {
  knobs.push_back({"simplifier",
                   "simplifier",
                   "--simplifier",
                   "",
                   KnobKind::kStudy,
                   0,
                   {{"own", 1.0, 0.0}, {"openmesh", 2.0, kSecond}}});
  knobs.push_back({"care",
                   "care",
                   "--care",
                   "",
                   KnobKind::kStudy,
                   0,
                   {{"all", 1.0, 0.0},
                    {"double-quadrics=off", 1.0, kSecond},
                    {"fallback=off", 1.0, kOfStudy},
                    {"spheres=off", 1.0, kOfStudy},
                    {"needles=off", 1.0, kOfStudy}}});
}

void add_attribute_knobs(const SceneFacts& facts, std::vector<Knob>& knobs) {
  if (facts.has_normals) {
    knobs.push_back({"normal_error",
                     "normal budget",
                     "--normal-error",
                     "degrees",
                     KnobKind::kBuild,
                     1,
                     {{"0.02", 1.0, kThird}, {"0.1", 1.0, 0.0}, {"0.5", 1.0, kSecond}, {"1", 1.0, kFirst}}});
  }
  if (facts.has_uvs) {
    knobs.push_back({"uv_error",
                     "UV budget",
                     "--uv-error",
                     "",
                     KnobKind::kBuild,
                     0,
                     {{"auto", 1.0, 0.0}, {"0.25px", 1.0, kSecond}, {"1px", 1.0, kFirst}}});
  }
  if (!facts.has_uvs && !facts.has_normals) return;
  Knob promise{"promise", "promise", "--promise", "", KnobKind::kBuild, 0, {{"position", 1.0, 0.0}}};
  if (facts.has_uvs) promise.values.push_back({"texels", 4.0, kFirst});
  if (facts.has_normals) promise.values.push_back({"appearance", 5.0, facts.has_uvs ? kThird : kFirst});
  promise.is_drawn_too = true;
  knobs.push_back(std::move(promise));
}

std::vector<Knob> list_knobs(const SceneFacts& facts) {
  std::vector<Knob> knobs;
  knobs.push_back({"preset",
                   "preset",
                   "--preset",
                   "",
                   KnobKind::kBuild,
                   1,
                   {{"fast", 0.6, kFirst}, {"default", 1.0, 0.0}, {"best", 1.8, kSecond}}});
  knobs.push_back({"error_tier",
                   "error tier",
                   "--error-tier",
                   "",
                   KnobKind::kBuild,
                   0,
                   {{"auto", 1.0, 0.0}, {"qem", 0.6, kFirst}, {"measured", 1.0, 0.0}, {"certified", 4.0, kSecond}}});
  if (facts.largest_diagonal > 0.0) knobs.push_back(position_knob(facts.largest_diagonal));
  add_attribute_knobs(facts, knobs);
  for (Knob& knob : knobs) knob.is_of_accuracy = true;
  add_codec_knobs(knobs);
  knobs.push_back({"cluster_triangles",
                   "cluster size",
                   "--cluster-triangles",
                   "triangles",
                   KnobKind::kBuild,
                   1,
                   {{"64", 1.2, kFirst}, {"128", 1.0, 0.0}, {"256", 0.9, kFirst}}});
  knobs.push_back({"group_clusters",
                   "group size",
                   "--group-clusters",
                   "clusters",
                   KnobKind::kBuild,
                   1,
                   {{"12", 1.0, kFirst}, {"20", 1.0, 0.0}, {"28", 1.0, kSecond}}});
  add_study_knobs(knobs);
  knobs.push_back({"pixel_error",
                   "pixel error",
                   "--pixel-error",
                   "pixels",
                   KnobKind::kDraw,
                   1,
                   {{"0.5", 0.0, kSecond}, {"1", 0.0, 0.0}, {"2", 0.0, kFirst}, {"4", 0.0, kSecond}}});
  return knobs;
}

}  // namespace

std::vector<Knob> make_knobs(const SceneFacts& facts, std::span<const std::string> chosen) {
  std::vector<Knob> knobs = list_knobs(facts);
  std::erase_if(knobs, [&](const Knob& knob) {
    return !chosen.empty() && std::find(chosen.begin(), chosen.end(), knob.name) == chosen.end();
  });
  return knobs;
}

std::vector<IdleKnob> find_idle_knobs(const SceneFacts& facts, std::span<const std::string> chosen) {
  std::vector<IdleKnob> idle;
  const auto add = [&](const char* name, bool is_idle, const char* why) {
    const bool is_chosen = chosen.empty() || std::find(chosen.begin(), chosen.end(), name) != chosen.end();
    if (is_idle && is_chosen) idle.push_back({name, why});
  };
  add("position_error", !(facts.largest_diagonal > 0.0), "no mesh has an extent");
  add("normal_error", !facts.has_normals, "no mesh stores normals");
  add("uv_error", !facts.has_uvs, "no mesh has texture coordinates");
  add("promise", !facts.has_normals && !facts.has_uvs, "no mesh has normals or texture coordinates");
  return idle;
}

std::vector<std::string> all_knob_names() {
  std::vector<std::string> names;
  for (const Knob& knob : list_knobs({1.0, true, true})) names.push_back(knob.name);
  return names;
}

std::vector<Point> make_points(std::span<const Knob> knobs) {
  Point baseline;
  for (const Knob& knob : knobs) baseline.values.push_back(knob.usual);
  baseline.worth = 2.0 * (kFirst + kOfAccuracy);
  std::vector<Point> points{baseline};
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    for (std::size_t v = 0; v < knobs[k].values.size(); ++v) {
      if (!(knobs[k].values[v].worth > 0.0)) continue;
      Point point = baseline;
      point.kind = PointKind::kOneFactor;
      point.values[k] = v;
      point.worth = knobs[k].values[v].worth + (knobs[k].is_of_accuracy ? kOfAccuracy : 0.0);
      points.push_back(std::move(point));
    }
  }
  for (const std::vector<Setting>& corner : kCorners) {
    if (auto point = corner_of(knobs, baseline, corner)) points.push_back(std::move(*point));
  }
  std::set<std::string> known;
  std::erase_if(points, [&](const Point& point) { return !known.insert(settings_key(knobs, point)).second; });
  return points;
}

std::string settings_key(std::span<const Knob> knobs, const Point& point) {
  return key_of(knobs, point, KeyOf::kSettings);
}

std::string build_key(std::span<const Knob> knobs, const Point& point) {
  return key_of(knobs, point, KeyOf::kBuild);
}

std::string content_key(std::span<const Knob> knobs, const Point& point) {
  return key_of(knobs, point, KeyOf::kContent);
}

std::string point_id(std::span<const Knob> knobs, const Point& point) {
  const std::string key = settings_key(knobs, point);
  return to_hex(hash128({reinterpret_cast<const std::uint8_t*>(key.data()), key.size()})).substr(0, 16);
}

std::string point_label(std::span<const Knob> knobs, const Point& point) {
  std::string text;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    if (point.values[k] == knobs[k].usual) continue;
    text += (text.empty() ? "" : ", ") + knobs[k].title + " " + knobs[k].values[point.values[k]].word;
  }
  return text.empty() ? "baseline" : text;
}

std::vector<std::string> changed_knobs(std::span<const Knob> knobs, const Point& point) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    if (point.values[k] != knobs[k].usual) names.push_back(knobs[k].name);
  }
  return names;
}

bool is_experimental(std::span<const Knob> knobs, const Point& point) {
  for (std::size_t k = 0; k < point.values.size(); ++k) {  // the baseline has none before the knobs are known
    if (knobs[k].kind == KnobKind::kStudy && point.values[k] != knobs[k].usual) return true;
  }
  return false;
}

const char* build_verb(std::span<const Knob> knobs, const Point& point) {
  return is_experimental(knobs, point) ? "study" : "build";
}

std::vector<std::string> build_arguments(std::span<const Knob> knobs, const Point& point) {
  return arguments_of(knobs, point, false);
}

std::vector<std::string> draw_arguments(std::span<const Knob> knobs, const Point& point) {
  return arguments_of(knobs, point, true);
}

double build_factor(std::span<const Knob> knobs, const Point& point) {
  double factor = 1.0;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    if (knobs[k].kind != KnobKind::kDraw) factor *= knobs[k].values[point.values[k]].build_factor;
  }
  return factor;
}

std::string word_of(std::span<const Knob> knobs, const Point& point, const std::string& knob) {
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    if (knobs[k].name == knob) return knobs[k].values[point.values[k]].word;
  }
  return {};
}

double number_of(std::span<const Knob> knobs, const Point& point, const std::string& knob, double otherwise) {
  const std::string word = word_of(knobs, point, knob);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() ? value : otherwise;
}

}  // namespace meshlode::lab
