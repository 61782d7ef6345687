// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/gpu/compare_frame.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>

#include "base/try.h"
#include "draw/gpu/gpu_camera.h"
#include "draw/gpu/shaders.h"
#include "draw/gpu/shaders/frame.h"
#include "draw/raster/raster.h"
#include "run/decode/decode.h"

namespace meshlode::judge {

namespace {

struct DecodePush {
  std::uint64_t frame = 0;
  std::uint32_t pass = 0, depth = 0, first = 0, count = 0;
};

void note(Comparison& comparison, const std::string& what) {
  if (comparison.differences++ == 0) comparison.first = what;
}

std::string name_of(const run::ClusterInstance& c) {
  return "instance " + std::to_string(c.instance.value) + " cluster " + std::to_string(c.cluster.value);
}

/// What decode.comp writes of a cluster.
std::vector<std::uint32_t> expected_words(const run::DecodedCluster& cluster) {
  std::vector<std::uint32_t> out = {cluster.vertex_count, cluster.triangle_count};
  for (const std::int32_t value : cluster.channels) out.push_back(static_cast<std::uint32_t>(value));
  for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
    for (const std::uint8_t corner : cluster.triangles[t]) out.push_back(corner);
    out.push_back(cluster.triangle_material[t]);
  }
  return out;
}

}  // namespace

Result<Comparison> compare_decode(draw::Device& device, const draw::GpuScene& scene, const run::Asset& asset) {
  TRY_LET(decoded, run::decode_all(asset));
  TRY_LET(pipeline, device.make_compute(draw::find_shader("decode.comp"), {}));
  constexpr std::uint64_t kChunkWords = 4u << 20;
  TRY_LET(output, device.make_buffer(kChunkWords * 4, draw::Memory::kDevice));
  TRY_LET(entries_buffer, device.make_buffer(std::uint64_t{scene.cluster_count} * 8, draw::Memory::kDevice));
  TRY_LET(frame_buffer, device.make_buffer(sizeof(draw::GpuFrame), draw::Memory::kDevice));

  std::vector<std::uint32_t> mesh_of(asset.clusters().size(), 0);
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    std::fill_n(mesh_of.begin() + mesh.first_cluster, mesh.cluster_count, static_cast<std::uint32_t>(m));
  }
  draw::GpuFrame frame{};
  frame.meshes = scene.meshes.address();
  frame.clusters = scene.clusters.address();
  frame.pages = scene.pages.address();
  frame.page_words = scene.page_words.address();
  frame.retry_clusters = entries_buffer->address();
  frame.clipped = output->address();
  TRY(device.upload(*frame_buffer, draw::bytes_of(frame)));

  Comparison out;
  std::vector<std::array<std::uint32_t, 2>> entries(asset.clusters().size());
  std::vector<std::uint32_t> words;
  for (std::size_t first = 0; first < decoded->size();) {
    std::uint64_t used = 0;
    std::size_t end = first;
    std::vector<std::vector<std::uint32_t>> expected;
    for (; end < decoded->size(); ++end) {
      std::vector<std::uint32_t> cluster = expected_words((*decoded)[end]);
      if (used + cluster.size() > kChunkWords) break;
      entries[end] = {mesh_of[end], static_cast<std::uint32_t>(used)};
      used += cluster.size();
      expected.push_back(std::move(cluster));
    }
    const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(entries.data()),
                                              entries.size() * 8);
    TRY(device.upload(*entries_buffer, bytes));
    TRY_LET(list, draw::Commands::begin(device));
    const auto count = static_cast<std::uint32_t>(end - first);
    const DecodePush push{frame_buffer->address(), 0, 0, static_cast<std::uint32_t>(first), count};
    list->fill(*output, 0, output->bytes(), 0xCDCDCDCDu);
    list->barrier();
    list->dispatch(*pipeline, draw::bytes_of(push), count);
    list->barrier();
    TRY(list->run());
    words.resize(used);
    const std::span<std::uint8_t> target(reinterpret_cast<std::uint8_t*>(words.data()), words.size() * 4);
    TRY(device.download(*output, target));
    for (std::size_t c = first; c < end; ++c) {
      ++out.items;
      const std::vector<std::uint32_t>& want = expected[c - first];
      const auto got = words.begin() + entries[c][1];
      const auto [at, unused] = std::mismatch(want.begin(), want.end(), got);
      if (at != want.end()) {
        note(out, "cluster " + std::to_string(c) + ", word " + std::to_string(at - want.begin()));
      }
    }
    first = end;
  }
  return out;
}

Status compare_pixels(draw::Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                      std::span<const run::ClusterInstance> cut, std::span<const run::ClusterInstance> expected,
                      Comparison& out) {
  TRY(renderer.redraw_in_order());
  TRY_LET(pixels, renderer.read_pixels());
  TRY_LET(reference, draw::draw_cut(asset, expected, camera, *renderer.scene().alpha_masks));
  out.items += reference->pixel_count();
  const auto key_at = [](const draw::VisibilityBuffer& buffer, std::span<const run::ClusterInstance> items,
                         std::size_t i) {
    return buffer.item[i] < items.size() ? items[buffer.item[i]] : run::ClusterInstance{};
  };
  for (std::size_t i = 0; i < reference->pixel_count(); ++i) {
    const run::ClusterInstance want = key_at(*reference, expected, i), got = key_at(*pixels, cut, i);
    if (want == got && reference->depth[i] == pixels->depth[i] && reference->triangle[i] == pixels->triangle[i])
      continue;
    note(out, "pixel " + std::to_string(i % camera.width) + "," + std::to_string(i / camera.width) + ": GPU " +
                  name_of(got) + " triangle " + std::to_string(pixels->triangle[i]) + " depth " +
                  std::to_string(pixels->depth[i]) + ", CPU " + name_of(want) + " triangle " +
                  std::to_string(reference->triangle[i]) + " depth " + std::to_string(reference->depth[i]));
  }
  return Ok{};
}

Result<CutComparison> compare_frame(draw::Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                                    double pixel_error, const run::AttributeBounds& bounds) {
  CutComparison out;
  TRY_LET(depth, draw::depth_of_scene(asset, camera));
  TRY_LET(frame, renderer.draw(camera, pixel_error, *depth));
  out.frame = std::move(*frame);
  TRY_LET(cut, renderer.read_cut());

  const std::vector<run::ClusterInstance> expected = run::select_flat(asset, camera, pixel_error, bounds);
  out.cut.items = expected.size();
  std::vector<run::ClusterInstance> extra, missing;
  std::set_difference(cut->begin(), cut->end(), expected.begin(), expected.end(), std::back_inserter(extra));
  std::set_difference(expected.begin(), expected.end(), cut->begin(), cut->end(), std::back_inserter(missing));
  for (const run::ClusterInstance& c : extra) note(out.cut, name_of(c) + " is drawn, the flat rule does not");
  if (!renderer.options().frustum) {
    for (const run::ClusterInstance& c : missing) note(out.cut, name_of(c) + " is not drawn, the flat rule does");
  }
  if (std::adjacent_find(cut->begin(), cut->end()) != cut->end()) note(out.cut, "a cluster is drawn twice");
  if (out.frame.overflow != 0) note(out.cut, "overflow of " + draw::describe_overflow(out.frame.overflow));

  TRY(compare_pixels(renderer, asset, camera, *cut, expected, out.pixels));
  return out;
}

Result<HardwareComparison> compare_hardware(draw::Renderer& renderer, const run::Asset& asset,
                                            const run::Camera& camera, double pixel_error) {
  TRY_LET(depth, draw::depth_of_scene(asset, camera));
  TRY_LET(frame, renderer.draw(camera, pixel_error, *depth));
  TRY_LET(cut, renderer.read_cut());
  TRY_LET(pixels, renderer.read_pixels_of_cut());
  const std::vector<run::ClusterInstance> expected = run::select_flat(asset, camera, pixel_error);
  TRY_LET(reference, draw::draw_cut(asset, expected, camera, *renderer.scene().alpha_masks));
  return HardwareComparison{frame->hardware_items == expected.size() && *cut == expected,
                            measure_distance(*reference, *pixels, camera.is_orthographic)};
}

}  // namespace meshlode::judge
