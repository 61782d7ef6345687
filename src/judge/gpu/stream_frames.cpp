// SPDX-License-Identifier: GPL-3.0-or-later
// V410: a path of frames that the device draws from a pool of pages. The CPU's selection with the same resident pages
// is the reference, which V212 judges. The same frame culled by the view volume, which decides what is loaded, is held
// to that: what it leaves out is not seen.
#include <algorithm>
#include <string>

#include "base/random.h"
#include "base/try.h"
#include "draw/gpu/gpu_camera.h"
#include "draw/gpu/page_pool.h"
#include "judge/gpu/compare_frame.h"
#include "judge/gpu/stream_requests.h"
#include "judge/gpu/verify_gpu.h"
#include "judge/verify/judged_view.h"
#include "run/select/resident.h"

namespace meshlode::judge {

namespace {

/// Of the picture that pixel errors are of: the usual one.
constexpr double kLines = 1080.0;

Result<std::string> compare_picture(draw::Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                                    std::span<const run::ClusterInstance> cut,
                                    std::span<const run::ClusterInstance> expected) {
  Comparison pixels;
  TRY(compare_pixels(renderer, asset, camera, cut, expected, pixels));
  return pixels.first;
}

/// Of one frame: what differs first.
Result<std::string> judge_frame(draw::Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                                double pixel_error, std::span<const float> priorities,
                                std::span<const run::ClusterInstance> expected, const run::ResidentSelector& selector) {
  TRY_LET(cut, renderer.read_cut());
  if (!std::equal(cut->begin(), cut->end(), expected.begin(), expected.end())) {
    return std::to_string(cut->size()) + " clusters are drawn, " + std::to_string(expected.size()) + " by the CPU";
  }
  if (std::string text = find_priority_fault(priorities, selector.page_priorities(), pixel_error); !text.empty()) {
    return text;
  }
  return compare_picture(renderer, asset, camera, *cut, expected);
}

/// Of the frame that is culled by the view volume: nothing else is drawn or asked for than without it, the picture is
/// the same, and each page is asked for of which something would be seen if all were there.
Result<std::string> judge_culled(draw::Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                                 double pixel_error, std::span<const float> priorities, std::span<const float> all,
                                 std::span<const run::ClusterInstance> expected) {
  TRY_LET(cut, renderer.read_cut());
  if (std::string text = find_culled_fault({*cut, priorities}, {expected, all}); !text.empty()) return text;
  const bool is_same_cut = cut->size() == expected.size();
  if (is_same_cut && std::equal(all.begin(), all.end(), priorities.begin())) return std::string();
  const std::vector<run::ClusterInstance> whole = run::select_flat(asset, camera, pixel_error);
  TRY_LET(picture, draw::draw_cut(asset, whole, camera, *renderer.scene().alpha_masks));
  std::vector<std::uint32_t> seen;
  for (const std::uint32_t item : picture->item) {
    if (item == draw::VisibilityBuffer::kNothing) continue;
    seen.push_back(asset.groups()[asset.clusters()[whole[item].cluster.value].coarser_group].page);
  }
  if (std::string text = find_unasked_page(priorities, seen); !text.empty()) return text;
  return is_same_cut ? std::string() : compare_picture(renderer, asset, camera, *cut, expected);
}

std::vector<run::ClusterInstance> select_resident(const run::Asset& asset, const run::ResidentQuery& query,
                                                  run::ResidentSelector& selector) {
  std::vector<run::ClusterInstance> out(asset.clusters().size());
  for (std::size_t count = 0; (count = selector.select(run::tables_of(asset), query, out)) != out.size();) {
    out.resize(count);
  }
  return out;
}

/// From far to close. Three of four look past the scene, so that some or all of it is outside.
std::vector<NamedCamera> stream_cameras(const run::Asset& asset, std::uint32_t count, PictureSize size) {
  std::vector<NamedCamera> out = orbit_cameras(asset, count, size.width, size.height);
  std::reverse(out.begin(), out.end());
  for (std::size_t i = 0; i < out.size(); ++i) {
    run::Camera& camera = out[i].camera;
    const Vec3d ahead = camera.target - camera.eye;
    camera.target += 0.3 * static_cast<double>(i % 4) * Vec3d(ahead.z, 0.0, -ahead.x);
  }
  return out;
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
  drawing.streams = true;
  drawing.double_sided = scene->has_double_sided;
  drawing.alpha_mask = scene->has_alpha_mask;
  TRY_LET(culling, draw::Renderer::make(*device, *scene, drawing));
  drawing.frustum = false;  // so that the whole cut is compared
  TRY_LET(renderer, draw::Renderer::make(*device, *scene, drawing));
  draw::PagePool pool(*device, asset, renderer->scene());
  run::ResidentSelector selector(run::tables_of(asset));
  const std::vector<NamedCamera> cameras = stream_cameras(asset, options.frames, options.size);
  SplitMix64 random(1);
  for (const NamedCamera& named : cameras) {
    TRY_LET(depth, draw::depth_of_scene(asset, named.camera));
    const std::vector<run::ClusterInstance> expected =
        select_resident(asset, {named.camera, pixel_error, pool.resident(), nullptr}, selector);
    TRY_LET(frame, renderer->draw(named.camera, pixel_error, *depth));
    TRY_LET(all, pool.read_priorities());
    TRY_LET(fault, judge_frame(*renderer, asset, named.camera, pixel_error, *all, expected, selector));
    TRY_LET(culled, culling->draw(named.camera, pixel_error, *depth));
    TRY_LET(priorities, pool.read_priorities());
    if (fault->empty()) {
      TRY_LET(other, judge_culled(*culling, asset, named.camera, pixel_error, *priorities, *all, expected));
      fault = std::move(other);
    }
    const std::uint32_t overflow = frame->overflow | culled->overflow;
    if (overflow != 0) *fault = "overflow of " + draw::describe_overflow(overflow);
    if (!fault->empty() && out.check.failures++ == 0) {
      out.check.first = "frame " + std::to_string(out.frames) + ": " + *fault;
    }
    ++out.frames;
    bool lacks_page = false;
    for (std::size_t page = 0; page < all->size(); ++page) {
      const bool is_wanted = (*priorities)[page] > 0.0F;
      out.spared += (*all)[page] > 0.0F && !is_wanted ? 1 : 0;
      lacks_page = lacks_page || (is_wanted && (pool.resident()[page / 32] >> page % 32 & 1U) == 0);
    }
    out.incomplete += lacks_page ? 1 : 0;
    TRY(pool.load_pages(*priorities, options.loads_per_frame));
    // Loads by priority bring coarser pages first; without this no group would lack the page of a coarser one.
    if (out.frames % 3 == 0) TRY(pool.drop(static_cast<std::uint32_t>(random.below(out.slots))));
  }
  out.loads = pool.loads();
  out.check.items = out.frames;
  out.check.what = "from a pool of " + std::to_string(out.slots) + " of " + std::to_string(out.pages) +
                   " pages the cut, requests and each pixel are the CPU's, culled too; " + std::to_string(out.loads) +
                   " loads, " + std::to_string(out.incomplete) + " frames lacked a page, culling spared " +
                   std::to_string(out.spared) + " requests";
  return out;
}

}  // namespace meshlode::judge
