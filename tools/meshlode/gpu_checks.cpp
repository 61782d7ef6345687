// SPDX-License-Identifier: GPL-3.0-or-later
#include "gpu_checks.h"
#include "base/try.h"

#include <cstdio>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/json_writer.h"
#include "judge/gpu/verify_gpu.h"
#include "judge/validate/rules.h"
#include "outputs.h"
#include "promise_option.h"

namespace meshlode::cli {

namespace {

/// Each judged camera with its numbers; pixels unless the name says otherwise.
std::string gpu_json(const GpuOptions& options, const judge::GpuVerifyReport& verified) {
  JsonWriter json;
  json.begin_object();
  json.field("device", verified.device.name);
  json.field("driver", verified.device.driver);
  json.field("promise", options.promise);
  json.field("pixel_error", options.pixel_error);
  json.field("largest_displacement_px", verified.largest_px);
  json.field("largest_share_of_allowed", verified.largest_share);
  json.key("checks");
  json.begin_array();
  for (const judge::GpuCheck& check : verified.checks) {
    json.begin_object();
    json.field("id", judge::info_of(check.rule).id);
    json.field("invariant", judge::info_of(check.rule).invariant);
    json.field("what", check.what);
    json.field("items", check.items);
    json.field("failures", check.failures);
    json.field("skipped", check.is_skipped);
    json.field("first", check.first);
    json.end_object();
  }
  json.end_array();
  json.key("cameras");
  json.begin_array();
  for (const judge::JudgedCamera& judged : verified.cameras) {
    const judge::PictureReport& p = judged.picture;
    json.begin_object();
    json.field("name", judged.camera.name);
    json.field("width", judged.camera.camera.width);
    json.field("height", judged.camera.camera.height);
    json.field("covered", p.covered);
    json.field("covered_source", p.covered_source);
    json.field("only_cut", p.only_cut);
    json.field("only_source", p.only_source);
    json.field("holes", p.holes);
    json.field("points", p.points);
    json.field("exceeded", p.exceeded);
    json.field("largest_displacement_px", p.largest_px);
    json.field("mean_displacement_px", p.mean_px);
    json.field("allowed_px", p.allowed_px);
    json.field("largest_share_of_allowed", p.largest_share);
    json.field("largest_relative_depth_difference", p.largest_depth);
    json.field("mean_normal_degrees", p.mean_normal_degrees);
    json.field("largest_normal_degrees", p.largest_normal_degrees);
    json.key("maps");
    json.begin_array();
    for (const std::string& map : judged.maps) json.value(map);
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return json.text();
}

void add_check(const judge::GpuCheck& check, const std::string& device, judge::VerifyReport& report) {
  const std::string invariant(judge::info_of(check.rule).invariant);
  report.checks.push_back({invariant, device + ": " + check.what, check.items, check.failures, check.is_skipped});
  if (check.failures == 0) return;
  report.findings.push_back(judge::make_finding(check.rule, device, check.first));
  ++report.finding_count;
}

}  // namespace

Status verify_with_gpu(const run::Asset& opened, const scene::Scene& source, const GpuOptions& options,
                       judge::VerifyReport& report) {
  TRY_LET(asset, with_promise(opened, options.promise));
  judge::GpuVerifyOptions judge;
  judge.device.device = options.device;
  judge.orbits = options.orbits;
  judge.pixel_error = options.pixel_error;
  judge.out_folder = options.out_folder;
  judge.files = &output_files();
  judge.max_decoded = options.max_decoded;
  if (!options.path.empty()) {
    TRY_LET(file, MappedFile::open(options.path));
    output_files().keep(file->id());
    const std::span<const std::uint8_t> bytes = file->bytes();
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    run::Camera base;
    auto path = judge::parse_camera_path(text, base);
    if (!path) return Error{path.error().code, options.path + ": " + path.error().where, path.error().detail};
    judge.path = std::move(*path);
  }
  const std::string report_path = options.out_folder + "/gpu.json";
  if (!options.out_folder.empty()) {
    if (const Status free = output_files().claim(report_path); !free) return free;
  }
  TRY_LET(verified, judge::verify_on_gpu(*asset, source, judge));
  if (options.is_explained) {
    std::fprintf(stderr, "passes of %s\n%s", verified->device.name.c_str(), verified->plan.c_str());
  }
  for (const std::string& warning : verified->warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
  if (!options.out_folder.empty()) {
    if (const Status written = write_text(report_path, gpu_json(options, *verified)); !written) return written;
  }
  for (const judge::GpuCheck& check : verified->checks) add_check(check, verified->device.name, report);
  return Ok{};
}

Status verify_streaming_with_gpu(const run::Asset& asset, const GpuOptions& options, judge::VerifyReport& report) {
  judge::StreamFrameOptions judge;
  judge.device.device = options.device;
  judge.frames = options.frames;
  judge.pixel_error = options.pixel_error;
  judge.max_decoded = options.max_decoded;
  TRY_LET(verified, judge::verify_streaming_on_gpu(asset, judge));
  add_check(verified->check, verified->device.name, report);
  return Ok{};
}

}  // namespace meshlode::cli
