// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/tell/tell.h"
#include "app/batch/tell/write_warnings.h"
#include "base/json_writer.h"
#include "base/version.h"

namespace meshlode::app {

namespace {

void write_left_out(JsonWriter& w, const std::vector<scene::LeftOut>& items) {
  for (const scene::LeftOut& left : items) {
    w.begin_object();
    w.field("what", left.what);
    w.field("why", left.why);
    w.end_object();
  }
}

void write_times(JsonWriter& w, const JobResult& r) {
  w.key("stages");
  w.begin_array();
  for (const builder::StageTime& stage : r.stages) {
    w.begin_object();
    w.field("stage", stage.stage);
    w.field("seconds", stage.seconds);
    w.end_object();
  }
  w.end_array();
  w.key("levels");
  w.begin_array();
  for (const builder::LevelTime& level : r.levels) {
    w.begin_object();
    w.field("mesh", level.mesh);
    w.field("level", level.level);
    w.field("triangles", level.triangles);
    w.field("seconds", level.seconds);
    w.end_object();
  }
  w.end_array();
}

void write_build(JsonWriter& w, const JobResult& r) {
  w.begin_object();
  w.field("input", r.job.input.string());
  w.field("output", r.job.output.string());
  w.field("status", name_of(r.status));
  w.text_or_null_field("reason", r.reason);
  w.field("exit_code", r.exit_code);
  w.text_or_null_field("error", r.error);
  w.field("meshes", r.facts.meshes);
  w.field("meshes_from_cache", r.meshes_from_cache);
  w.field("instances", r.facts.instances);
  w.field("source_triangles", r.facts.triangles);
  w.field("file_bytes", r.facts.bytes);
  w.key("memory_estimate_bytes");
  if (r.memory_estimate > 0) {
    w.value(r.memory_estimate);
  } else {
    w.null();
  }
  w.field("seconds", r.seconds);
  w.key("triangles_per_second");
  if (r.seconds > 0.0 && r.status == JobStatus::kBuilt) {
    w.value(static_cast<double>(r.facts.triangles) / r.seconds);
  } else {
    w.null();
  }
  write_times(w, r);
  w.key("repaired");
  w.begin_object();
  for (const auto& [kind, count] : list_repairs(r.facts)) w.field(kind, count);
  w.end_object();
  write_warnings(w, r.warnings);
  w.key("left_out");
  w.begin_array();
  write_left_out(w, r.facts.left_out);
  write_left_out(w, r.facts.planned_out);
  w.end_array();
  w.end_object();
}

}  // namespace

std::string report_json(const std::vector<JobResult>& results, std::uint32_t jobs, int exit_code) {
  JsonWriter w;
  w.begin_object();
  w.field("generator", program_version());
  w.field("jobs", jobs);
  w.field("exit_code", exit_code);
  const CacheCounts cache = count_cache_use(results);
  w.key("cache");
  w.begin_object();
  w.field("hits", cache.hits);
  w.field("misses", cache.misses);
  w.field("meshes", cache.meshes);
  w.end_object();
  w.key("builds");
  w.begin_array();
  for (const JobResult& r : results) write_build(w, r);
  w.end_array();
  w.end_object();
  return w.text();
}

}  // namespace meshlode::app
