// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/gpu/verify_gpu.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <tuple>
#include <utility>

#include "base/file.h"
#include "base/try.h"
#include "draw/gpu/pass_plan.h"
#include "judge/gpu/compare_frame.h"
#include "judge/gpu/judge_picture.h"
#include "judge/metrics/coverage.h"
#include "judge/verify/source_parts.h"

namespace meshlode::judge {

namespace {

void add(GpuCheck& check, const Comparison& comparison, const std::string& where) {
  check.items += comparison.items;
  check.failures += comparison.differences;
  if (comparison.differences > 0 && check.first.empty()) check.first = where + ": " + comparison.first;
}

std::string format_px(const char* text, double value) {
  char out[64];
  std::snprintf(out, sizeof out, text, value);
  return out;
}

PictureReport without_maps(const PictureReport& picture) {
  PictureReport out = picture;
  out.displacement_px.clear();
  out.depth_difference.clear();
  out.normal_degrees.clear();
  return out;
}

Status write_maps(const GpuVerifyOptions& options, const PictureReport& picture, JudgedCamera& judged) {
  if (options.out_folder.empty()) return Ok{};
  OutputFiles own;
  OutputFiles& files = options.files != nullptr ? *options.files : own;
  const run::Camera& camera = judged.camera.camera;
  std::string name = judged.camera.name;
  std::replace(name.begin(), name.end(), ' ', '-');
  name += "-" + std::to_string(camera.width) + "x" + std::to_string(camera.height) + ".png";
  const struct {
    const char* kind;
    const std::vector<float>& values;
    double full;
  } maps[] = {{"displacement-", picture.displacement_px, options.pixel_error},
              {"depth-", picture.depth_difference, 0.01},
              {"normal-", picture.normal_degrees, 30.0}};
  for (const auto& map : maps) {
    const draw::Image image = heat_map(map.values, camera.width, camera.height, static_cast<float>(map.full));
    if (const Status s = files.write(options.out_folder + "/" + map.kind + name, draw::encode_png(image)); !s) return s;
    judged.maps.push_back(map.kind + name);
  }
  return Ok{};
}

/// Every cluster by the hardware, from the adversarial cameras and those of the path. A frame that is too far from the
/// CPU's is one failure.
Status judge_hardware(draw::Device& device, const draw::GpuScene& scene, const run::Asset& asset,
                      const GpuVerifyOptions& options, bool by_mesh_shaders, GpuCheck& check) {
  check.is_skipped = by_mesh_shaders && !device.info().has_mesh_shaders;
  if (check.is_skipped) {
    check.what += " (not judged: the device has none)";
    return Ok{};
  }
  draw::RendererOptions raster;
  raster.width = options.sizes[0].width;
  raster.height = options.sizes[0].height;
  raster.frustum = false;
  raster.double_sided = scene.has_double_sided;
  raster.alpha_mask = scene.has_alpha_mask;
  raster.hardware = by_mesh_shaders ? draw::HardwarePath::kMesh : draw::HardwarePath::kVertex;
  raster.hardware_pixels = 0.0F;
  TRY_LET(renderer, draw::Renderer::make(device, scene, raster));
  std::vector<NamedCamera> cameras = adversarial_cameras(asset, raster.width, raster.height);
  for (NamedCamera named : options.path) {
    named.camera.width = raster.width;
    named.camera.height = raster.height;
    cameras.push_back(named);
  }
  std::uint64_t most_differing = 0, most_astray = 0;
  for (const NamedCamera& named : cameras) {
    TRY_LET(result, compare_hardware(*renderer, asset, named.camera, options.pixel_error));
    const PictureDistance& picture = result->picture;
    check.items += picture.covered;
    most_differing = std::max(most_differing, picture.differing);
    most_astray = std::max(most_astray, picture.astray);
    if (result->is_same_cut && picture.is_within_bounds()) continue;
    if (check.failures++ > 0) continue;
    check.first = named.name + ": " + (result->is_same_cut ? describe(picture) : "another cut");
  }
  check.what += ": " + std::to_string(most_differing) + " pixels of a frame differ from the CPU's at most, " +
                std::to_string(most_astray) + " by more than a pixel";
  return Ok{};
}

/// Every edge, by the positions of its ends, is used as often one way as the other.
bool is_closed(const Surface& surface) {
  std::vector<std::uint32_t> order(surface.positions.size()), id(surface.positions.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto key = [&](std::uint32_t i) {
    const Vec3d& p = surface.positions[i];
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    id[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? id[order[i - 1]] : static_cast<std::uint32_t>(i);
  }
  std::vector<std::tuple<std::uint32_t, std::uint32_t, int>> edges;
  for (const auto& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = id[t[k]], b = id[t[(k + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b), a < b ? 1 : -1);
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    int sum = 0;
    std::size_t end = i;
    for (; end < edges.size() && std::get<0>(edges[end]) == std::get<0>(edges[i]) &&
           std::get<1>(edges[end]) == std::get<1>(edges[i]);
         ++end) {
      sum += std::get<2>(edges[end]);
    }
    if (sum != 0) return false;
    i = end;
  }
  return !edges.empty();
}

/// Which promises the asset makes, so that pictures can be held to them.
struct Promise {
  format::Promise kind = format::Promise::kPosition;
  bool has_aggregates = false;    ///< which are judged by what they cover (V208)
  bool has_displacement = false;  ///< how far a pixel may be displaced: there is a source, and a tier that speaks of it
  bool is_closed = false;         ///< every mesh of the source is
  bool is_estimated = false;      ///< some mesh's errors are
  bool has_holes = false;         ///< that nothing shows through: of what is closed and opaque
  double tolerance = 1.0;
};

Promise promise_of(const run::Asset& asset, const std::vector<SourceSurface>& source, const draw::GpuScene& scene) {
  Promise out;
  out.kind = asset.promise();
  out.has_displacement = !source.empty();
  for (const format::MeshRecord& mesh : asset.meshes()) {
    if (mesh.cluster_count == 0) continue;
    // What is promised of more than positions is measured where positions are estimated.
    const bool is_estimated = mesh.error_tier == format::ErrorTier::kQem && out.kind == format::Promise::kPosition;
    if (is_estimated) {
      out.is_estimated = true;
      out.has_displacement = false;
    }
    if (mesh.error_tier != format::ErrorTier::kCertified && !is_estimated) out.tolerance = 1.05;
  }
  for (std::uint32_t m = 0; m < asset.meshes().size(); ++m) {
    out.has_aggregates = out.has_aggregates || has_aggregates(asset, MeshId(m));
  }
  out.has_displacement = out.has_displacement && !out.has_aggregates;
  out.is_closed = std::all_of(source.begin(), source.end(), [](const SourceSurface& mesh) {
    return mesh.surface.triangles.empty() || is_closed(mesh.surface);
  });
  out.has_holes = out.has_displacement && out.is_closed && !scene.has_alpha_mask;
  return out;
}

struct Checks {
  GpuCheck decoded{Rule::kV401, "the GPU decodes every cluster to the CPU's integers"};
  GpuCheck cuts{Rule::kV402, "the GPU's traversal selects what the flat rule selects"};
  GpuCheck pixels{Rule::kV403, "the GPU's software rasterizer draws the CPU's ids and depths (pixels)"};
  GpuCheck culled{Rule::kV404, "frustum and two-pass occlusion culling change no pixel"};
  GpuCheck by_vertex{Rule::kV409, "hardware raster, vertices pulled"};
  GpuCheck by_mesh{Rule::kV409, "hardware raster, mesh shaders"};
  GpuCheck holes{Rule::kV406, "no background is seen through the cut where the source covers it (pixels)"};
  GpuCheck displaced{Rule::kV405, ""};
  GpuCheck surfaces{Rule::kV211, ""};

  [[nodiscard]] std::vector<GpuCheck> in_order() const {
    return {decoded, cuts, pixels, culled, by_vertex, by_mesh, holes, displaced, surfaces};
  }
};

/// One draws all that is selected, one culls what would not be seen.
struct Renderers {
  draw::Renderer plain, culling;
};

Result<Renderers> make_renderers(const draw::Device& device, const draw::GpuScene& scene, const draw::PassPlan& plan) {
  draw::RendererOptions plain = plan.options;
  plain.frustum = plain.occlusion = false;
  draw::RendererOptions culling = plain;
  culling.frustum = culling.occlusion = true;
  TRY_LET(renderer, draw::Renderer::make(device, scene, plain));
  TRY_LET(culler, draw::Renderer::make(device, scene, culling));
  return Renderers{std::move(*renderer), std::move(*culler)};
}

/// Goes through the cameras of one picture size after the other; what it finds is added to the checks and the report.
class CameraJudge {
 public:
  CameraJudge(const run::Asset& asset, const GpuVerifyOptions& options, const PictureSource& source,
              const Promise& promise, const draw::AlphaMasks& masks, Checks& checks, GpuVerifyReport& report)
      : asset_(asset),
        options_(options),
        source_(source),
        promise_(promise),
        masks_(masks),
        ids_(asset, source.meshes, masks),
        checks_(checks),
        report_(report) {}

  Status judge_size(Renderers& renderers, PictureSize size) {
    if (const Status s = renderers.plain.resize(size.width, size.height); !s) return s;
    if (const Status s = renderers.culling.resize(size.width, size.height); !s) return s;
    worst_ = {};
    for (const NamedCamera& named : cameras_of(size)) {
      const std::string where = named.name + " at " + std::to_string(size.width) + "x" + std::to_string(size.height);
      if (const Status s = compare_with_cpu(renderers, named, where); !s) return s;
      if (source_.meshes.empty()) continue;
      if (const Status s = judge_by_source(renderers.plain, named, where); !s) return s;
    }
    return worst_.camera ? write_maps(options_, worst_.picture, report_.cameras[*worst_.camera]) : Status(Ok{});
  }

 private:
  /// Of this size, the camera with the largest share of its allowance so far, with its maps.
  struct Worst {
    std::optional<std::size_t> camera;
    PictureReport picture;
  };

  std::vector<NamedCamera> cameras_of(PictureSize size) const {
    std::vector<NamedCamera> cameras = adversarial_cameras(asset_, size.width, size.height);
    for (NamedCamera& named : orbit_cameras(asset_, options_.orbits, size.width, size.height)) cameras.push_back(named);
    for (NamedCamera named : options_.path) {
      named.camera.width = size.width;
      named.camera.height = size.height;
      cameras.push_back(named);
    }
    return cameras;
  }

  Status compare_with_cpu(Renderers& renderers, const NamedCamera& named, const std::string& where) {
    TRY_LET(frame, compare_frame(renderers.plain, asset_, named.camera, options_.pixel_error));
    add(checks_.cuts, frame->cut, where);
    add(checks_.pixels, frame->pixels, where);
    TRY_LET(culled, compare_frame(renderers.culling, asset_, named.camera, options_.pixel_error));
    add(checks_.culled, culled->cut, where);
    add(checks_.culled, culled->pixels, where);
    return Ok{};
  }

  /// The picture that `renderer` drew last against the source.
  Status judge_by_source(draw::Renderer& renderer, const NamedCamera& named, const std::string& where) {
    const auto cut = renderer.read_cut();
    const auto drawn = renderer.read_pixels();
    if (!cut) return cut.error();
    if (!drawn) return drawn.error();
    TRY_LET(picture, judge_picture(asset_, source_, *cut, *drawn, named.camera, options_.pixel_error, masks_));
    count(*picture, where);
    TRY(judge_ids(*cut, *drawn, named, where));
    report_.cameras.push_back({named, without_maps(*picture), {}});
    if (!worst_.camera || picture->largest_share > worst_.picture.largest_share) {
      worst_ = {report_.cameras.size() - 1, *picture};
      return Ok{};
    }
    const bool has_failed =
        (promise_.has_displacement && picture->exceeded > 0) || (promise_.has_holes && picture->holes > 0);
    return has_failed ? write_maps(options_, *picture, report_.cameras.back()) : Status(Ok{});
  }

  Status judge_ids(std::span<const run::ClusterInstance> cut, const draw::VisibilityBuffer& drawn,
                   const NamedCamera& named, const std::string& where) {
    TRY_LET(truth, ids_.draw_source_ids(named.camera));
    TRY_LET(distance, ids_.judge_cut(*truth, named.camera, cut, drawn, options_.pixel_error));
    report_.surfaces.add(where, *distance);
    return Ok{};
  }

  void count(const PictureReport& picture, const std::string& where) {
    report_.largest_px = std::max(report_.largest_px, picture.largest_px);
    report_.largest_share = std::max(report_.largest_share, picture.largest_share);
    GpuCheck& displaced = checks_.displaced;
    displaced.items += picture.points;
    displaced.failures += promise_.has_displacement ? picture.exceeded : 0;
    if (promise_.has_displacement && picture.exceeded > 0 && displaced.first.empty()) {
      displaced.first = where + ": " + format_px("%.3f px", picture.largest_px) +
                        format_px(" in all, %.3f of what is allowed at its point", picture.largest_share);
    }
    GpuCheck& holes = checks_.holes;
    holes.items += picture.covered_source;
    holes.failures += promise_.has_holes ? picture.holes : 0;
    if (promise_.has_holes && picture.holes > 0 && holes.first.empty()) holes.first = where;
  }

  const run::Asset& asset_;
  const GpuVerifyOptions& options_;
  const PictureSource& source_;
  const Promise& promise_;
  const draw::AlphaMasks& masks_;
  IdJudge ids_;
  Checks& checks_;
  GpuVerifyReport& report_;
  Worst worst_;
};

/// What was found of displacement and holes, or why they were not judged.
void describe_promises(const Promise& promise, const GpuVerifyReport& report, double pixel_error, Checks& checks) {
  checks.displaced.is_skipped = !promise.has_displacement;
  constexpr const char* kWhat[] = {"pixels are displaced by", "pixels and their texels are displaced by",
                                   "pixels, their texels and their normals are displaced by"};
  checks.displaced.what =
      kWhat[static_cast<std::size_t>(promise.kind)] + format_px(" %.3f px at most", report.largest_px) +
      format_px(", %.3f of what is allowed:", report.largest_share) + format_px(" %.3g or level 0's own", pixel_error) +
      (promise.has_displacement ? ""
       : promise.has_aggregates ? " (not judged: aggregates are held to what they cover)"
                                : " (not judged: tier qem states the quadric's estimate)");
  checks.surfaces.is_skipped = promise.is_estimated || report.surfaces.pictures == 0;
  checks.surfaces.items = report.surfaces.pictures;
  checks.surfaces.failures = checks.surfaces.is_skipped ? 0 : report.surfaces.beyond_limit;
  checks.surfaces.first = report.surfaces.worst_picture;
  checks.surfaces.what =
      report.surfaces.pictures == 0 ? "which surface pixels show (not judged: no source)" : describe(report.surfaces);
  if (promise.is_estimated) checks.surfaces.what += " (not judged: tier qem states the quadric's estimate)";
  checks.holes.is_skipped = !promise.has_holes;
  if (!promise.has_holes) {
    checks.holes.what += promise.has_aggregates ? " (not judged: aggregates are open)"
                         : promise.is_closed    ? " (not judged: tier qem)"
                                                : " (not judged: the source is open)";
  }
}

}  // namespace

Result<GpuVerifyReport> verify_on_gpu(const run::Asset& asset, const scene::Scene& whole,
                                      const GpuVerifyOptions& options) {
  const std::optional<scene::Scene> split = split_source(asset, whole);
  const scene::Scene& source = split ? *split : whole;
  TRY_LET(device, draw::Device::open(options.device));
  draw::ImageBudget images(options.max_decoded);
  TRY_LET(scene, draw::upload_scene(*device, asset, {}, {}, &images));
  GpuVerifyReport out;
  out.device = device->info();
  out.warnings = scene->alpha_masks->warnings;

  Checks checks;
  TRY_LET(decode, compare_decode(*device, *scene, asset));
  add(checks.decoded, *decode, "decode");

  const std::vector<SourceSurface> meshes = source_surfaces(source);
  const Promise promise = promise_of(asset, meshes, *scene);
  TRY_LET(every_cluster, run::decode_all(asset));
  // Culling and hardware raster are judged whether or not the scene calls for them.
  TRY_LET(plan,
          draw::plan_passes(*scene, device->info(), options.sizes[0].width, options.sizes[0].height, {"occlusion"}));
  out.plan = draw::describe_plan(*plan, "  ");
  TRY_LET(renderers, make_renderers(*device, *scene, *plan));
  for (GpuCheck* check : {&checks.by_vertex, &checks.by_mesh}) {
    const bool by_mesh_shaders = check == &checks.by_mesh;
    TRY_LET(s, judge_hardware(*device, *scene, asset, options, by_mesh_shaders, *check));
  }
  const std::vector<PaintedSurface> painted = painted_surfaces(asset, source);
  const PictureSource truth{meshes, *every_cluster, promise.tolerance, painted};
  CameraJudge judge(asset, options, truth, promise, *scene->alpha_masks, checks, out);
  for (const PictureSize size : options.sizes) {
    TRY(judge.judge_size(*renderers, size));
  }
  describe_promises(promise, out, options.pixel_error, checks);
  out.checks = checks.in_order();
  return out;
}

}  // namespace meshlode::judge
