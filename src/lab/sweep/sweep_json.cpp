// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json_writer.h"
#include "base/version.h"
#include "lab/sweep/sweep.h"

namespace meshlode::lab {

namespace {

void write_ids(JsonWriter& w, const char* key, const SweepResult& result, const std::vector<std::size_t>& points) {
  w.key(key);
  w.begin_array();
  for (const std::size_t p : points) w.value(result.points[p].id);
  w.end_array();
}

void write_head(JsonWriter& w, const SweepOptions& options, const SweepResult& result) {
  w.field("sweep_version", 1);
  w.key("scene");
  w.begin_object();
  w.field("file", result.scene.file);
  w.field("hash", result.scene.hash);
  w.field("meshes", result.scene.meshes);
  w.field("instances", result.scene.instances);
  w.field("triangles", result.scene.triangles);
  w.field("vertices", result.scene.vertices);
  w.end_object();
  w.key("program");
  w.begin_object();
  w.field("version", program_version());
  w.field("id", options.program_id);
  w.end_object();
  w.key("machine");
  w.begin_object();
  w.field("name", result.machine.name);
  w.field("threads", result.machine.threads);
  w.field("memory_bytes", result.machine.memory_bytes);
  w.field("system", result.machine.system);
  w.text_or_null_field("vulkan", result.machine.vulkan.name);
  w.field("vulkan_reason", result.machine.vulkan.reason);
  w.end_object();
  w.field("command", options.command);
  w.optional_field("budget_seconds", options.budget > 0.0 ? std::optional(options.budget) : std::nullopt);
  w.field("spent_seconds", result.spent);
  w.field("rounds", options.rounds);
  w.field("complete", result.is_complete);
  w.field("samples", result.fineness.samples);
  w.field("seed", 1);
}

void write_doctor(JsonWriter& w, const SweepOptions& options, const SweepResult& result) {
  w.key("doctor");
  w.begin_object();
  w.field("command", doctor_command(options));
  w.key("faults");
  app::write_diagnoses(w, result.diagnoses);
  w.end_object();
}

void write_knobs(JsonWriter& w, const SweepResult& result) {
  w.key("knobs");
  w.begin_array();
  for (const Knob& knob : result.knobs) {
    w.begin_object();
    w.field("name", knob.name);
    w.field("title", knob.title);
    w.field("option", knob.option);
    w.field("kind", name_in(kKnobKindNames, knob.kind));
    w.field("unit", knob.unit);
    w.field("usual", knob.values[knob.usual].word);
    w.key("values");
    w.begin_array();
    for (const KnobValue& value : knob.values) w.value(value.word);
    w.end_array();
    w.end_object();
  }
  w.end_array();
}

void write_metrics(JsonWriter& w) {
  w.key("metrics");
  w.begin_array();
  for (const Metric& metric : all_metrics()) {
    w.begin_object();
    w.field("key", metric.key);
    w.field("title", metric.title);
    w.field("unit", metric.unit);
    w.field("better", metric.is_less_better ? "less" : "more");
    w.field("group", metric.group);
    w.field("timed", metric.is_timed);
    w.field("description", metric.description);
    w.end_object();
  }
  w.end_array();
}

void write_views(JsonWriter& w, const SweepResult& result) {
  w.key("views");
  w.begin_array();
  for (std::size_t v = 0; v < result.views.size(); ++v) {
    const run::Camera& camera = result.views[v].camera;
    w.begin_object();
    w.field("name", result.views[v].name);
    w.field("width", camera.width);
    w.field("height", camera.height);
    w.array_field("eye", std::vector<double>{camera.eye.x, camera.eye.y, camera.eye.z});
    w.array_field("target", std::vector<double>{camera.target.x, camera.target.y, camera.target.z});
    w.field("fovy", camera.fovy);
    w.field("near", camera.near_distance);
    w.text_or_null_field("picture", v < result.full_pictures.size() ? result.full_pictures[v] : "");
    w.end_object();
  }
  w.end_array();
}

void write_settings(JsonWriter& w, std::span<const Knob> knobs, const Point& point) {
  w.key("settings");
  w.begin_object();
  for (std::size_t k = 0; k < knobs.size(); ++k) w.field(knobs[k].name, knobs[k].values[point.values[k]].word);
  w.end_object();
  w.array_field("changed", changed_knobs(knobs, point));
}

void write_figures(JsonWriter& w, const Figures& figures) {
  w.key("figures");
  w.begin_object();
  for (const Metric& metric : all_metrics()) {
    const auto found = figures.find(metric.key);
    if (found == figures.end()) continue;
    w.key(metric.key);
    w.begin_object();
    w.field("value", found->second.value);
    if (metric.is_timed) {
      w.field("min", found->second.min);
      w.field("max", found->second.max);
      w.field("n", found->second.count);
      const auto range = range_of(metric, found->second);
      w.optional_field("range_low", range ? std::optional(range->low) : std::nullopt);
      w.optional_field("range_high", range ? std::optional(range->high) : std::nullopt);
    }
    w.end_object();
  }
  w.end_object();
}

void write_asset(JsonWriter& w, const AssetFacts& asset) {
  w.key("asset");
  w.begin_object();
  w.key("settings");
  w.raw(asset.settings);
  w.field("clusters", asset.clusters);
  w.field("groups", asset.groups);
  w.field("levels", asset.levels);
  w.field("stuck_groups", asset.stuck_groups);
  w.field("stored_triangles", asset.stored_triangles);
  w.field("stored_vertices", asset.stored_vertices);
  w.array_field("level_triangles", asset.level_triangles);
  w.key("sections");
  w.begin_array();
  for (const SectionBytes& section : asset.sections) {
    w.begin_object();
    w.field("name", section.name);
    w.field("bytes", section.bytes);
    w.field("bytes_decoded", section.bytes_decoded);
    w.end_object();
  }
  w.end_array();
  w.end_object();
}

void write_cuts(JsonWriter& w, const Measurement* asset) {
  w.key("cuts");
  w.begin_array();
  for (const CutRow& row : asset ? asset->cuts : std::vector<CutRow>{}) {
    w.begin_object();
    w.field("threshold", row.threshold);
    w.field("triangles", row.triangles);
    w.field("stored", row.stored);
    w.field("max", row.max);
    w.field("rms", row.rms);
    w.optional_field("normal", row.normal);
    w.optional_field("uv", row.uv);
    w.end_object();
  }
  w.end_array();
  w.key("equal");
  w.begin_array();
  for (const EqualRow& row : asset ? asset->equal : std::vector<EqualRow>{}) {
    w.begin_object();
    w.field("figure", row.figure);
    w.field("x", row.x);
    w.optional_field("triangles", row.triangles);
    w.optional_field("threshold", row.threshold);
    w.end_object();
  }
  w.end_array();
}

void write_pictures(JsonWriter& w, const Measurement* drawn) {
  w.key("pictures");
  w.begin_array();
  for (const PictureRow& row : drawn ? drawn->pictures : std::vector<PictureRow>{}) {
    w.begin_object();
    w.field("view", row.view);
    w.field("triangles", row.triangles);
    w.field("clusters", row.clusters);
    w.optional_field("psnr", row.psnr);
    w.field("flip_mean", row.flip_mean);
    w.field("flip_median", row.flip_median);
    w.field("flip_max", row.flip_max);
    w.text_or_null_field("picture", row.picture);
    w.text_or_null_field("heat", row.heat);
    w.end_object();
  }
  w.end_array();
}

void write_point(JsonWriter& w, const SweepOptions& options, const SweepResult& result, std::size_t at) {
  const PointResult& one = result.points[at];
  const bool is_measured = one.error.empty() && one.asset != nullptr;
  w.begin_object();
  w.field("id", one.id);
  write_settings(w, result.knobs, one.point);
  w.field("why", name_in(kPointKindNames, one.point.kind));
  w.field("label", one.label);
  w.field("experimental", is_experimental(result.knobs, one.point));
  w.field("command", build_command(options, result, one.point));
  w.field("draw_command", draw_command(options, result, one.point));
  w.field("status", one.error.empty() ? "done" : "failed");
  w.text_or_null_field("error", one.error);
  w.field("from_state", one.is_from_state);
  w.text_or_null_field("content_hash", is_measured ? one.asset->asset.content_hash : "");
  w.text_or_null_field("same_asset_as", is_measured ? same_asset_as(result, at) : "");
  write_figures(w, one.figures);
  if (is_measured) write_asset(w, one.asset->asset);
  write_cuts(w, is_measured ? one.asset : nullptr);
  write_pictures(w, is_measured ? one.drawn : nullptr);
  write_ids(w, "dominated_by", result, result.dominated_by[at]);
  w.end_object();
}

void write_left_out(JsonWriter& w, const SweepOptions& options, const SweepResult& result) {
  w.key("left_out");
  w.begin_array();
  for (const PointResult& one : result.points) {
    if (one.is_done) continue;
    w.begin_object();
    w.field("id", one.id);
    write_settings(w, result.knobs, one.point);
    w.field("label", one.label);
    w.field("command", build_command(options, result, one.point));
    w.field("reason", one.reason == LeftOutReason::kBudget ? "budget" : "interrupted");
    w.field("estimated_seconds", one.estimate);
    w.end_object();
  }
  w.end_array();
}

void write_idle_knobs(JsonWriter& w, const SweepResult& result) {
  w.key("knobs_left_out");
  w.begin_array();
  for (const IdleKnob& knob : result.idle_knobs) {
    w.begin_object();
    w.field("name", knob.name);
    w.field("why", knob.why);
    w.end_object();
  }
  w.end_array();
}

void write_recommendation(JsonWriter& w, const SweepOptions& options, const SweepResult& result,
                          const Recommendation& one) {
  w.begin_object();
  w.field("want", one.wish.text);
  w.field("goal", one.wish.goal->key);
  w.key("conditions");
  w.begin_array();
  for (const Wish::Bound& bound : one.wish.bounds) {
    w.begin_object();
    w.field("metric", bound.metric->key);
    w.field("relation", name_in(app::kRelationNames, bound.relation));
    w.field("value", bound.value);
    w.end_object();
  }
  w.end_array();
  const PointResult* point = one.answer.point ? &result.points[*one.answer.point] : nullptr;
  w.text_or_null_field("point", point ? point->id : "");
  w.text_or_null_field("command", point ? build_command(options, result, point->point) : "");
  w.optional_field("value", point ? std::optional(point->figures.at(one.wish.goal->key).value) : std::nullopt);
  write_ids(w, "as_good", result, one.answer.as_good);
  write_ids(w, "not_compared", result, one.answer.not_compared);
  w.field("why", one.answer.why);
  w.end_object();
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + shell_word(word);
  return text;
}

}  // namespace

std::string same_asset_as(const SweepResult& result, std::size_t at) {
  const PointResult& one = result.points[at];
  if (one.asset == nullptr) return {};
  for (std::size_t i = 0; i < at; ++i) {
    const PointResult& other = result.points[i];
    if (!other.is_done || other.asset == nullptr) continue;
    if (other.asset->asset.content_hash == one.asset->asset.content_hash) return other.id;
  }
  return {};
}

std::string shell_word(const std::string& word) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string build_command(const SweepOptions& options, const SweepResult& result, const Point& point) {
  std::vector<std::string> words{
      "meshlode", build_verb(result.knobs, point), options.scene.string(), "-o", "out.lode", "--no-settings-file"};
  if (!options.scene_choice.empty()) words.insert(words.end(), {"--scene", options.scene_choice});
  if (!options.max_decoded_text.empty()) words.insert(words.end(), {"--max-decoded", options.max_decoded_text});
  for (const auto& folder : options.allow_outside) words.insert(words.end(), {"--allow-outside", folder.string()});
  const std::vector<std::string> settings = build_arguments(result.knobs, point);
  words.insert(words.end(), settings.begin(), settings.end());
  return joined(words);
}

std::string doctor_command(const SweepOptions& options) {
  std::vector<std::string> words{"meshlode", "doctor", options.scene.string()};
  if (!options.scene_choice.empty()) words.insert(words.end(), {"--scene", options.scene_choice});
  if (!options.max_decoded_text.empty()) words.insert(words.end(), {"--max-decoded", options.max_decoded_text});
  for (const auto& folder : options.allow_outside) words.insert(words.end(), {"--allow-outside", folder.string()});
  return joined(words);
}

std::string draw_command(const SweepOptions&, const SweepResult& result, const Point& point) {
  std::vector<std::string> words{"meshlode", "render", "out.lode", "-o", "out.png"};
  if (!result.views.empty()) {
    const run::Camera& camera = result.views.front().camera;
    words.insert(words.end(), {"--size", std::to_string(camera.width) + "x" + std::to_string(camera.height)});
  }
  const std::vector<std::string> settings = draw_arguments(result.knobs, point);
  words.insert(words.end(), settings.begin(), settings.end());
  return joined(words);
}

std::string sweep_json(const SweepOptions& options, const SweepResult& result) {
  JsonWriter w;
  w.begin_object();
  write_head(w, options, result);
  if (options.diagnose_scene) write_doctor(w, options, result);
  write_knobs(w, result);
  write_metrics(w);
  write_views(w, result);
  w.field("baseline", result.points.front().id);
  w.key("points");
  w.begin_array();
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    if (result.points[i].is_done) write_point(w, options, result, i);
  }
  w.end_array();
  write_left_out(w, options, result);
  write_idle_knobs(w, result);
  w.key("frontiers");
  w.begin_array();
  for (const Frontier& frontier : result.frontiers) {
    w.begin_object();
    w.field("x", frontier.x->key);
    w.field("y", frontier.y->key);
    write_ids(w, "points", result, frontier.points);
    w.end_object();
  }
  w.end_array();
  w.key("recommendations");
  w.begin_array();
  for (const Recommendation& one : result.recommendations) write_recommendation(w, options, result, one);
  w.end_array();
  w.end_object();
  return w.text();
}

}  // namespace meshlode::lab
