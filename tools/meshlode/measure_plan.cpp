// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure_plan.h"
#include "base/try.h"

#include <algorithm>
#include <chrono>

#include "app/report/info.h"
#include "base/append_format.h"
#include "base/printable.h"
#include "camera_options.h"
#include "draw/gpu/render.h"
#include "draw/raster/raster.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::cli {

namespace {

constexpr std::uint32_t kGpuFrames = 3;  ///< the last one is measured: the first warms the device

double milliseconds_of(const auto& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// An asset with what drawing it takes, loaded once.
struct Loaded {
  run::Asset asset;
  draw::AlphaMasks masks;
  draw::TextureSet textures;
};

Result<Loaded> load(std::vector<std::uint8_t> bytes, std::uint64_t max_decoded) {
  TRY_LET(asset, run::Asset::from_vector(std::move(bytes)));
  draw::ImageBudget images(max_decoded);
  const auto materials = draw::read_material_textures(*asset);
  Loaded out{std::move(*asset), {}, {}};
  out.masks = draw::load_alpha_masks(out.asset, materials, images);
  out.textures = draw::load_textures(out.asset, materials, images);
  return out;
}

Status count_bytes(const run::Asset& asset, MeasuredAsset& out) {
  out.file_bytes = asset.header().file_bytes;
  out.geometry_bytes = app::describe_asset(asset).geometry_bytes;
  for (const format::SectionEntry& section : asset.sections()) {
    out.sections.emplace_back(app::section_name(section.id), section.bytes);
  }
  TRY_LET(map, app::map_bytes(asset));
  const app::PageBits& bits = map->total;
  for (const auto& [name, count] : {std::pair("positions", bits.positions),
                                    {"normals", bits.normals},
                                    {"uvs", bits.uvs},
                                    {"colors", bits.colors},
                                    {"topology", bits.topology},
                                    {"heads", bits.heads + bits.materials + bits.padding}}) {
    out.streams.emplace_back(name, static_cast<double>(count) / 8.0);
  }
  return Ok{};
}

Status draw_on_cpu(const Loaded& loaded, const run::Camera& camera, MeasuredAsset& out) {
  Status drawn = Ok{};
  out.cpu_frame_ms.push_back(milliseconds_of([&] {
    const auto cut = run::select_bvh_within(run::tables_of(loaded.asset), camera, 1.0,
                                            loaded.asset.max_decoded_bytes() / sizeof(run::ClusterInstance), {});
    if (!cut) {
      drawn = Error{ErrorCode::kUnsupported, "cut", "the clusters of all instances take too much"};
      return;
    }
    out.frame_triangles = 0;
    for (const run::ClusterInstance& item : *cut) {
      out.frame_triangles += loaded.asset.clusters()[item.cluster.value].triangle_count();
    }
    const auto visibility = draw::draw_cut(loaded.asset, *cut, camera, loaded.masks);
    if (!visibility) {
      drawn = visibility.error();
      return;
    }
    const auto image = draw::shade_view(loaded.asset, *cut, camera, *visibility, draw::View::kShaded, loaded.textures);
    if (!image) drawn = image.error();
  }));
  return drawn;
}

/// \returns false where there is no device, with its reason
bool draw_on_gpu(const Loaded& loaded, const run::Camera& camera, const MeasureOptions& options, PlanMeasurement& out,
                 MeasuredAsset& asset) {
  draw::GpuRenderOptions render;
  render.device = options.device;
  render.frames = kGpuFrames;
  draw::ImageBudget images(options.max_decoded);
  draw::GpuPicture picture;
  const Status drawn = draw::render_on_gpu(loaded.asset, camera, render, images, picture);
  if (!drawn) {
    out.no_device = drawn.error().message();
    return false;
  }
  out.device = picture.device;
  asset.gpu_frame_ms.push_back(picture.frame_milliseconds);
  return true;
}

/// Median, smallest and largest. \pre not empty
struct Spread {
  double median = 0.0, low = 0.0, high = 0.0;
};

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values[values.size() / 2], values.front(), values.back()};
}

std::string saved_text(double planned, double all) {
  if (!(all > 0.0)) return "";
  std::string text;
  append_format(text, "%+.1f%%", 100.0 * (planned - all) / all);
  return text;
}

void add_count(std::string& out, const std::string& name, double planned, double all) {
  if (planned == 0.0 && all == 0.0) return;
  const auto digits = [](double value) { return grouped_digits(static_cast<std::uint64_t>(value + 0.5)); };
  append_format(out, "  %-22s %16s %16s %9s\n", name.c_str(), digits(planned).c_str(), digits(all).c_str(),
                saved_text(planned, all).c_str());
}

void add_times(std::string& out, const char* name, const std::vector<double>& planned, const std::vector<double>& all) {
  if (planned.empty() || all.empty()) return;
  const Spread a = spread_of(planned), b = spread_of(all);
  append_format(out, "  %-22s %16.3f %16.3f %9s   %.3f to %.3f, %.3f to %.3f\n", name, a.median, b.median,
                saved_text(a.median, b.median).c_str(), a.low, a.high, b.low, b.high);
}

void write_times(JsonWriter& json, const char* name, const std::vector<double>& values) {
  json.key(name);
  if (values.empty()) return json.null();
  const Spread spread = spread_of(values);
  json.begin_object();
  json.field("median", spread.median);
  json.field("smallest", spread.low);
  json.field("largest", spread.high);
  json.end_object();
}

/// One round of builds and, at the first, their bytes. Then frames, so that neither disturbs the other.
Result<std::array<Loaded, 2>> build_rounds(const scene::Scene& scene,
                                           const std::array<builder::PipelineOptions, 2>& options,
                                           const MeasureOptions& measure, PlanMeasurement& out) {
  std::array<std::vector<std::uint8_t>, 2> bytes;
  for (std::uint32_t round = 0; round < measure.rounds; ++round) {
    for (std::size_t side = 0; side < 2; ++side) {
      builder::PipelineReport report;
      Result<std::vector<std::uint8_t>> built = Error{};
      const double ms = milliseconds_of([&] { built = builder::build_lode(scene, options[side], {}, report); });
      if (!built) return built.error();
      out.assets[side].build_seconds.push_back(ms / 1000.0);
      bytes[side] = std::move(*built);
    }
  }
  TRY_LET(planned, load(std::move(bytes[0]), measure.max_decoded));
  TRY_LET(all, load(std::move(bytes[1]), measure.max_decoded));
  return std::array<Loaded, 2>{std::move(*planned), std::move(*all)};
}

}  // namespace

Result<PlanMeasurement> measure_plan(const scene::Scene& scene, const builder::PipelineOptions& options,
                                     const MeasureOptions& measure) {
  PlanMeasurement out;
  out.assets[0].name = "plan";
  out.assets[1].name = "keep_all";
  builder::PipelineOptions all = options;
  const auto keep_all = [](builder::MeshOptions& own) {
    own.attributes = AttributeChoice::kAll;
    own.keep = kAllAttributes;
    own.drop = 0;
  };
  keep_all(all);
  for (builder::MeshOptions& own : all.mesh_options) keep_all(own);
  TRY_LET(loaded, build_rounds(scene, {options, all}, measure, out));
  for (std::size_t side = 0; side < 2; ++side) {
    TRY(count_bytes((*loaded)[side].asset, out.assets[side]));
  }
  out.is_same_content =
      std::ranges::equal((*loaded)[0].asset.header().content_hash, (*loaded)[1].asset.header().content_hash);
  TRY_LET(camera, make_camera({}, (*loaded)[0].asset));
  out.width = camera->width;
  out.height = camera->height;
  bool has_device = true;
  for (std::uint32_t round = 0; round < measure.rounds; ++round) {
    for (std::size_t side = 0; side < 2; ++side) {
      MeasuredAsset& asset = out.assets[side];
      TRY(draw_on_cpu((*loaded)[side], *camera, asset));
      has_device = has_device && draw_on_gpu((*loaded)[side], *camera, measure, out, asset);
    }
  }
  if (!has_device) {
    for (MeasuredAsset& asset : out.assets) asset.gpu_frame_ms.clear();
  }
  return out;
}

std::string describe_measurement(const PlanMeasurement& measured) {
  const MeasuredAsset& planned = measured.assets[0];
  const MeasuredAsset& all = measured.assets[1];
  std::string out;
  append_format(out, "measured: %zu builds of each in turn; frames of %u x %u, one pixel of error\n",
                planned.build_seconds.size(), measured.width, measured.height);
  append_format(out, "  %-22s %16s %16s %9s\n", "", "plan", "--keep all", "");
  add_count(out, "file bytes", static_cast<double>(planned.file_bytes), static_cast<double>(all.file_bytes));
  add_count(out, "geometry bytes", static_cast<double>(planned.geometry_bytes),
            static_cast<double>(all.geometry_bytes));
  for (std::size_t i = 0; i < planned.sections.size() && i < all.sections.size(); ++i) {
    add_count(out, "section " + planned.sections[i].first, static_cast<double>(planned.sections[i].second),
              static_cast<double>(all.sections[i].second));
  }
  for (std::size_t i = 0; i < planned.streams.size(); ++i) {
    add_count(out, "pages, " + planned.streams[i].first, planned.streams[i].second, all.streams[i].second);
  }
  add_count(out, "triangles in the frame", static_cast<double>(planned.frame_triangles),
            static_cast<double>(all.frame_triangles));
  add_times(out, "build, seconds", planned.build_seconds, all.build_seconds);
  add_times(out, "frame of the CPU, ms", planned.cpu_frame_ms, all.cpu_frame_ms);
  add_times(out, "frame of Vulkan, ms", planned.gpu_frame_ms, all.gpu_frame_ms);
  append_format(
      out, "  Vulkan: %s\n",
      printable(measured.no_device.empty() ? measured.device : "not measured: " + measured.no_device, 200).c_str());
  if (measured.is_same_content) append_format(out, "  the plan leaves nothing out: both are the same content\n");
  return out;
}

void write_measurement(JsonWriter& json, const PlanMeasurement& measured) {
  json.begin_object();
  json.field("rounds", measured.assets[0].build_seconds.size());
  json.field("width", measured.width);
  json.field("height", measured.height);
  json.field("device", measured.no_device.empty() ? measured.device : "");
  json.field("is_same_content", measured.is_same_content);
  for (const MeasuredAsset& asset : measured.assets) {
    json.key(asset.name);
    json.begin_object();
    json.field("file_bytes", asset.file_bytes);
    json.field("geometry_bytes", asset.geometry_bytes);
    json.key("sections");
    json.begin_object();
    for (const auto& [name, bytes] : asset.sections) json.field(name, bytes);
    json.end_object();
    json.key("page_bytes");
    json.begin_object();
    for (const auto& [name, bytes] : asset.streams) json.field(name, bytes);
    json.end_object();
    json.field("frame_triangles", asset.frame_triangles);
    write_times(json, "build_seconds", asset.build_seconds);
    write_times(json, "cpu_frame_ms", asset.cpu_frame_ms);
    write_times(json, "gpu_frame_ms", asset.gpu_frame_ms);
    json.end_object();
  }
  json.end_object();
}

}  // namespace meshlode::cli
