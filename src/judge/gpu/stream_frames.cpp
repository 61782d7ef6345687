// SPDX-License-Identifier: GPL-3.0-or-later
// V410: a path of frames that the device draws from a pool of pages. The CPU's selection with the same resident pages
// is the reference, which V212 judges.
#include <algorithm>
#include <cmath>
#include <string>

#include "base/random.h"
#include "base/try.h"
#include "draw/gpu/gpu_camera.h"
#include "draw/gpu/page_pool.h"
#include "judge/gpu/compare_frame.h"
#include "judge/gpu/verify_gpu.h"
#include "judge/verify/judged_view.h"
#include "run/select/resident.h"

namespace meshlode::judge {

namespace {

/// A device's division and square root are not exact, and the distance to a near sphere is what two floats leave that
/// are nearly equal.
constexpr double kPriorityDifference = 0.01;
/// Of the picture that pixel errors are of: the usual one.
constexpr double kLines = 1080.0;

/// Which pages are wanted, and by how much, in pixels.
std::string compare_priorities(std::span<const float> device, std::span<const float> host, double pixel_error) {
  for (std::size_t page = 0; page < device.size(); ++page) {
    const double got = double{device[page]} * (device[page] < format::kInfiniteError ? pixel_error : 1.0);
    const double want = page < host.size() ? double{host[page]} : 0.0;
    // Without an error allowed the device has no measure, and the CPU goes by one pixel.
    if (pixel_error == 0.0 && (device[page] > 0.0F) == (want > 0.0)) continue;
    if (std::fabs(got - want) <= kPriorityDifference * want) continue;
    return differs(place("page", page) + ": the device asks by", got, "the CPU by", want);
  }
  return {};
}

/// Of one frame: what differs first.
Result<std::string> judge_frame(draw::Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                                double pixel_error, std::span<const float> priorities,
                                std::span<const std::uint32_t> resident, run::ResidentSelector& selector) {
  TRY_LET(cut, renderer.read_cut());
  std::vector<run::ClusterInstance> expected(asset.clusters().size());
  const run::ResidentQuery query{camera, pixel_error, resident, nullptr};
  for (std::size_t count = 0; (count = selector.select(run::tables_of(asset), query, expected)) != expected.size();) {
    expected.resize(count);
  }
  if (*cut != expected) {
    return std::to_string(cut->size()) + " clusters are drawn, " + std::to_string(expected.size()) + " by the CPU";
  }
  if (std::string text = compare_priorities(priorities, selector.page_priorities(), pixel_error); !text.empty()) {
    return text;
  }
  Comparison pixels;
  TRY(compare_pixels(renderer, asset, camera, *cut, expected, pixels));
  return pixels.first;
}

}  // namespace

Result<StreamFramesReport> verify_streaming_on_gpu(const run::Asset& asset, const StreamFrameOptions& options) {
  StreamFramesReport out;
  TRY_LET(device, draw::Device::open(options.device));
  out.device = device->info();
  out.pages = static_cast<std::uint32_t>(asset.pages().size());
  out.slots = draw::pool_slots(asset, options.pool_share);
  const double pixel_error = options.pixel_error * options.size.height / kLines;
  const bool is_seen = std::any_of(asset.instances().begin(), asset.instances().end(),
                                   [&](const format::InstanceRecord& i) { return is_drawable(asset, i); });
  if (out.pages == 0 || !is_seen) {
    out.check.is_skipped = true;
    out.check.what = "not checked: nothing can be drawn from a pool";
    return out;
  }
  draw::ImageBudget images(options.max_decoded);
  TRY_LET(scene, draw::upload_scene(*device, asset, {}, {}, &images, out.slots));
  draw::RendererOptions drawing;
  drawing.width = options.size.width;
  drawing.height = options.size.height;
  drawing.frustum = false;  // so that the whole cut is compared
  drawing.streams = true;
  drawing.double_sided = scene->has_double_sided;
  drawing.alpha_mask = scene->has_alpha_mask;
  TRY_LET(renderer, draw::Renderer::make(*device, *scene, drawing));
  draw::PagePool pool(*device, asset, renderer->scene());
  run::ResidentSelector selector(run::tables_of(asset));
  std::vector<NamedCamera> cameras = orbit_cameras(asset, options.frames, drawing.width, drawing.height);
  std::reverse(cameras.begin(), cameras.end());
  SplitMix64 random(1);
  for (const NamedCamera& named : cameras) {
    TRY_LET(depth, draw::depth_of_scene(asset, named.camera));
    TRY_LET(frame, renderer->draw(named.camera, pixel_error, *depth));
    TRY_LET(priorities, pool.read_priorities());
    TRY_LET(fault, judge_frame(*renderer, asset, named.camera, pixel_error, *priorities, pool.resident(), selector));
    if (frame->overflow != 0) *fault = "overflow of " + draw::describe_overflow(frame->overflow);
    if (!fault->empty() && out.check.failures++ == 0) {
      out.check.first = "frame " + std::to_string(out.frames) + ": " + *fault;
    }
    ++out.frames;
    out.incomplete += selector.requests().empty() ? 0 : 1;
    TRY(pool.load_pages(*priorities, options.loads_per_frame));
    // Loads by priority bring coarser pages first; without this no group would lack the page of a coarser one.
    if (out.frames % 3 == 0) TRY(pool.drop(static_cast<std::uint32_t>(random.below(out.slots))));
  }
  out.loads = pool.loads();
  out.check.items = out.frames;
  out.check.what = "from a pool of " + std::to_string(out.slots) + " of " + std::to_string(out.pages) +
                   " pages the cut, requests and each pixel are the CPU's; " + std::to_string(out.loads) + " loads, " +
                   std::to_string(out.incomplete) + " frames lacked a page";
  return out;
}

}  // namespace meshlode::judge
