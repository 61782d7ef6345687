// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/gpu/verify_gpu.h"

#include <algorithm>
#include <cstdio>
#include <tuple>

#include "base/file.h"
#include "judge/gpu/hardware_judge.h"
#include "judge/gpu/compare_frame.h"
#include "judge/gpu/judge_picture.h"

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

/// Every cluster by the hardware, from the adversarial cameras and those of the path.
Status judge_hardware(draw::Device& device, const draw::GpuScene& scene, const run::Asset& asset, const GpuVerifyOptions& options,
                      bool by_mesh_shaders, GpuCheck& check) {
  check.is_skipped = by_mesh_shaders && !device.info().has_mesh_shaders;
  if (check.is_skipped) {
    check.what += " (the device has none)";
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
  auto renderer = draw::Renderer::make(device, scene, raster);
  if (!renderer) return renderer.error();
  std::vector<NamedCamera> cameras = adversarial_cameras(asset, raster.width, raster.height);
  for (NamedCamera named : options.path) {
    named.camera.width = raster.width;
    named.camera.height = raster.height;
    cameras.push_back(named);
  }
  for (const NamedCamera& named : cameras) {
    const auto result =
        compare_hardware(*renderer, asset, named.camera, options.pixel_error, device.info().subpixel_bits);
    if (!result) return result.error();
    add(check, *result, named.name);
  }
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

}  // namespace

Result<GpuVerifyReport> verify_on_gpu(const run::Asset& asset, const scene::Scene& source,
                                      const GpuVerifyOptions& options) {
  auto device = draw::Device::open(options.device);
  if (!device) return device.error();
  draw::ImageBudget images(options.max_decoded);
  auto scene = draw::upload_scene(*device, asset, {}, {}, &images);
  if (!scene) return scene.error();
  GpuVerifyReport out;
  out.device = device->info();
  out.warnings = scene->alpha_masks->warnings;

  const auto decode = compare_decode(*device, *scene, asset);
  if (!decode) return decode.error();
  GpuCheck decoded{Rule::kV401, "the GPU decodes every cluster to the CPU's integers"};
  add(decoded, *decode, "decode");
  out.checks.push_back(decoded);

  GpuCheck cuts{Rule::kV402, "the GPU's traversal selects what the flat rule selects"};
  GpuCheck pixels{Rule::kV403, "the GPU's software rasterizer draws the CPU's ids and depths (pixels)"};
  GpuCheck culled{Rule::kV404, "frustum and two-pass occlusion culling change no pixel"};
  GpuCheck displaced{Rule::kV405, ""};
  GpuCheck holes{Rule::kV406, "no background is seen through the cut where the source covers it (pixels)"};

  bool has_promise = !source.meshes.empty();
  double tolerance = 1.0;
  for (const format::MeshRecord& mesh : asset.meshes()) {
    if (mesh.cluster_count == 0) continue;
    if (mesh.error_tier == format::ErrorTier::kQem) has_promise = false;
    if (mesh.error_tier == format::ErrorTier::kMeasured) tolerance = 1.05;
  }
  const std::vector<SourceSurface> meshes = source_surfaces(source);
  const bool all_closed = std::all_of(meshes.begin(), meshes.end(), [](const SourceSurface& mesh) {
    return mesh.surface.triangles.empty() || is_closed(mesh.surface);
  });
  GpuCheck by_vertex{Rule::kV407, "hardware raster, vertices pulled: pixels as the specification allows"};
  GpuCheck by_mesh{Rule::kV408, "hardware raster, mesh shaders: pixels as the specification allows"};
  const bool has_holes_rule = has_promise && all_closed && !scene->has_alpha_mask;
  const auto every_cluster = run::decode_all(asset);
  if (!every_cluster) return every_cluster.error();
  const PictureSource truth{meshes, *every_cluster, tolerance};

  draw::RendererOptions plain;
  plain.width = options.sizes[0].width;
  plain.height = options.sizes[0].height;
  plain.frustum = false;
  plain.double_sided = scene->has_double_sided;
  plain.alpha_mask = scene->has_alpha_mask;
  draw::RendererOptions culling = plain;
  culling.frustum = culling.occlusion = true;
  auto renderer = draw::Renderer::make(*device, *scene, plain);
  if (!renderer) return renderer.error();
  auto culler = draw::Renderer::make(*device, *scene, culling);
  if (!culler) return culler.error();
  for (GpuCheck* check : {&by_vertex, &by_mesh}) {
    if (const Status s = judge_hardware(*device, *scene, asset, options, check == &by_mesh, *check); !s) return s.error();
  }
  for (const PictureSize size : options.sizes) {
    std::size_t worst = out.cameras.size();
    PictureReport worst_picture;
    if (const Status s = renderer->resize(size.width, size.height); !s) return s.error();
    if (const Status s = culler->resize(size.width, size.height); !s) return s.error();
    std::vector<NamedCamera> cameras = adversarial_cameras(asset, size.width, size.height);
    for (NamedCamera& named : orbit_cameras(asset, options.orbits, size.width, size.height)) cameras.push_back(named);
    for (NamedCamera named : options.path) {
      named.camera.width = size.width;
      named.camera.height = size.height;
      cameras.push_back(named);
    }
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const NamedCamera& named = cameras[i];
      const std::string where = named.name + " at " + std::to_string(size.width) + "x" + std::to_string(size.height);
      const auto frame = compare_frame(*renderer, asset, named.camera, options.pixel_error);
      if (!frame) return frame.error();
      add(cuts, frame->cut, where);
      add(pixels, frame->pixels, where);
      const auto culled_frame = compare_frame(*culler, asset, named.camera, options.pixel_error);
      if (!culled_frame) return culled_frame.error();
      add(culled, culled_frame->cut, where);
      add(culled, culled_frame->pixels, where);
      if (source.meshes.empty()) continue;
      const auto cut = renderer->read_cut();
      const auto drawn = renderer->read_pixels();
      if (!cut) return cut.error();
      if (!drawn) return drawn.error();
      const auto picture = judge_picture(asset, truth, *cut, *drawn, named.camera, options.pixel_error, *scene->alpha_masks);
      if (!picture) return picture.error();
      out.largest_px = std::max(out.largest_px, picture->largest_px);
      out.largest_share = std::max(out.largest_share, picture->largest_share);
      const bool is_worse = out.cameras.size() == worst || picture->largest_share > worst_picture.largest_share;
      out.cameras.push_back({named, without_maps(*picture), {}});
      if (is_worse) {
        worst = out.cameras.size() - 1;
        worst_picture = *picture;
      }
      const bool has_failed = (has_promise && picture->exceeded > 0) || (has_holes_rule && picture->holes > 0);
      if (has_failed && !is_worse) {
        if (const Status s = write_maps(options, *picture, out.cameras.back()); !s) return s.error();
      }
      displaced.items += picture->points;
      displaced.failures += has_promise ? picture->exceeded : 0;
      if (has_promise && picture->exceeded > 0 && displaced.first.empty()) {
        displaced.first = where + ": " + format_px("%.3f px", picture->largest_px) +
                          format_px(" in all, %.3f of what is allowed at its point", picture->largest_share);
      }
      holes.items += picture->covered_source;
      holes.failures += has_holes_rule ? picture->holes : 0;
      if (has_holes_rule && picture->holes > 0 && holes.first.empty()) holes.first = where;
    }
    if (worst < out.cameras.size()) {
      if (const Status s = write_maps(options, worst_picture, out.cameras[worst]); !s) return s.error();
    }
  }
  displaced.is_skipped = !has_promise;
  holes.is_skipped = !has_holes_rule;
  if (!has_holes_rule) holes.what += all_closed ? " (not judged: tier qem)" : " (not judged: the source is open)";
  displaced.what = format_px("pixels are displaced by %.3f px at most", out.largest_px) +
                   format_px(", %.3f of what is allowed:", out.largest_share) +
                   format_px(" %.3g or level 0's own", options.pixel_error) +
                   (has_promise ? "" : " (not judged: tier qem states the quadric's estimate)");
  for (const GpuCheck& check : {cuts, pixels, culled, by_vertex, by_mesh, holes, displaced}) out.checks.push_back(check);
  return out;
}

}  // namespace meshlode::judge
