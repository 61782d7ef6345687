// SPDX-License-Identifier: GPL-3.0-or-later
// `meshlode extract`: a cut of an asset as a GLB with the scene's nodes, names, instances, materials and textures.
// `--error T` is a distance in mesh units, of that mesh's diagonal with --relative, in world units with --world
// (docs/guides/export.md); `--triangles N` is a budget; `--lods`, `--lod-ratios` and `--lod-errors` write a discrete
// chain.
#include <charconv>
#include <cinttypes>
#include <cstdio>
#include <string>
#include <vector>

#include "app/export/export.h"
#include "app/report/read_meta.h"
#include "base/json_writer.h"
#include "base/printable.h"
#include "bulk.h"
#include "extract_cuts.h"
#include "extract_stuck.h"
#include "file_kind.h"
#include "options.h"
#include "promise_option.h"
#include "run/read/asset.h"
#include "streams.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct ExtractOptions {
  std::string promise = "position";
  std::optional<std::string> mesh;
  bool is_stuck = false;
  app::Packing packing;
  CutRequest request;
  std::string max_decoded_text = kDefaultMaxDecodedText;
  std::uint64_t max_decoded = 0;
  OutputOptions out;
};

Error usage(const char* option, const char* detail) {
  return Error{ErrorCode::kUsage, option, detail};
}

Status check_options(const ExtractOptions& o) {
  if (o.is_stuck) {
    if (o.request.has_way() || o.request.bounds.has_any() || o.mesh || o.packing.quantize || o.packing.meshopt)
      return usage("--stuck", "cannot be combined with a cut, a bound, --mesh, --quantize or --meshopt");
  } else if (auto status = check_request(o.request); !status) {
    return status.error();
  }
  return Ok{};
}

/// The meshes to export: all, or those of that name, or the one with that index; with each its parts.
Result<std::vector<bool>> choose_meshes(const run::Asset& asset, const std::optional<std::string>& wanted) {
  std::vector<bool> chosen(asset.meshes().size(), !wanted);
  if (!wanted) return chosen;
  const std::vector<std::size_t> origins =
      app::origins_of_meshes(app::read_meta(asset.meta_json()), asset.meshes().size());
  const auto add_parts = [&] {
    for (std::size_t m = 0; m < chosen.size(); ++m) chosen[m] = chosen[m] || chosen[origins[m]];
  };
  bool is_found = false;
  for (std::size_t m = 0; m < chosen.size(); ++m) {
    chosen[m] = asset.string(asset.meshes()[m].name) == *wanted;
    is_found = is_found || chosen[m];
  }
  add_parts();
  if (is_found) return chosen;
  std::size_t index = 0;
  const char* end = wanted->data() + wanted->size();
  const auto [stop, error] = std::from_chars(wanted->data(), end, index);
  if (error != std::errc{} || stop != end || index >= chosen.size()) {
    return usage("--mesh", "no mesh has this name or index");
  }
  chosen[index] = true;
  add_parts();
  return chosen;
}

bool is_below_level0(const run::Asset& asset, MeshId mesh, const CutLevel& level) {
  return level.asked && !level.cut.clusters.empty() && *level.asked < asset.meshes()[mesh.value].level0_deviation;
}

double relative_error(const run::Asset& asset, MeshId mesh, const CutLevel& level) {
  const double diagonal = asset.meshes()[mesh.value].diagonal;
  return diagonal > 0.0 ? level.cut.stored_error / diagonal : 0.0;
}

/// Null where the asset does not say.
void write_deviation(JsonWriter& w, const char* name, double deviation) {
  w.key(name);
  if (deviation >= double{format::kInfiniteError})
    w.null();
  else
    w.value(deviation);
}

void write_level(JsonWriter& w, const run::Asset& asset, MeshId mesh, const CutLevel& level) {
  w.field("clusters", level.cut.clusters.size());
  w.field("triangles", level.triangles);
  w.key("asked_error");
  if (level.asked)
    w.value(*level.asked);
  else
    w.null();
  w.field("stored_error", level.cut.stored_error);
  w.field("stored_error_relative", relative_error(asset, mesh, level));
  const run::CutAttributeDeviation attributes = run::attribute_deviation_of(run::tables_of(asset), level.cut.clusters);
  write_deviation(w, "stored_normal_deviation", attributes.normal_degrees);
  write_deviation(w, "stored_uv_deviation", attributes.uv);
  w.field("asked_below_level0_deviation", is_below_level0(asset, mesh, level));
}

std::string describe_json(const run::Asset& asset, const std::vector<MeshCuts>& cuts, bool is_chain,
                          std::size_t bytes) {
  JsonWriter w;
  std::uint64_t triangles = 0;
  w.begin_object();
  w.key("meshes");
  w.begin_array();
  for (const MeshCuts& mesh : cuts) {
    if (mesh.levels.empty()) continue;
    w.begin_object();
    w.field("mesh", mesh.mesh.value);
    w.field("name", asset.string(asset.meshes()[mesh.mesh.value].name));
    w.field("source_triangles", asset.meshes()[mesh.mesh.value].source_triangles);
    w.field("level0_deviation", asset.meshes()[mesh.mesh.value].level0_deviation);
    write_level(w, asset, mesh.mesh, mesh.levels.front());
    for (const CutLevel& level : mesh.levels) triangles += level.triangles;
    if (is_chain) {
      w.key("levels");
      w.begin_array();
      for (const CutLevel& level : mesh.levels) {
        w.begin_object();
        write_level(w, asset, mesh.mesh, level);
        w.field("screen_coverage", level.screen_coverage);
        w.end_object();
      }
      w.end_array();
    }
    w.end_object();
  }
  w.end_array();
  w.field("triangles", triangles);
  w.field("bytes", bytes);
  w.end_object();
  return w.text();
}

std::string describe_level(const run::Asset& asset, MeshId mesh, const CutLevel& level) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "%" PRIu64 " of %" PRIu64 " triangles, error %.6g units, %.6g of the diagonal",
                level.triangles, asset.meshes()[mesh.value].source_triangles, level.cut.stored_error,
                relative_error(asset, mesh, level));
  return numbers;
}

std::string describe_text(const run::Asset& asset, const std::vector<MeshCuts>& cuts, bool is_chain, std::size_t bytes,
                          const std::string& output) {
  std::string text;
  std::uint64_t triangles = 0;
  char numbers[160];
  for (const MeshCuts& mesh : cuts) {
    if (mesh.levels.empty()) continue;
    const format::MeshRecord& record = asset.meshes()[mesh.mesh.value];
    text += "mesh " + std::to_string(mesh.mesh.value) + " \"" + std::string(asset.string(record.name)) + '"';
    text += is_chain ? "\n" : ": ";
    for (std::size_t k = 0; k < mesh.levels.size(); ++k) {
      const CutLevel& level = mesh.levels[k];
      triangles += level.triangles;
      if (is_chain) text += "  level " + std::to_string(k) + ": ";
      text += describe_level(asset, mesh.mesh, level);
      if (is_chain) {
        std::snprintf(numbers, sizeof numbers, ", down to %.4g of the picture's height", level.screen_coverage);
        text += numbers;
      }
      text += '\n';
      if (is_below_level0(asset, mesh.mesh, level)) {
        std::snprintf(numbers, sizeof numbers,
                      "  the error asked for (%.6g) is below what level 0 itself deviates (%.6g, quantization)\n",
                      *level.asked, static_cast<double>(record.level0_deviation));
        text += numbers;
      }
    }
  }
  text += output + ": " + std::to_string(triangles) + " triangles, " + std::to_string(bytes) + " bytes\n";
  return text;
}

Result<std::vector<std::uint8_t>> export_cuts(const run::Asset& asset, const std::vector<MeshCuts>& cuts,
                                              app::Packing packing) {
  std::vector<app::LodChain> chains(cuts.size());
  for (std::size_t m = 0; m < cuts.size(); ++m) {
    for (const CutLevel& level : cuts[m].levels) {
      chains[m].cuts.push_back(level.cut.clusters);
      chains[m].screen_coverage.push_back(level.screen_coverage);
    }
  }
  return app::export_glb_lods(asset, chains, packing);
}

FileOutcome extract_file(const BulkInput& input, const ExtractOptions& o) {
  FileOutcome out;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return out;
  };
  const CutRequest& r = o.request;
  const auto opened = open_asset(input.path, o.max_decoded);
  if (!opened) return fail(opened.error());
  const auto asset = with_promise(*opened, o.promise);
  if (!asset) return fail(asset.error());
  if (o.is_stuck) return extract_stuck(*asset, input.output, o.out);
  auto chosen = choose_meshes(*asset, o.mesh);
  if (!chosen) return fail(chosen.error());
  const auto cuts = choose_cuts(r, *asset, *chosen);
  if (!cuts) return fail(cuts.error());
  auto glb = export_cuts(*asset, *cuts, o.packing);
  if (!glb) {
    Error error = glb.error();
    error.where = error.where.empty() ? input.path : input.path + ": " + error.where;
    return fail(std::move(error));
  }
  if (auto status = write_output(input.output, *glb); !status) return fail(status.error());
  std::uint64_t triangles = 0;
  for (const MeshCuts& mesh : *cuts) {
    for (const CutLevel& level : mesh.levels) triangles += level.triangles;
  }
  out.cells = {grouped_digits(triangles), grouped_digits(glb->size())};
  if (o.out.json()) {
    out.text = describe_json(*asset, *cuts, r.is_chain(), glb->size());
  } else if (!o.out.quiet) {
    // Beside what went to stdout.
    (input.output == kStream ? out.notes : out.text) =
        describe_text(*asset, *cuts, r.is_chain(), glb->size(), input.output);
  }
  return out;
}

int run_extract(const Verb& verb, std::span<char* const> args) {
  ExtractOptions o;
  CutRequest& r = o.request;
  BulkWords bulk;
  OptionParser parser(verb);
  add_bulk_inputs(parser, bulk, "FILE", kAssetsHelp,
                  "extract from the assets of this manifest of a build (default: none)");
  parser.group("Output");
  add_bulk_targets(parser, bulk, "GLB");
  add_output_options(parser, o.out);
  add_bulk_outputs(parser, bulk);
  parser.add_value("--mesh NAME|INDEX", o.mesh,
                   "export only this mesh; nodes of others stay, without a mesh (default: all meshes)");
  parser.add_flag("--quantize", o.packing.quantize,
                  "store positions, normals and texture coordinates as integers (KHR_mesh_quantization)");
  parser.add_flag("--meshopt", o.packing.meshopt, "compress vertices and triangles (EXT_meshopt_compression)");
  parser.group("Cut (one of these)");
  parser.add_value("--error E", r.error, "uniform cut: largest allowed error in mesh units (default: none)");
  parser.add_value("--triangles N", r.triangles,
                   "finest uniform cut with at most N triangles over all exported meshes (default: none)");
  parser.add_value("--level N", r.level, "one level of the DAG, 0 is the finest (default: none)");
  parser.add_value("--lods N", r.lods,
                   "MSFT_lod chain of N levels, each with half the triangles of the one before (default: none)");
  parser.add_value("--lod-ratios LIST", r.lod_ratios,
                   "MSFT_lod chain by shares of each mesh's triangles, such as 1,0.3,0.1 (default: none)");
  parser.add_value("--lod-errors LIST", r.lod_errors, "MSFT_lod chain by errors, such as 0,0.001,0.01 (default: none)");
  parser.add_flag("--stuck", o.is_stuck, "the groups that could not be simplified, coloured by reason");
  parser.group("What the cut is chosen by");
  parser.add_flag("--relative", r.is_relative, "errors are fractions of each mesh's diagonal");
  parser.add_flag("--world", r.is_world, "errors are in world units; the largest instance of a mesh decides");
  parser.add_value("--by", r.by, "stored error that --error is compared with", all_names(run::kCutErrorNames));
  add_promise_option(parser, o.promise);
  add_bounds_options(parser, r.bounds);
  parser.group("Camera");
  add_camera_options(parser, r.camera);
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  add_max_decoded_option(parser, o.max_decoded_text);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (auto status = check_options(o); !status) return print_error(status.error());
  const Result<std::uint64_t> max_decoded = parse_max_decoded(o.max_decoded_text);
  if (!max_decoded) return print_error(max_decoded.error());
  o.max_decoded = *max_decoded;
  return write_bulk(verb, bulk, {"GLB", ".glb"}, {{"triangles", 11}, {"bytes", 13}}, o.out,
                    [&](const BulkInput& input) { return extract_file(input, o); });
}

}  // namespace

const Verb kExtractVerb{"extract", "write a cut of an asset as a GLB",
                        "Writes the triangles of one cut, or a chain of discrete levels of detail, as a binary glTF "
                        "with the scene's nodes, names, instances, materials and textures. Of many files each is "
                        "written below the folder of -O.",
                        "meshlode extract scene.lode --error 0.001 --relative -o cut.glb\n"
                        "  meshlode extract out/ --triangles 20000 -O fallbacks\n"
                        "  meshlode extract scene.lode --triangles 20000 -o fallback.glb\n"
                        "  meshlode extract scene.lode --triangles 20000 --quantize --meshopt -o small.glb\n"
                        "  meshlode extract scene.lode --lods 4 -o levels.glb\n"
                        "  meshlode extract scene.lode --stuck -o stuck.glb",
                        run_extract};

}  // namespace meshlode::cli
