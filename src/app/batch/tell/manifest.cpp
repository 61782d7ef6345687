// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "app/batch/tell/tell.h"
#include "app/batch/tell/write_warnings.h"
#include "base/json_writer.h"
#include "base/version.h"

namespace meshlode::app {

namespace {

void write_settings(JsonWriter& w, std::string_view settings) {
  w.key("settings");
  w.begin_object();
  while (!settings.empty()) {
    const std::string_view line = settings.substr(0, settings.find('\n'));
    settings.remove_prefix(std::min(settings.size(), line.size() + 1));
    const std::size_t space = line.find(' ');
    if (space != std::string_view::npos) w.field(line.substr(0, space), line.substr(space + 1));
  }
  w.end_object();
}

void write_file(JsonWriter& w, const Dependency& file) {
  w.begin_object();
  w.field("kind", name_of(file.kind));
  w.field("path", file.path.empty() ? file.name : file.path.string());
  w.key("hash");
  if (file.stamp) {
    w.value(to_hex(file.hash));
  } else {
    w.null();
  }
  w.key("bytes");
  if (file.stamp) {
    w.value(file.stamp->bytes);
  } else {
    w.null();
  }
  w.end_object();
}

/// `position`: where the file is in the whole batch, of a shard's alone.
void write_result(JsonWriter& w, const JobResult& r, const std::uint64_t* position) {
  w.begin_object();
  if (position != nullptr) w.field("position", *position);
  w.field("input", r.job.input.string());
  w.field("output", r.job.output.string());
  w.field("status", name_of(r.status));
  w.field("exit_code", r.exit_code);
  w.key("error");
  if (r.error.empty()) {
    w.null();
  } else {
    w.value(r.error);
  }
  w.key("hash");
  if (r.has_asset()) {
    w.value(to_hex(r.asset_hash));
  } else {
    w.null();
  }
  w.field("bytes", r.has_asset() ? r.facts.bytes : 0);
  w.key("settings");
  if (r.settings) {
    write_effective(w, *r.settings);
  } else {
    w.null();
  }
  w.key("cache");
  w.begin_object();
  w.field("use", name_of(r.cache));
  w.text_or_null_field("reason", r.cache == CacheUse::kMiss ? r.reason : "");
  w.field("meshes", r.meshes_from_cache);
  w.end_object();
  w.field("seconds", r.seconds);
  w.field("processor_seconds", r.processor_seconds);
  w.key("peak_memory_bytes");
  if (r.peak_memory > 0) {
    w.value(r.peak_memory);
  } else {
    w.null();
  }
  write_warnings(w, r.warnings);
  w.key("files");
  w.begin_array();
  for (const Dependency& file : r.files) write_file(w, file);
  w.end_array();
  w.end_object();
}

void write_shard(JsonWriter& w, const ShardPlan& plan) {
  w.key("shard");
  w.begin_object();
  w.field("index", plan.shard.index);
  w.field("count", plan.shard.count);
  w.field("files", plan.batch_jobs);
  w.field("batch", to_hex(plan.batch));
  w.end_object();
}

}  // namespace

std::string manifest_json(const std::vector<JobResult>& results, const Hash128& program, const std::string& settings,
                          int exit_code, const ShardPlan* shard, bool is_complete, const Versions& versions) {
  assert(shard == nullptr || shard->positions.size() == results.size());
  JsonWriter w;
  w.begin_object();
  w.field("generator", program_version());
  w.field("version", kManifestVersion);
  w.field("program", to_hex(program));
  w.key("versions");
  w.begin_object();
  for (const auto& [name, version] : versions) w.field(name, version);
  w.end_object();
  write_settings(w, settings);
  w.field("exit_code", exit_code);
  w.field("complete", is_complete);
  if (shard != nullptr) write_shard(w, *shard);
  w.key("assets");
  w.begin_array();
  for (std::size_t i = 0; i < results.size(); ++i) {
    write_result(w, results[i], shard != nullptr ? &shard->positions[i] : nullptr);
  }
  w.end_array();
  w.end_object();
  return w.text();
}

}  // namespace meshlode::app
