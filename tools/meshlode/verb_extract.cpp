// SPDX-License-Identifier: GPL-3.0-or-later
// `meshlode extract`: a cut of an asset as a GLB with the scene's nodes, names, instances, materials and textures.
// `--error T` is a distance in mesh units, of that mesh's diagonal with --relative, in world units with --world
// (design, section 4).
#include <algorithm>
#include <charconv>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"
#include "camera_options.h"
#include "export/choose_cuts.h"
#include "export/export.h"
#include "options.h"
#include "read/asset.h"
#include "report/json_writer.h"
#include "select/select.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct ExtractOptions {
  std::string input;
  std::optional<std::string> output;
  std::optional<double> error;
  std::optional<std::uint32_t> level;
  bool is_relative = false;
  bool is_world = false;
  std::string by = "selection";
  std::optional<std::string> mesh;
  CameraOptions camera;
  OutputOptions out;
};

/// What one mesh became.
struct MeshCut {
  MeshId mesh;
  UniformCut cut;
  std::optional<double> asked;  ///< mesh units; nothing for camera and level cuts
  std::uint64_t triangles = 0;
};

Error usage(const char* option, const char* detail) {
  return Error{ErrorCode::kUsage, option, detail};
}

Status check_options(const ExtractOptions& o) {
  if (!o.output) return usage("-o", "say where the GLB goes");
  const bool has_camera = o.camera.camera || o.camera.ortho_height;
  const int ways = (o.error ? 1 : 0) + (o.level ? 1 : 0) + (has_camera ? 1 : 0);
  if (ways != 1) return usage("--error", "give one of --error, --level and a camera");
  if (o.error && (!(*o.error >= 0.0) || !std::isfinite(*o.error))) return usage("--error", "give a number, 0 or more");
  if (o.is_relative && o.is_world) return usage("--relative", "not together with --world");
  if (!o.error && (o.is_relative || o.is_world || o.by != "selection")) {
    return usage("--relative", "--relative, --world and --by belong to --error");
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(o.input, *o.output, ignored)) return usage("-o", "is the input itself");
  return Ok{};
}

/// The meshes to export: all, or those of that name, or the one with that index.
Result<std::vector<bool>> choose_meshes(const Asset& asset, const std::optional<std::string>& wanted) {
  std::vector<bool> chosen(asset.meshes().size(), !wanted);
  if (!wanted) return chosen;
  bool is_found = false;
  for (std::size_t m = 0; m < chosen.size(); ++m) {
    chosen[m] = asset.string(asset.meshes()[m].name) == *wanted;
    is_found = is_found || chosen[m];
  }
  if (is_found) return chosen;
  std::size_t index = 0;
  const char* end = wanted->data() + wanted->size();
  const auto [stop, error] = std::from_chars(wanted->data(), end, index);
  if (error != std::errc{} || stop != end || index >= chosen.size()) {
    return usage("--mesh", "no mesh has this name or index");
  }
  chosen[index] = true;
  return chosen;
}

/// `--error` in the units of one mesh. Several instances: the largest asks for the smallest error.
double error_in_mesh_units(const ExtractOptions& o, const Asset& asset, std::size_t mesh) {
  if (o.is_relative) return *o.error * asset.meshes()[mesh].diagonal;
  if (!o.is_world) return *o.error;
  double scale = 0.0;
  for (const format::InstanceRecord& instance : asset.instances()) {
    if (instance.mesh == mesh && (instance.flags & format::kInstanceSingular) == 0) {
      scale = std::max(scale, instance.scale);
    }
  }
  return scale > 0.0 ? *o.error / scale : *o.error;
}

std::vector<MeshCut> choose_cuts(const ExtractOptions& o, const Asset& asset, const std::vector<bool>& chosen,
                                 const Camera& camera) {
  std::vector<UniformCut> by_camera;
  if (!o.error && !o.level) by_camera = choose_camera_cuts(asset, camera, o.camera.pixel_error);
  std::vector<MeshCut> cuts(asset.meshes().size());
  for (std::size_t m = 0; m < cuts.size(); ++m) {
    cuts[m].mesh = MeshId(m);
    if (!chosen[m]) continue;
    if (o.error) {
      const CutError by = o.by == "quadric" ? CutError::kQuadric : CutError::kSelection;
      cuts[m].asked = error_in_mesh_units(o, asset, m);
      cuts[m].cut = select_uniform(asset, MeshId(m), *cuts[m].asked, by);
    } else if (o.level) {
      cuts[m].cut = choose_level_cut(asset, MeshId(m), *o.level);
    } else {
      cuts[m].cut = std::move(by_camera[m]);
    }
    for (const ClusterId c : cuts[m].cut.clusters) cuts[m].triangles += asset.clusters()[c.value].triangle_count;
  }
  return cuts;
}

bool is_below_level0(const Asset& asset, const MeshCut& cut) {
  return cut.asked && !cut.cut.clusters.empty() && *cut.asked < asset.meshes()[cut.mesh.value].level0_deviation;
}

double relative_error(const Asset& asset, const MeshCut& cut) {
  const double diagonal = asset.meshes()[cut.mesh.value].diagonal;
  return diagonal > 0.0 ? cut.cut.stored_error / diagonal : 0.0;
}

std::string describe_json(const Asset& asset, const std::vector<MeshCut>& cuts, const std::vector<bool>& chosen,
                          std::size_t bytes) {
  JsonWriter w;
  std::uint64_t triangles = 0;
  w.begin_object();
  w.key("meshes");
  w.begin_array();
  for (const MeshCut& cut : cuts) {
    if (!chosen[cut.mesh.value]) continue;
    triangles += cut.triangles;
    w.begin_object();
    w.field("mesh", cut.mesh.value);
    w.field("name", asset.string(asset.meshes()[cut.mesh.value].name));
    w.field("clusters", cut.cut.clusters.size());
    w.field("triangles", cut.triangles);
    w.field("source_triangles", asset.meshes()[cut.mesh.value].source_triangles);
    w.key("asked_error");
    if (cut.asked)
      w.value(*cut.asked);
    else
      w.null();
    w.field("stored_error", cut.cut.stored_error);
    w.field("stored_error_relative", relative_error(asset, cut));
    w.field("level0_deviation", asset.meshes()[cut.mesh.value].level0_deviation);
    w.field("asked_below_level0_deviation", is_below_level0(asset, cut));
    w.end_object();
  }
  w.end_array();
  w.field("triangles", triangles);
  w.field("bytes", bytes);
  w.end_object();
  return w.text();
}

std::string describe_text(const Asset& asset, const std::vector<MeshCut>& cuts, const std::vector<bool>& chosen,
                          std::size_t bytes, const std::string& output) {
  std::string text;
  std::uint64_t triangles = 0;
  char numbers[160];
  for (const MeshCut& cut : cuts) {
    const format::MeshRecord& mesh = asset.meshes()[cut.mesh.value];
    if (!chosen[cut.mesh.value]) continue;
    triangles += cut.triangles;
    std::snprintf(numbers, sizeof numbers,
                  ": %" PRIu64 " of %" PRIu64 " triangles, error %.6g units, %.6g of the diagonal\n", cut.triangles,
                  mesh.source_triangles, cut.cut.stored_error, relative_error(asset, cut));
    text += "mesh " + std::to_string(cut.mesh.value) + " \"" + std::string(asset.string(mesh.name)) + '"' + numbers;
    if (is_below_level0(asset, cut)) {
      std::snprintf(numbers, sizeof numbers,
                    "  the error asked for (%.6g) is below what level 0 itself deviates (%.6g, quantization)\n",
                    *cut.asked, static_cast<double>(mesh.level0_deviation));
      text += numbers;
    }
  }
  text += output + ": " + std::to_string(triangles) + " triangles, " + std::to_string(bytes) + " bytes\n";
  return text;
}

int run_extract(const Verb& verb, std::span<char* const> args) {
  ExtractOptions o;
  OptionParser parser(verb);
  parser.add_positional("FILE", o.input, "a .lode asset");
  parser.add_value("-o,--output", o.output, "the GLB to write");
  parser.add_value("--error", o.error, "uniform cut: the largest error allowed, in mesh units");
  parser.add_flag("--relative", o.is_relative, "--error is a fraction of each mesh's own diagonal");
  parser.add_flag("--world", o.is_world, "--error is in world units: the largest instance of a mesh decides");
  parser.add_value("--by", o.by, "the stored number that --error is compared with (selection)",
                   {"selection", "quadric"});
  parser.add_value("--level", o.level, "cut at one level of the DAG, 0 the finest");
  parser.add_value("--mesh", o.mesh, "this mesh only, by name or index; the nodes of others stay, without a mesh");
  add_camera_options(parser, o.camera);
  add_output_options(parser, o.out);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (auto status = check_options(o); !status) return print_error(status.error());

  auto asset = Asset::open(o.input);
  if (!asset) return print_error(asset.error());
  auto chosen = choose_meshes(*asset, o.mesh);
  if (!chosen) return print_error(chosen.error());
  auto camera = make_camera(o.camera, *asset);
  if (!camera) return print_error(camera.error());

  const std::vector<MeshCut> cuts = choose_cuts(o, *asset, *chosen, *camera);
  std::vector<std::vector<ClusterId>> clusters;
  clusters.reserve(cuts.size());
  for (const MeshCut& cut : cuts) clusters.push_back(cut.cut.clusters);
  auto glb = export_glb(*asset, clusters);
  if (!glb) {
    Error error = glb.error();
    error.where = error.where.empty() ? o.input : o.input + ": " + error.where;
    return print_error(error);
  }
  if (auto status = write_file_atomically(*o.output, *glb); !status) return print_error(status.error());
  if (o.out.json()) {
    if (!print_out(describe_json(*asset, cuts, *chosen, glb->size()))) return static_cast<int>(ErrorCode::kIo);
  } else if (!o.out.quiet) {
    if (!print_out(describe_text(*asset, cuts, *chosen, glb->size(), *o.output))) {
      return static_cast<int>(ErrorCode::kIo);
    }
  }
  return 0;
}

}  // namespace

const Verb kExtractVerb{"extract", "write a cut of an asset as a GLB",
                        "meshlode extract scene.lode --error 0.001 --relative -o cut.glb", run_extract};

}  // namespace meshlode::cli
