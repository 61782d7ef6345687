// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/page_data.h"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/version.h"
#include "scene/import/json.h"

namespace meshlode::lab {

namespace {

std::vector<std::string> ids_of(const SweepResult& result, const std::vector<std::size_t>& points) {
  std::vector<std::string> ids;
  for (const std::size_t p : points) ids.push_back(result.points[p].id);
  return ids;
}

/// As the asset's META records it, whatever the setting left open.
std::string error_tier_of(const AssetFacts& asset) {
  const auto settings = scene::parse_json(asset.settings);
  const scene::Json* const tier = settings && settings->is_object() ? settings->find("error_tier") : nullptr;
  return tier != nullptr && tier->is_string() ? std::string(*tier->string()) : std::string();
}

page::Figure page_figure(const Metric& metric, const Figure& figure) {
  if (!metric.is_timed) return {figure.value, figure.value, figure.value};
  page::Figure shown{figure.value, figure.min, figure.max, figure.count};
  if (const auto range = range_of(metric, figure)) shown.range = page::Figure::Range{range->low, range->high};
  return shown;
}

void add_asset(const Measurement& asset, page::Point& point) {
  point.content_hash = asset.asset.content_hash;
  point.error_tier = error_tier_of(asset.asset);
  for (const SectionBytes& section : asset.asset.sections) {
    point.sections.push_back({section.name, section.bytes, section.bytes_decoded});
  }
  for (const CutRow& row : asset.cuts) {
    point.cuts.push_back({row.threshold, row.stored, row.max, row.rms, row.triangles});
  }
  for (const EqualRow& row : asset.equal) point.equal.push_back({row.figure == "rms", row.x, row.triangles});
}

page::Point page_point(const SweepOptions& options, const SweepResult& result, std::size_t at) {
  const PointResult& one = result.points[at];
  page::Point point;
  point.id = one.id;
  point.label = one.label;
  point.why = name_in(kPointKindNames, one.point.kind);
  point.command = build_command(options, result, one.point);
  point.draw_command = draw_command(options, result, one.point);
  point.is_experimental = is_experimental(result.knobs, one.point);
  point.changed = changed_knobs(result.knobs, one.point);
  point.dominated_by = ids_of(result, result.dominated_by[at]);
  for (std::size_t k = 0; k < result.knobs.size(); ++k) {
    point.settings[result.knobs[k].name] = result.knobs[k].values[one.point.values[k]].word;
  }
  for (const Metric& metric : all_metrics()) {
    const auto found = one.figures.find(metric.key);
    if (found != one.figures.end()) point.figures[metric.key] = page_figure(metric, found->second);
  }
  if (!one.error.empty()) {
    point.error = one.error;
    return point;
  }
  if (one.asset == nullptr) return point;
  add_asset(*one.asset, point);
  point.same_asset_as = same_asset_as(result, at);
  if (one.drawn == nullptr) return point;
  for (const PictureRow& row : one.drawn->pictures) {
    point.pictures.push_back({row.view, row.triangles, row.clusters, row.psnr, row.flip_mean, row.flip_median,
                              row.flip_max, row.picture, row.heat});
  }
  return point;
}

void set_head(const SweepOptions& options, const SweepResult& result, page::ReportData& data) {
  data.scene_file = result.scene.file;
  data.scene_hash = result.scene.hash;
  data.meshes = result.scene.meshes;
  data.instances = result.scene.instances;
  data.triangles = result.scene.triangles;
  data.vertices = result.scene.vertices;
  data.program_version = program_version();
  data.program_id = options.program_id;
  data.machine = result.machine.name;
  data.threads = result.machine.threads;
  data.memory_bytes = result.machine.memory_bytes;
  data.system = result.machine.system;
  data.vulkan = result.machine.vulkan.name;
  data.vulkan_reason = result.machine.vulkan.reason;
  data.command = options.command;
  if (options.budget > 0.0) data.budget_seconds = options.budget;
  data.spent_seconds = result.spent;
  data.rounds = options.rounds;
  data.is_complete = result.is_complete;
  data.samples = result.fineness.samples;
  data.seed = 1;
  data.baseline = result.points.front().id;
}

void add_axes(const SweepResult& result, page::ReportData& data) {
  for (const Knob& knob : result.knobs) {
    std::vector<std::string> words;
    for (const KnobValue& value : knob.values) words.push_back(value.word);
    data.knobs.push_back(
        {knob.name, knob.title, knob.option, knob.unit, knob.values[knob.usual].word, std::move(words)});
  }
  for (const Metric& metric : all_metrics()) {
    data.metrics.push_back({metric.key, metric.title, metric.unit, metric.group, metric.description,
                            metric.is_less_better, metric.is_timed});
  }
  for (std::size_t v = 0; v < result.views.size(); ++v) {
    data.views.push_back(
        {result.views[v].name, v < result.full_pictures.size() ? result.full_pictures[v] : std::string()});
  }
}

void add_answers(const SweepOptions& options, const SweepResult& result, page::ReportData& data) {
  for (const PointResult& one : result.points) {
    if (one.is_done) continue;
    data.left_out.push_back({one.label, one.reason == LeftOutReason::kBudget ? "budget" : "interrupted",
                             build_command(options, result, one.point), one.estimate});
  }
  for (const Frontier& frontier : result.frontiers) {
    data.frontiers.push_back({frontier.x->key, frontier.y->key, ids_of(result, frontier.points)});
  }
  for (const Recommendation& one : result.recommendations) {
    page::Recommendation shown{one.wish.text,
                               one.wish.goal->key,
                               one.answer.why,
                               {},
                               {},
                               {},
                               ids_of(result, one.answer.as_good),
                               ids_of(result, one.answer.not_compared)};
    if (one.answer.point) {
      const PointResult& point = result.points[*one.answer.point];
      shown.point = point.id;
      shown.command = build_command(options, result, point.point);
      shown.value = point.figures.at(one.wish.goal->key).value;
    }
    data.recommendations.push_back(std::move(shown));
  }
}

}  // namespace

page::ReportData page_data(const SweepOptions& options, const SweepResult& result) {
  page::ReportData data;
  set_head(options, result, data);
  add_axes(result, data);
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    if (result.points[i].is_done) data.points.push_back(page_point(options, result, i));
  }
  add_answers(options, result, data);
  if (options.diagnose_scene) data.scene_faults = page::SceneFaults{doctor_command(options), result.diagnoses};
  return data;
}

}  // namespace meshlode::lab
