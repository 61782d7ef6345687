// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <string>

#include "base/file.h"
#include "gpu/verify_gpu.h"
#include "import/import.h"
#include "options.h"
#include "read/asset.h"
#include "report/json_writer.h"
#include "verb.h"
#include "verify/verify.h"

namespace meshlode::cli {

namespace {

std::string describe(const VerifyReport& report, bool quiet) {
  std::string text;
  for (const VerifyReport::Check& check : report.checks) {
    if (quiet && check.failures == 0) continue;
    char head[64];
    std::snprintf(head, sizeof head, "%-4s %-8s %12llu  ", check.invariant.empty() ? "-" : check.invariant.c_str(),
                  check.skipped         ? "skipped"
                  : check.failures == 0 ? "ok"
                                        : "FAILED",
                  static_cast<unsigned long long>(check.items));
    text += head + check.what;
    if (check.failures > 0) text += ": " + std::to_string(check.failures) + " failures";
    text += "\n";
  }
  for (const Finding& finding : report.findings) {
    text += finding.id + (finding.invariant.empty() ? "" : " (" + finding.invariant + ")") + ": " + finding.where +
            ": " + finding.detail + "\n";
  }
  if (report.finding_count > report.findings.size()) {
    text += "and " + std::to_string(report.finding_count - report.findings.size()) + " more findings\n";
  }
  if (!quiet)
    text += report.finding_count == 0 ? "verified: nothing found\n"
                                      : "NOT verified: " + std::to_string(report.finding_count) + " findings\n";
  return text;
}

std::string to_json(const std::string& path, const std::string& source, const VerifyOptions& options,
                    const VerifyReport& report) {
  JsonWriter json;
  json.begin_object();
  json.field("file", path);
  json.field("source", source);
  json.field("uniform_cuts", options.uniform_cuts);
  json.field("cameras", options.cameras);
  json.field("seed", options.seed);
  json.field("verified", report.finding_count == 0);
  json.field("finding_count", report.finding_count);
  json.key("checks");
  json.begin_array();
  for (const VerifyReport::Check& check : report.checks) {
    json.begin_object();
    json.field("invariant", check.invariant);
    json.field("what", check.what);
    json.field("items", check.items);
    json.field("failures", check.failures);
    json.field("skipped", check.skipped);
    json.end_object();
  }
  json.end_array();
  json.key("findings");
  json.begin_array();
  for (const Finding& finding : report.findings) {
    json.begin_object();
    json.field("id", finding.id);
    json.field("invariant", finding.invariant);
    json.field("where", finding.where);
    json.field("detail", finding.detail);
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return json.text();
}

struct GpuOptions {
  bool is_on = false;
  std::string device, path, out_folder;
  std::uint32_t orbits = 6;
  double pixel_error = 1.0;
};

Surface surface_of(const SourceMesh& mesh) {
  Surface surface;
  for (const Primitive& primitive : mesh.primitives) {
    const auto base = static_cast<std::uint32_t>(surface.positions.size());
    surface.positions.insert(surface.positions.end(), primitive.positions.begin(), primitive.positions.end());
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      surface.triangles.push_back(
          {base + primitive.indices[i], base + primitive.indices[i + 1], base + primitive.indices[i + 2]});
    }
  }
  return surface;
}

/// Each judged camera with its numbers; pixels unless the name says otherwise.
std::string gpu_json(const GpuOptions& options, const gpu::GpuVerifyReport& verified) {
  JsonWriter json;
  json.begin_object();
  json.field("device", verified.device.name);
  json.field("driver", verified.device.driver);
  json.field("pixel_error", options.pixel_error);
  json.field("largest_displacement_px", verified.largest_px);
  json.key("checks");
  json.begin_array();
  for (const gpu::GpuCheck& check : verified.checks) {
    json.begin_object();
    json.field("id", check.id);
    json.field("invariant", check.invariant);
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
  for (const gpu::JudgedCamera& judged : verified.cameras) {
    const gpu::PictureReport& p = judged.picture;
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

/// What the GPU finds, as checks and findings of the same report.
Status verify_with_gpu(const Asset& asset, const Scene& source, const GpuOptions& options, VerifyReport& report) {
  gpu::GpuVerifyOptions judge;
  judge.device.device = options.device;
  judge.orbits = options.orbits;
  judge.pixel_error = options.pixel_error;
  judge.out_folder = options.out_folder;
  if (!options.path.empty()) {
    const auto file = MappedFile::open(options.path);
    if (!file) return file.error();
    const std::span<const std::uint8_t> bytes = file->bytes();
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    Camera base;
    auto path = gpu::parse_camera_path(text, base);
    if (!path) return Error{path.error().code, options.path + ": " + path.error().where, path.error().detail};
    judge.path = std::move(*path);
  }
  std::vector<Surface> surfaces;
  for (const SourceMesh& mesh : source.meshes) surfaces.push_back(surface_of(mesh));
  const auto verified = gpu::verify_on_gpu(asset, surfaces, judge);
  if (!verified) return verified.error();
  if (!options.out_folder.empty()) {
    const std::string text = gpu_json(options, *verified);
    const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    if (const Status written = write_file_atomically(options.out_folder + "/gpu.json", bytes); !written) return written;
  }
  for (const gpu::GpuCheck& check : verified->checks) {
    report.checks.push_back({check.invariant, verified->device.name + ": " + check.what, check.items, check.failures,
                             check.is_skipped});
    if (check.failures == 0) continue;
    report.findings.push_back({check.id, check.invariant, verified->device.name, check.first});
    ++report.finding_count;
  }
  return Ok{};
}

/// Triangles that --repair dropped are found again by repairing the source in the same way.
bool was_repaired(const Asset& asset) {
  const auto meshes = asset.meshes();
  return std::any_of(meshes.begin(), meshes.end(), [](const format::MeshRecord& m) { return m.dropped_repaired > 0; });
}

int run_verify(const Verb& verb, std::span<char* const> args) {
  std::string path;
  std::string source_path;
  GpuOptions gpu_options;
  std::uint32_t jobs = 0;
  VerifyOptions options;
  OutputOptions output;
  OptionParser parser(verb);
  parser.add_positional("file", path, "a .lode asset");
  parser.add_value("--source", source_path, "the scene it was built from");
  parser.add_value("--cuts", options.uniform_cuts, "uniform cuts per mesh that cross-check the border proof");
  parser.add_value("--cameras", options.cameras, "random cameras that cross-check selection and hierarchy");
  parser.add_value("--deviation-cuts", options.deviation_cuts,
                   "uniform cuts per mesh that are measured against the source");
  parser.add_value("--seed", options.seed, "of the random cameras");
  parser.add_flag("--gpu", gpu_options.is_on, "let a Vulkan device decode, select and draw the same, and compare");
  parser.add_value("--device", gpu_options.device, "of --gpu: an index or a part of the name (the first that can)");
  parser.add_value("--orbits", gpu_options.orbits, "of --gpu: cameras around the scene, judged against the source");
  parser.add_value("--path", gpu_options.path, "of --gpu: a file of cameras, ex ey ez tx ty tz [fovy [near]] a line");
  parser.add_value("--out-dir", gpu_options.out_folder,
                   "of --gpu: an existing folder for heat maps of the worst cameras and a report, gpu.json");
  parser.add_value("--pixel-error", gpu_options.pixel_error, "of --gpu: allowed displacement in pixels (1)");
  add_jobs_option(parser, jobs);
  add_output_options(parser, output);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (source_path.empty())
    return print_error({ErrorCode::kUsage, "--source", "the scene to verify against is missing"});

  const JobLimit limit(jobs);
  const Result<Asset> asset = Asset::open(path);
  if (!asset) return print_error(asset.error());
  Result<Scene> source = import_scene(source_path, {.repair = was_repaired(*asset)});
  if (!source) return print_error(source.error());
  VerifyReport report = verify_asset(*asset, *source, options);
  if (gpu_options.is_on) {
    if (const Status judged = verify_with_gpu(*asset, *source, gpu_options, report); !judged) {
      return print_error(judged.error());
    }
  }
  if (!print_out(output.json() ? to_json(path, source_path, options, report) : describe(report, output.quiet))) {
    return static_cast<int>(ErrorCode::kIo);
  }
  return report.finding_count == 0 ? 0 : static_cast<int>(ErrorCode::kCheckFailed);
}

}  // namespace

const Verb kVerifyVerb{"verify", "prove an asset against the scene it was built from",
                       "meshlode verify scene.lode --source scene.glb\n"
                       "  meshlode verify scene.lode --source scene.glb --cuts 1000 --cameras 500 --seed 7\n"
                       "  meshlode verify scene.lode --source scene.glb --gpu --orbits 50",
                       run_verify};

}  // namespace meshlode::cli
