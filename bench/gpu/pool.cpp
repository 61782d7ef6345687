// SPDX-License-Identifier: GPL-3.0-or-later
#include "pool.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/try.h"
#include "draw/gpu/page_pool.h"
#include "draw/gpu/pass_plan.h"
#include "draw/gpu/renderer.h"

namespace meshlode::bench {

namespace {

/// Pages of 128 KiB at most: 120 MiB a second at 60 frames, what a slow SSD gives.
constexpr std::uint32_t kLoadsPerFrame = 16;

double sum_of(const draw::FrameReport& frame) {
  double sum = 0.0;
  for (const draw::Commands::Time& time : frame.times) sum += time.milliseconds;
  return sum;
}

double median_of(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Once around, and in the middle of the way a third as far away, so that other pages are wanted there.
run::Camera pool_camera(const BenchScene& scene, double t, const PoolOptions& options) {
  run::Camera camera = bench_camera(scene, t, options.width, options.height);
  if (!scene.is_ground)
    camera.eye += (0.65 * (0.5 - 0.5 * std::cos(6.283185307179586 * t))) * (camera.target - camera.eye);
  return camera;
}

}  // namespace

Result<PoolReport> measure_pool(draw::Device device, const run::Asset& asset, const BenchScene& scene,
                                const PoolOptions& options) {
  PoolReport out;
  out.pages = static_cast<std::uint32_t>(asset.pages().size());
  out.slots = draw::pool_slots(asset, options.share);
  if (out.pages == 0 || options.frames == 0) return Error{ErrorCode::kUsage, "--pool", "nothing to draw"};
  TRY_LET(all_scene, draw::upload_scene(device, asset, scene.instances));
  TRY_LET(pool_scene, draw::upload_scene(device, asset, scene.instances, {}, nullptr, out.slots));
  TRY_LET(plan, draw::plan_passes(*all_scene, device.info(), options.width, options.height));
  plan->options.max_items = 1U << 23;
  TRY_LET(all, draw::Renderer::make(device, *all_scene, plan->options));
  plan->options.streams = true;
  TRY_LET(pooled, draw::Renderer::make(device, *pool_scene, plan->options));
  draw::PagePool pool(device, asset, pooled->scene());
  const auto draw_pooled = [&](const run::Camera& camera, std::uint32_t most) -> Result<draw::FrameReport> {
    TRY_LET(frame, pooled->draw(camera, options.pixel_error, 0.0));
    TRY_LET(priorities, pool.read_priorities());
    for (std::uint32_t page = 0; page < out.pages; ++page) {
      if ((*priorities)[page] > 0.0F && (pool.resident()[page / 32] >> page % 32 & 1U) == 0) {
        ++out.incomplete;
        break;
      }
    }
    TRY(pool.load_pages(*priorities, most));
    if (frame->overflow != 0) {
      return Error{ErrorCode::kUnsupported, "pool", "overflow of " + draw::describe_overflow(frame->overflow)};
    }
    return frame;
  };
  // The pool is full when the way begins. What occlusion culling hides may change with what is loaded, so it need not
  // end.
  std::uint64_t before = ~std::uint64_t{0};
  for (int round = 0; round < 64 && before != pool.loads(); ++round) {
    before = pool.loads();
    TRY_LET(frame, draw_pooled(pool_camera(scene, 0.0, options), out.slots));
  }
  const std::uint64_t loads_before = pool.loads();
  out.incomplete = 0;
  std::vector<double> all_times, pool_times;
  for (std::uint32_t f = 0; f < options.frames; ++f) {
    const run::Camera camera = pool_camera(scene, 1.0 * f / options.frames, options);
    TRY_LET(whole, all->draw(camera, options.pixel_error, 0.0));
    TRY_LET(partial, draw_pooled(camera, kLoadsPerFrame));
    all_times.push_back(sum_of(*whole));
    pool_times.push_back(sum_of(*partial));
    out.all_clusters += whole->items;
    out.pool_clusters += partial->items;
  }
  out.loads = pool.loads() - loads_before;
  out.all_ms = median_of(all_times);
  out.pool_ms = median_of(pool_times);
  return out;
}

}  // namespace meshlode::bench
