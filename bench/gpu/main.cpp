// SPDX-License-Identifier: GPL-3.0-or-later
// bench_gpu ASSET --scene cube:15x15x15 | ground:1000 [--size WxH] [--frames N] [--variants a,b] [--device D]
//           [--pixel-error T] [--pool SHARE] [--png FILE] [-o FILE.json]
// Times a frame on the device, pass by pass: medians over N frames of a still and of a moving camera, for each variant.
// With --pool, instead, N frames of a moving camera from a pool of that share of the pages, against all resident.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/json_writer.h"
#include "draw/gpu/renderer.h"
#include "pool.h"
#include "scenes.h"

namespace meshlode::bench {
namespace {

struct Options {
  std::string asset, scene = "cube:15x15x15", output, png, device, variants;
  std::uint32_t width = 2240, height = 1260, frames = 50;
  double pixel_error = 1.0, pool = 0.0;
};

struct Variant {
  std::string name;
  draw::RendererOptions renderer;
  bool has_lod = true;
};

std::vector<Variant> all_variants() {
  draw::RendererOptions plain;
  plain.occlusion = true;
  plain.max_items = 1u << 23;
  std::vector<Variant> out;
  const auto add = [&](const char* name, auto change, bool has_lod = true) {
    Variant variant{name, plain, has_lod};
    change(variant.renderer);
    out.push_back(variant);
  };
  add("plan", [](auto&) {});
  add("no-occlusion", [](auto& r) { r.occlusion = false; });
  add("no-culling", [](auto& r) { r.occlusion = r.frustum = false; });
  add("persistent", [](auto& r) { r.persistent = true; });
  add("mixed-vertex", [](auto& r) { r.hardware = draw::HardwarePath::kVertex; });
  add("hardware-vertex", [](auto& r) {
    r.hardware = draw::HardwarePath::kVertex;
    r.hardware_pixels = 0.0F;
  });
  add("mixed-mesh", [](auto& r) { r.hardware = draw::HardwarePath::kMesh; });
  add("hardware-mesh", [](auto& r) {
    r.hardware = draw::HardwarePath::kMesh;
    r.hardware_pixels = 0.0F;
  });
  add("force-all", [](auto& r) {
    r.double_sided = r.alpha_mask = true;
    r.hardware = draw::HardwarePath::kVertex;
  });
  add(
      "no-lod", [](auto&) {}, false);
  add(
      "no-lod-no-occlusion", [](auto& r) { r.occlusion = false; }, false);
  return out;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Measured {
  double total = 0.0;
  std::vector<std::pair<std::string, double>> passes;
  draw::FrameReport last;
};

Result<Measured> measure(draw::Renderer& renderer, const BenchScene& scene, const Options& options, bool is_moving,
                         double pixel_error) {
  Measured out;
  std::map<std::string, std::vector<double>> times;
  std::vector<double> totals;
  constexpr std::uint32_t kWarm = 4;
  for (std::uint32_t f = 0; f < kWarm + options.frames; ++f) {
    const double t = is_moving ? 0.25 + 0.0005 * f : 0.25;  // two thousand frames around
    const auto frame = renderer.draw(bench_camera(scene, t, options.width, options.height), pixel_error, 0.0);
    if (!frame) return frame.error();
    if (f < kWarm) continue;
    double total = 0.0;
    out.passes.clear();
    for (const auto& time : frame->times) {
      times[time.name].push_back(time.milliseconds);
      total += time.milliseconds;
      out.passes.emplace_back(time.name, 0.0);
    }
    totals.push_back(total);
    out.last = *frame;
  }
  out.total = median(totals);
  for (auto& [name, milliseconds] : out.passes) milliseconds = median(times[name]);
  return out;
}

void write_measured(JsonWriter& json, const char* key, const Measured& m) {
  json.key(key);
  json.begin_object();
  json.field("median_ms", m.total);
  json.key("passes_ms");
  json.begin_object();
  for (const auto& [name, milliseconds] : m.passes) json.field(name, milliseconds);
  json.end_object();
  json.field("visible_instances", m.last.visible_instances);
  json.field("traversed_nodes", m.last.traversed_nodes);
  json.field("open_groups", m.last.open_groups);
  json.field("clusters", m.last.items);
  json.field("second_pass_clusters", m.last.second_pass_items);
  json.field("hardware_clusters", m.last.hardware_items);
  json.field("far_clusters", m.last.far_items);
  json.field("clipped_clusters", m.last.clipped_items);
  json.field("overflow", draw::describe_overflow(m.last.overflow));
  json.end_object();
}

Status write_pool(JsonWriter& json, const draw::Device& device, const run::Asset& asset, const BenchScene& scene,
                  const Options& options) {
  const auto pool = measure_pool(device, asset, scene,
                                 {options.pool, options.width, options.height, options.frames, options.pixel_error});
  if (!pool) return pool.error();
  json.field("pages", pool->pages);
  json.field("slots", pool->slots);
  json.field("all_resident_ms", pool->all_ms);
  json.field("pool_ms", pool->pool_ms);
  json.field("times_all_resident", pool->pool_ms / pool->all_ms);
  json.key("passes_ms");
  json.begin_object();
  for (const PassTimes& times : pool->passes) {
    json.key(times.pass);
    json.begin_object();
    json.field("all_resident", times.all_ms);
    json.field("pool", times.pool_ms);
    json.end_object();
  }
  json.end_object();
  json.field("all_resident_clusters_of_all_frames", pool->all_clusters);
  json.field("pool_clusters_of_all_frames", pool->pool_clusters);
  json.field("loads", pool->loads);
  json.field("frames_that_lacked_a_page", pool->incomplete);
  std::fprintf(stderr, "pool of %u of %u pages %8.3f ms  all resident %8.3f ms: %.3f times\n", pool->slots, pool->pages,
               pool->pool_ms, pool->all_ms, pool->pool_ms / pool->all_ms);
  return Ok{};
}

/// A colour per cluster of the list, to see that the picture is there.
Status write_picture(draw::Renderer& renderer, const std::string& path) {
  const auto pixels = renderer.read_pixels();
  if (!pixels) return pixels.error();
  draw::Image image;
  image.width = pixels->width;
  image.height = pixels->height;
  image.rgba.assign(pixels->pixel_count() * 4, 255);
  for (std::size_t i = 0; i < pixels->pixel_count(); ++i) {
    const std::uint32_t item = pixels->item[i];
    const std::uint32_t hash = item == draw::VisibilityBuffer::kNothing ? 0xFFFFFFFFu : (item + 1) * 2654435761u;
    for (std::size_t k = 0; k < 3; ++k) {
      image.rgba[4 * i + k] = static_cast<std::uint8_t>(64 + (hash >> (8 * k + 8) & 0xFFu) * 3 / 4);
    }
  }
  return write_file_atomically(path, draw::encode_png(image));
}

bool parse(int count, char** args, Options& out) {
  for (int i = 1; i < count; ++i) {
    const std::string arg = args[i];
    if (!arg.starts_with("-")) {
      out.asset = arg;
      continue;
    }
    if (i + 1 >= count) return false;
    const std::string value = args[++i];
    if (arg == "--scene")
      out.scene = value;
    else if (arg == "-o")
      out.output = value;
    else if (arg == "--png")
      out.png = value;
    else if (arg == "--device")
      out.device = value;
    else if (arg == "--variants")
      out.variants = value;
    else if (arg == "--frames")
      out.frames = static_cast<std::uint32_t>(std::atoi(value.c_str()));
    else if (arg == "--pixel-error")
      out.pixel_error = std::atof(value.c_str());
    else if (arg == "--pool" && std::atof(value.c_str()) > 0.0 && std::atof(value.c_str()) <= 1.0)
      out.pool = std::atof(value.c_str());
    else if (arg == "--size" && std::sscanf(value.c_str(), "%ux%u", &out.width, &out.height) == 2)
      continue;
    else
      return false;
  }
  return !out.asset.empty();
}

int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", error.message().c_str());
  return static_cast<int>(error.code);
}

int write_json(JsonWriter& json, const std::string& path) {
  const std::string text = json.text();
  if (path.empty()) {
    std::puts(text.c_str());
    return 0;
  }
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  if (const Status written = write_file_atomically(path, bytes); !written) return fail(written.error());
  return 0;
}

int run(int count, char** args) {
  Options options;
  if (!parse(count, args, options)) {
    std::fprintf(stderr,
                 "usage: bench_gpu ASSET --scene cube:XxYxZ|ground:SIDE [--size WxH] [--frames N] "
                 "[--variants a,b] [--device D] [--pixel-error T] [--pool SHARE] [--png FILE] [-o FILE]\n");
    return 1;
  }
  const auto asset = run::Asset::open(options.asset);
  if (!asset) return fail(asset.error());
  std::uint32_t x = 1, y = 1, z = 1;
  BenchScene scene;
  if (std::sscanf(options.scene.c_str(), "cube:%ux%ux%u", &x, &y, &z) == 3)
    scene = make_grid(*asset, x, y, z);
  else if (std::sscanf(options.scene.c_str(), "ground:%u", &x) == 1)
    scene = make_ground(*asset, x);
  else
    return fail({ErrorCode::kUsage, "--scene", "cube:XxYxZ or ground:SIDE"});

  auto device = draw::Device::open({.device = options.device, .validate = false});
  if (!device) return fail(device.error());

  JsonWriter json;
  json.begin_object();
  json.field("device", device->info().name);
  json.field("driver", device->info().driver);
  json.field("asset", std::filesystem::path(options.asset).filename().string());
  json.field("scene", options.scene);
  json.field("instances", scene.instances.size());
  json.field("source_triangles", asset->meshes()[0].source_triangles * scene.instances.size());
  json.field("width", options.width);
  json.field("height", options.height);
  json.field("pixel_error", options.pixel_error);
  json.field("frames", options.frames);
  if (options.pool > 0.0) {
    if (const Status s = write_pool(json, *device, *asset, scene, options); !s) return fail(s.error());
    json.end_object();
    return write_json(json, options.output);
  }
  const auto uploaded = draw::upload_scene(*device, *asset, scene.instances);
  if (!uploaded) return fail(uploaded.error());
  json.key("variants");
  json.begin_array();
  for (Variant variant : all_variants()) {
    if (!options.variants.empty() &&
        ("," + options.variants + ",").find("," + variant.name + ",") == std::string::npos) {
      continue;
    }
    variant.renderer.width = options.width;
    variant.renderer.height = options.height;
    variant.renderer.double_sided = variant.renderer.double_sided || uploaded->has_double_sided;
    variant.renderer.alpha_mask = variant.renderer.alpha_mask || uploaded->has_alpha_mask;
    const double pixel_error = variant.has_lod ? options.pixel_error : 0.0;
    json.begin_object();
    json.field("name", variant.name);
    auto renderer = draw::Renderer::make(*device, *uploaded, variant.renderer);
    const auto still =
        renderer ? measure(*renderer, scene, options, false, pixel_error) : Result<Measured>(renderer.error());
    if (!still) {
      json.field("error", still.error().message());
      json.end_object();
      std::fprintf(stderr, "%-22s %s\n", variant.name.c_str(), still.error().message().c_str());
      continue;
    }
    json.field("list_bytes", renderer->list_bytes());
    write_measured(json, "still", *still);
    if (variant.name == "plan") {
      std::vector<double> resolves;  // the first makes the pipeline; its time on the device is the same
      for (int i = 0; i < 9; ++i) {
        const auto resolved = renderer->resolve(VIEW_SHADED, 1);
        if (!resolved) return fail(resolved.error());
        resolves.push_back(resolved->milliseconds);
      }
      json.field("resolve_ms", median(resolves));
      std::fprintf(stderr, "resolve %.3f ms\n", median(resolves));
    }
    const auto moving = measure(*renderer, scene, options, true, pixel_error);
    if (!moving) return fail(moving.error());
    write_measured(json, "moving", *moving);
    json.end_object();
    std::fprintf(stderr, "%-22s still %8.3f ms  moving %8.3f ms  %u clusters, %u in the second pass %s\n",
                 variant.name.c_str(), still->total, moving->total, still->last.items, still->last.second_pass_items,
                 draw::describe_overflow(still->last.overflow).c_str());
    for (const auto& [name, milliseconds] : still->passes)
      std::fprintf(stderr, "  %-14s %8.4f\n", name.c_str(), milliseconds);
    if (!options.png.empty() && variant.name == "plan") {
      if (const Status written = write_picture(*renderer, options.png); !written) return fail(written.error());
    }
  }
  json.end_array();
  json.end_object();
  return write_json(json, options.output);
}

}  // namespace
}  // namespace meshlode::bench

int main(int count, char** args) {
  return meshlode::bench::run(count, args);
}
