// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stream/report.h"
#include "base/json_writer.h"
#include "builder/preset.h"

namespace meshlode::app {

namespace {

void put_error(JsonWriter& json, const char* key, const ErrorShown& error) {
  json.key(key);
  json.begin_object();
  json.field("max_px", error.max_px);
  json.field("p95_px", error.p95_px);
  json.field("p99_px", error.p99_px);
  json.field("share_over_asked", error.share_over_asked);
  json.field("share_over_fourfold", error.share_over_fourfold);
  json.end_object();
}

void put_recovery(JsonWriter& json, const char* key, const Recovery& recovery) {
  json.key(key);
  json.begin_object();
  json.field("jumps", recovery.jumps);
  json.field("not_reached", recovery.not_reached);
  json.field("mean_ms", recovery.mean_ms);
  json.field("max_ms", recovery.max_ms);
  json.end_object();
}

void put_demand(JsonWriter& json, const Demand& demand) {
  json.key("working_set");
  json.begin_object();
  json.field("mean_bytes", demand.mean_bytes);
  json.field("max_bytes", demand.max_bytes);
  json.field("mean_pages", demand.mean_pages);
  json.field("max_pages", demand.max_pages);
  json.field("path_bytes", demand.union_bytes);
  json.field("path_pages", demand.union_pages);
  json.end_object();
  json.field("drawn_share", demand.drawn_share);
  json.field("drawn_share_of_groups", demand.whole_group_share);
  json.key("roots");
  json.begin_object();
  json.field("bytes", demand.root_bytes);
  json.field("pages", demand.root_pages);
  json.field("reads", demand.root_reads);
  put_error(json, "error", demand.root_error);
  json.end_object();
}

void put_log(JsonWriter& json, const RunResult& run) {
  json.array_field("max_px", run.max_px);
  json.array_field("missing_pages", run.missing_pages);
  json.key("drawn_pages");
  json.begin_array();
  for (const std::vector<std::uint32_t>& pages : run.drawn_pages) {
    json.begin_array();
    for (const std::uint32_t page : pages) json.value(page);
    json.end_array();
  }
  json.end_array();
  json.key("requests");
  json.begin_array();
  for (const Transfer& transfer : run.log) {
    json.begin_object();
    json.field("page", transfer.page);
    json.field("sent_us", transfer.sent_us);
    json.field("arrival_us", transfer.arrival_us);
    if (!transfer.evicted.empty()) json.array_field("evicted", transfer.evicted);
    json.end_object();
  }
  json.end_array();
}

/// \param is_watched  the run has what the log and the checks say
void put_run(JsonWriter& json, const StreamReport& report, const RunSpec& spec, const RunResult& run, bool is_watched) {
  json.begin_object();
  json.optional_field("pool_bytes", spec.pool_bytes);
  json.field("megabytes_per_second", spec.link.megabytes_per_second);
  json.field("latency_ms", spec.link.latency_ms);
  json.field("fits", run.fits);
  if (run.fits) {
    json.key("load");
    json.begin_object();
    json.field("bytes", run.loaded_bytes);
    json.field("requests", run.requests);
    json.field("reloads", run.reloads);
    json.field("mean_megabytes_per_second", run.mean_megabytes);
    json.field("mean_requests_per_second", run.mean_requests);
    json.field("worst_second_bytes", run.worst_bytes);
    json.field("worst_second_requests", run.worst_requests);
    json.field("peak_pool_bytes", run.peak_pool_bytes);
    json.end_object();
    put_recovery(json, "until_asked", run.asked);
    put_recovery(json, "until_fourfold", run.fourfold);
    put_error(json, "error", run.error);
    if (report.has_log && is_watched) {
      json.key("log");
      json.begin_object();
      put_log(json, run);
      json.end_object();
    }
  }
  if (report.is_checked && is_watched) {
    json.field("checked_frames", run.checked_frames);
    json.field("finding_count", run.finding_count);
    json.array_field("findings", run.findings);
  }
  json.end_object();
}

void put_layouts(JsonWriter& json, const StreamReport& report) {
  json.key("layouts");
  json.begin_array();
  for (const TriedLayout& tried : report.layouts) {
    json.begin_object();
    json.field("page_size", tried.layout.page_kib);
    json.field("page_order", builder::name_of(tried.layout.order));
    if (tried.layout.root_bytes != 0) json.field("root_bytes", tried.layout.root_bytes);
    json.field("pages", tried.pages);
    put_demand(json, tried.demand);
    json.key("run");
    put_run(json, report, report.specs.front(), tried.run, false);
    json.end_object();
  }
  json.end_array();
}

void put_pages(JsonWriter& json, const StreamScene& scene) {
  json.key("pages");
  json.begin_array();
  for (const StreamPage& page : scene.pages) {
    json.begin_object();
    json.field("bytes", page.bytes);
    json.field("stored_bytes", page.stored_bytes);
    json.end_object();
  }
  json.end_array();
}

}  // namespace

std::string stream_json(const StreamReport& report) {
  JsonWriter json;
  json.begin_object();
  json.array_field("assets", report.assets);
  json.key("scene");
  json.begin_object();
  json.field("instances", report.scene.instances.size());
  json.field("meshes", report.scene.meshes.size());
  json.field("groups", report.scene.groups.size());
  json.field("pages", report.scene.pages.size());
  json.field("page_bytes", report.scene.page_bytes());
  json.field("stored_bytes", report.scene.stored_bytes());
  json.end_object();
  json.key("path");
  json.begin_object();
  json.field("name", report.path);
  json.field("frames", report.frames.size());
  json.field("frames_per_second", report.view.fps);
  std::uint32_t jumps = 0;
  for (const PathFrame& frame : report.frames) jumps += frame.is_jump ? 1 : 0;
  json.field("jumps", jumps);
  json.end_object();
  json.key("picture");
  json.begin_object();
  json.field("width", report.view.width);
  json.field("height", report.view.height);
  json.field("pixel_error", report.view.pixel_error);
  json.end_object();
  put_demand(json, report.simulation.demand);
  json.key("runs");
  json.begin_array();
  for (std::size_t i = 0; i < report.specs.size(); ++i)
    put_run(json, report, report.specs[i], report.simulation.runs[i], true);
  json.end_array();
  if (!report.layouts.empty()) put_layouts(json, report);
  if (report.has_log) put_pages(json, report.scene);
  if (report.is_checked) {
    json.field("finding_count", count_findings(report.simulation));
    json.array_field("findings", report.simulation.findings);
  }
  json.end_object();
  return json.text();
}

}  // namespace meshlode::app
