// SPDX-License-Identifier: GPL-3.0-or-later
#include "pool.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "base/try.h"
#include "draw/gpu/page_pool.h"
#include "draw/gpu/pass_plan.h"
#include "draw/gpu/renderer.h"

namespace meshlode::bench {

namespace {

/// Pages of 128 KiB at most: 120 MiB a second at 60 frames, what a slow SSD gives.
constexpr std::uint32_t kLoadsPerFrame = 16;

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Milliseconds of a renderer's frames: of each pass, and of all of them together.
struct FrameTimes {
  std::vector<std::string> names;  ///< of passes, in the order of a frame
  std::map<std::string, std::vector<double>> passes;
  std::vector<double> frames;

  void add(const draw::FrameReport& frame) {
    double sum = 0.0;
    for (const draw::Commands::Time& time : frame.times) {
      std::vector<double>& times = passes[time.name];
      if (times.empty()) names.push_back(time.name);
      times.push_back(time.milliseconds);
      sum += time.milliseconds;
    }
    frames.push_back(sum);
  }
};

std::vector<PassTimes> compare_passes(FrameTimes& all, FrameTimes& pool) {
  std::vector<PassTimes> out;
  for (const std::string& name : pool.names) {
    if (std::find(all.names.begin(), all.names.end(), name) == all.names.end()) all.names.push_back(name);
  }
  for (const std::string& name : all.names)
    out.push_back({name, median_of(all.passes[name]), median_of(pool.passes[name])});
  return out;
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
  FrameTimes all_times, pool_times;
  for (std::uint32_t f = 0; f < options.frames; ++f) {
    const run::Camera camera = pool_camera(scene, 1.0 * f / options.frames, options);
    TRY_LET(whole, all->draw(camera, options.pixel_error, 0.0));
    TRY_LET(partial, draw_pooled(camera, kLoadsPerFrame));
    all_times.add(*whole);
    pool_times.add(*partial);
    out.all_clusters += whole->items;
    out.pool_clusters += partial->items;
  }
  out.loads = pool.loads() - loads_before;
  out.passes = compare_passes(all_times, pool_times);
  out.all_ms = median_of(std::move(all_times.frames));
  out.pool_ms = median_of(std::move(pool_times.frames));
  return out;
}

}  // namespace meshlode::bench
