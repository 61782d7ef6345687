// SPDX-License-Identifier: GPL-3.0-or-later
// render: a cut as a picture, by the reference rasterizer or a Vulkan device.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <utility>

#include "base/byte_size.h"
#include "base/json_writer.h"
#include "base/printable.h"
#include "base/try.h"
#include "bounds_options.h"
#include "bulk.h"
#include "camera_options.h"
#include "compare_folder.h"
#include "draw/gpu/render.h"
#include "draw/gpu/shaders/frame.h"
#include "draw/raster/legend.h"
#include "draw/raster/raster.h"
#include "explain.h"
#include "file_kind.h"
#include "options.h"
#include "promise_option.h"
#include "streams.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct RenderOptions {
  std::string view = "shaded", promise = "position";
  CameraOptions camera;
  BoundsOptions bounds;
  std::optional<double> error;
  bool is_relative = false;
  bool gpu = false, explain = false;
  bool is_strict = false;  ///< a warning is an error
  std::string device, force;
  std::string max_decoded_text = kDefaultMaxDecodedText;
  std::uint64_t max_decoded = 0;
  OutputOptions report;
};

struct RenderStats {
  std::uint64_t clusters = 0, triangles = 0, covered_pixels = 0, visible_clusters = 0;
  std::uint32_t finest_level = 0, coarsest_level = 0;
  std::vector<std::uint64_t> triangles_of_level;
};

/// By their VIEW_… numbers; the CPU has the first four.
const std::string kGpuViews[] = {"shaded", "clusters", "triangles", "levels",  "normals",
                                 "pages",  "overdraw", "paths",     "occluded"};

static_assert(static_cast<int>(draw::View::kLevels) == VIEW_LEVELS && VIEW_LEVELS + 1 == VIEW_NORMALS);

std::uint32_t view_number(const std::string& name) {
  return static_cast<std::uint32_t>(std::find(std::begin(kGpuViews), std::end(kGpuViews), name) -
                                    std::begin(kGpuViews));
}

Error too_many_clusters(const run::Asset& asset) {
  return {ErrorCode::kUnsupported, "cut",
          "the clusters of all instances take more than " + byte_size_text(asset.max_decoded_bytes()) +
              ", the larger of --max-decoded and 64 times the file"};
}

std::size_t max_clusters(const run::Asset& asset) {
  return asset.max_decoded_bytes() / sizeof(run::ClusterInstance);
}

/// The same cut of a mesh in each of its instances.
Result<std::vector<run::ClusterInstance>> uniform_cut(const run::Asset& asset, double error, bool is_relative,
                                                      const run::AttributeBounds& bounds) {
  std::vector<run::ClusterInstance> cut;
  std::map<std::uint32_t, run::UniformCut> cut_of_mesh;
  for (std::size_t i = 0; i < asset.instances().size(); ++i) {
    const format::InstanceRecord& instance = asset.instances()[i];
    if ((instance.flags & format::kInstanceSingular) != 0) continue;
    const double diagonal = asset.meshes()[instance.mesh].diagonal;
    const auto [found, is_new] = cut_of_mesh.try_emplace(instance.mesh);
    if (is_new) {
      found->second = run::select_uniform(asset, MeshId(instance.mesh), is_relative ? error * diagonal : error,
                                          run::CutError::kSelection, bounds);
    }
    if (found->second.clusters.size() > max_clusters(asset) - cut.size()) return too_many_clusters(asset);
    for (const ClusterId cluster : found->second.clusters) cut.push_back({InstanceId(i), cluster});
  }
  return cut;
}

RenderStats measure(const run::Asset& asset, const std::vector<run::ClusterInstance>& cut,
                    const draw::VisibilityBuffer& visibility) {
  RenderStats stats;
  stats.clusters = cut.size();
  for (const run::ClusterInstance& entry : cut) {
    const format::ClusterRecord& cluster = asset.clusters()[entry.cluster.value];
    stats.triangles += cluster.triangle_count();
    if (stats.triangles_of_level.size() <= cluster.level) stats.triangles_of_level.resize(cluster.level + 1u, 0);
    stats.triangles_of_level[cluster.level] += cluster.triangle_count();
  }
  const auto is_used = [](std::uint64_t count) { return count != 0; };
  const auto finest = std::ranges::find_if(stats.triangles_of_level, is_used);
  if (finest != stats.triangles_of_level.end()) {
    stats.finest_level = static_cast<std::uint32_t>(finest - stats.triangles_of_level.begin());
    stats.coarsest_level = static_cast<std::uint32_t>(stats.triangles_of_level.size() - 1);
  }
  std::vector<std::uint8_t> is_visible(cut.size(), 0);
  for (const std::uint32_t item : visibility.item) {
    if (item == draw::VisibilityBuffer::kNothing) continue;
    ++stats.covered_pixels;
    is_visible[item] = 1;
  }
  stats.visible_clusters = static_cast<std::uint64_t>(std::ranges::count(is_visible, 1));
  return stats;
}

std::string stats_json(const std::string& output, const RenderOptions& options, const run::Camera& camera,
                       const RenderStats& stats) {
  JsonWriter json;
  json.begin_object();
  json.field("output", std::filesystem::path(output).filename().string());
  json.field("view", options.view);
  json.field("width", camera.width);
  json.field("height", camera.height);
  if (options.error) {
    json.field("error", *options.error);
    json.field("relative", options.is_relative);
  } else {
    json.field("pixel_error", options.camera.pixel_error);
  }
  json.key("camera");
  json.begin_object();
  for (const auto& [name, point] : {std::pair{"eye", camera.eye}, std::pair{"target", camera.target}}) {
    json.key(name);
    json.begin_array();
    for (int k = 0; k < 3; ++k) json.value(point[k]);
    json.end_array();
  }
  if (camera.is_orthographic) {
    json.field("ortho_height", camera.ortho_height);
  } else {
    json.field("fovy", camera.fovy);
  }
  json.field("near", camera.near_distance);
  json.end_object();
  json.field("clusters", stats.clusters);
  json.field("triangles", stats.triangles);
  json.field("visible_clusters", stats.visible_clusters);
  json.field("covered_pixels", stats.covered_pixels);
  json.key("levels");
  json.begin_array();
  for (std::size_t level = 0; level < stats.triangles_of_level.size(); ++level) {
    if (stats.triangles_of_level[level] == 0) continue;
    json.begin_object();
    json.field("level", level);
    json.field("triangles", stats.triangles_of_level[level]);
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return json.text();
}

std::string stats_text(const std::string& output, const run::Camera& camera, const RenderStats& stats) {
  char line[256];
  const double pixels = static_cast<double>(camera.width) * camera.height;
  std::snprintf(
      line, sizeof line,
      ": %ux%u, %llu triangles in %llu clusters, levels %u to %u, %llu clusters seen, %.1f%% of the picture covered\n",
      camera.width, camera.height, static_cast<unsigned long long>(stats.triangles),
      static_cast<unsigned long long>(stats.clusters), stats.finest_level, stats.coarsest_level,
      static_cast<unsigned long long>(stats.visible_clusters),
      100.0 * static_cast<double>(stats.covered_pixels) / pixels);
  return output + line;
}

struct Drawn {
  std::vector<run::ClusterInstance> cut;
  draw::VisibilityBuffer visibility;
  draw::Image image;
};

/// What is drawn of one asset, and what is said of it on stderr.
struct RenderJob {
  const std::string& input;
  const run::Asset& asset;
  const run::Camera& camera;
  const RenderOptions& options;
  const run::AttributeBounds& bounds;
  std::string& notes;
};

/// Errors: `damage`; with --strict kUnsupported, where there is a warning: the picture would not be what the asset
/// describes.
Status note_warnings(const std::vector<std::string>& warnings, const Status& damage, const RenderJob& job) {
  for (const std::string& warning : warnings) job.notes += "warning: " + warning + "\n";
  if (!damage) return damage;
  if (warnings.empty() || !job.options.is_strict) return Ok{};
  return Error{ErrorCode::kUnsupported, job.input, "--strict: not all images can be drawn"};
}

/// By the device; what it says of its passes and of images is printed also where no picture came of it.
Result<Drawn> draw_on_gpu(const RenderJob& job, draw::ImageBudget& images) {
  const RenderOptions& options = job.options;
  draw::GpuRenderOptions render;
  render.device = options.device;
  render.view = view_number(options.view);
  render.pixel_error = options.camera.pixel_error;
  render.bounds = job.bounds;
  if (!options.force.empty()) render.force.push_back(options.force);
  draw::GpuPicture picture;
  // One at a time: files that share a device would share its memory.
  static std::mutex device;
  const std::lock_guard lock(device);
  const Status drawn = draw::render_on_gpu(job.asset, job.camera, render, images, picture);
  const Status complete = note_warnings(picture.warnings, drawn, job);
  if (options.explain) job.notes += "passes of " + picture.device + "\n" + picture.plan;
  if (!complete) return complete.error();
  return Drawn{std::move(picture.cut), std::move(picture.visibility), std::move(picture.image)};
}

Result<Drawn> draw_on_cpu(const RenderJob& job, draw::ImageBudget& images) {
  const auto& [input, asset, camera, options, bounds, notes] = job;
  std::vector<run::ClusterInstance> cut;
  if (options.error) {
    TRY_LET(uniform, uniform_cut(asset, *options.error, options.is_relative, bounds));
    cut = std::move(*uniform);
  } else {
    auto seen =
        run::select_bvh_within(run::tables_of(asset), camera, options.camera.pixel_error, max_clusters(asset), bounds);
    if (!seen) return too_many_clusters(asset);
    cut = std::move(*seen);
  }
  const std::vector<draw::MaterialTextures> materials = draw::read_material_textures(asset);
  const draw::AlphaMasks masks = draw::load_alpha_masks(asset, materials, images);
  TRY(note_warnings(masks.warnings, masks.damage, job));
  const auto view = static_cast<draw::View>(view_number(options.view));
  if (options.explain) notes += describe_cpu_passes(asset, masks, view);
  TRY_LET(visibility, draw::draw_cut(asset, cut, camera, masks));
  draw::TextureSet textures;
  if (view == draw::View::kShaded) textures = draw::load_textures(asset, materials, images);
  TRY(note_warnings(textures.warnings, textures.damage, job));
  TRY_LET(image, draw::shade_view(asset, cut, camera, *visibility, view, textures));
  return Drawn{std::move(cut), std::move(*visibility), std::move(*image)};
}

FileOutcome render_file(const BulkInput& input, const RenderOptions& options) {
  FileOutcome out;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return out;
  };
  const Result<run::Asset> opened = open_asset(input.path, options.max_decoded);
  if (!opened) return fail(opened.error());
  const Result<run::Asset> asset = with_promise(*opened, options.promise);
  if (!asset) return fail(asset.error());
  const Result<run::Camera> camera = make_camera(options.camera, *asset);
  if (!camera) return fail(camera.error());
  const Result<run::AttributeBounds> bounds = make_bounds(options.bounds, *asset);
  if (!bounds) return fail(bounds.error());
  if (options.explain) out.notes += describe_recorded_plan(*asset);
  draw::ImageBudget images(options.max_decoded);
  const RenderJob job{input.path, *asset, *camera, options, *bounds, out.notes};
  const Result<Drawn> drawn = options.gpu ? draw_on_gpu(job, images) : draw_on_cpu(job, images);
  if (!drawn) {
    Error error = drawn.error();
    if (error.code == ErrorCode::kInvalid) error.where = input.path + (error.where.empty() ? "" : ": ") + error.where;
    return fail(std::move(error));
  }
  if (const Status written = write_png(input.output, drawn->image); !written) return fail(written.error());
  const RenderStats stats = measure(*asset, drawn->cut, drawn->visibility);
  out.cells = {grouped_digits(stats.triangles), grouped_digits(stats.clusters)};
  if (options.report.json()) {
    out.text = stats_json(input.output, options, *camera, stats);
  } else if (!options.report.quiet) {
    std::string& said = input.output == kStream ? out.notes : out.text;
    said += stats_text(input.output, *camera, stats);
    if (options.view == "levels") {
      said +=
          "colours: blue is level 0, the finest, red the coarsest; their numbers are in the lower left corner, where "
          "there is room\n";
    }
  }
  return out;
}

int run_render(const Verb& verb, std::span<char* const> args) {
  RenderOptions options;
  BulkWords bulk;
  OptionParser parser(verb);
  add_bulk_inputs(parser, bulk, "FILE", kAssetsHelp, "draw the assets of this manifest of a build (default: none)");
  parser.group("Output");
  add_bulk_targets(parser, bulk, "PNG");
  parser.add_value("--view", options.view, "what the colours show; those after levels need --gpu",
                   {std::begin(kGpuViews), std::end(kGpuViews)});
  add_output_options(parser, options.report);
  add_bulk_outputs(parser, bulk);
  parser.add_flag("-v,--explain", options.explain, "print what the asset keeps and which passes run, and why");
  parser.add_flag("--strict", options.is_strict, "fail and write nothing if an image cannot be drawn");
  parser.group("Camera");
  add_camera_options(parser, options.camera);
  parser.group("Cut");
  parser.add_value("--error E", options.error,
                   "draw the uniform cut at this error in mesh units, 0 or more (default: by --pixel-error)");
  parser.add_flag("--relative", options.is_relative, "--error is a fraction of each mesh's diagonal");
  add_promise_option(parser, options.promise);
  add_bounds_options(parser, options.bounds);
  parser.group("GPU");
  parser.add_flag("--gpu", options.gpu, "select and draw on a Vulkan device");
  add_device_option(parser, options.device);
  parser.add_value("--force", options.force, "run a pass that the scene does not need (default: none)",
                   {"double-sided", "alpha-mask", "occlusion", "hardware", "textures", "all"});
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  add_max_decoded_option(parser, options.max_decoded_text);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (options.error && !(*options.error >= 0.0 && std::isfinite(*options.error))) {
    return print_error({ErrorCode::kUsage, "--error", "give an error of 0 or more"});
  }
  if (options.is_relative && !options.error) return print_error({ErrorCode::kUsage, "--relative", "needs --error"});

  if (options.gpu && options.error) {
    return print_error({ErrorCode::kUnsupported, "--gpu", "selects by a camera, not by --error"});
  }
  if (!options.gpu && view_number(options.view) >= VIEW_NORMALS) {
    return print_error({ErrorCode::kUsage, "--view", options.view + " needs --gpu"});
  }

  const Result<std::uint64_t> max_decoded = parse_max_decoded(options.max_decoded_text);
  if (!max_decoded) return print_error(max_decoded.error());
  options.max_decoded = *max_decoded;
  return write_bulk(verb, bulk, {"PNG", ".png"}, {{"triangles", 11}, {"clusters", 9}}, options.report,
                    [&](const BulkInput& input) { return render_file(input, options); });
}

}  // namespace

const Verb kRenderVerb{
    "render", "draw a cut as a PNG: shaded, or coloured by cluster, triangle or level",
    "Selects the clusters for a camera and an allowed error on the screen, or the uniform cut at one error, and draws "
    "them with the reference rasterizer of the CPU or, with --gpu, on a Vulkan device. Both draw the same pixels. Of "
    "many files each is "
    "drawn below the folder of -O.",
    "meshlode render scene.lode -o scene.png --pixel-error 2 --view clusters\n"
    "  meshlode render out/ -O thumbnails --size 320x180\n"
    "  meshlode render scene.lode -o coarse.png --error 0.01 --relative --size 640x480",
    run_render};

}  // namespace meshlode::cli
