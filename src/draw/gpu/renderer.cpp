// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/renderer.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/try.h"
#include "draw/gpu/gpu_camera.h"
#include "draw/gpu/passes/pass.h"
#include "draw/gpu/shaders.h"

namespace meshlode::draw {

namespace {

static_assert(FRAME_LAYOUT_VERSION == 1, "the frame is filled, and its counters are read, as in this version");

/// In the order of a frame.
constexpr const Pass* kPasses[] = {&kInstancesPass, &kTraversePass, &kPersistentPass, &kClustersPass, &kSoftwarePass,
                                   &kFarPass,       &kClippedPass,  &kHardwarePass,   &kPyramidPass};

std::uint32_t round_up(std::uint64_t value, std::uint64_t limit) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>((value + 63) / 64 * 64, limit));
}

}  // namespace

std::string describe_overflow(std::uint32_t overflow) {
  constexpr std::array kNames = {"visible instances", "traversal queue", "open groups", "visible clusters",
                                 "retried nodes and clusters"};
  std::string out;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if ((overflow >> i & 1u) != 0) out += (out.empty() ? "" : ", ") + std::string(kNames[i]);
  }
  return out;
}

Result<Renderer> Renderer::make(Device device, GpuScene scene, const RendererOptions& options) {
  Renderer out;
  out.device_ = std::move(device);
  out.scene_ = std::move(scene);
  out.options_ = options;
  TRY_LET(sort, out.device_.make_compute(find_shader("sort.comp"), {}));
  out.sort_ = *sort;
  TRY(out.resize(options.width, options.height));
  if (has_far_raster(options)) {
    TRY(out.decode_roots());
  }
  return out;
}

Status Renderer::resize(std::uint32_t width, std::uint32_t height) {
  if (width < 1 || width > 16384 || height < 1 || height > 16384) {
    return Error{ErrorCode::kUsage, "--size", "a picture has 1 to 16384 pixels a side"};
  }
  options_.width = width;
  options_.height = height;
  lists_.clear();
  has_last_ = false;
  if (const Status s = make_buffers(); !s) return s;
  return record();
}

/// As long as the scene can fill them, but not above the limit; all of the device's lists hang on these.
void Renderer::set_capacities() {
  const std::uint64_t limit = std::min<std::uint64_t>(options_.max_items, MAX_ITEMS);
  GpuFrame& f = frame_;
  f.width = options_.width;
  f.height = options_.height;
  f.instance_count = scene_.instance_count;
  f.hardware_pixels = options_.hardware_pixels;
  f.slot_capacity = round_up(scene_.instance_count, limit);
  f.group_capacity = round_up(scene_.group_instances, limit);
  f.queue_capacity = round_up(2 * (scene_.group_instances + scene_.instance_count), limit);  // nodes of one depth
  f.item_capacity = round_up(scene_.cluster_instances, limit);
  f.retry_capacity = options_.occlusion ? round_up(2 * scene_.group_instances + scene_.cluster_instances, limit) : 64;
}

/// Levels of half the size each, one behind the other. Returns their words together.
std::uint32_t Renderer::place_pyramid() {
  GpuFrame& f = frame_;
  std::uint32_t words = 0;
  for (std::uint32_t level = 1; level < MAX_PYRAMID; ++level) {
    const std::uint32_t width = (f.width + (1u << level) - 1) >> level,
                        height = (f.height + (1u << level) - 1) >> level;
    f.pyramid_offset[level] = words;
    words += width * height;
    f.pyramid_levels = level;
    if (width == 1 && height == 1) break;
  }
  return words;
}

Status Renderer::make_buffers() {
  set_capacities();
  const std::uint32_t pyramid_words = place_pyramid();
  const GpuFrame& f = frame_;
  struct Wanted {
    Buffer* slot;
    std::uint64_t bytes;
    Memory memory = Memory::kDevice;
  };
  const Wanted wanted[] = {
      {&frame_block_, sizeof(GpuFrame)},
      {&counters_block_, sizeof(GpuCounters)},
      {&visible_, std::uint64_t{f.slot_capacity} * sizeof(GpuVisible)},
      {&queue_, std::uint64_t{f.queue_capacity} * queue_parts(options_) * 8},
      {&open_groups_, std::uint64_t{f.group_capacity} * 8},
      {&items_, std::uint64_t{f.item_capacity} * sizeof(GpuItem)},
      {&retry_nodes_, std::uint64_t{f.retry_capacity} * 8},
      {&retry_clusters_, std::uint64_t{f.retry_capacity} * 8},
      {&retry_instances_, std::uint64_t{options_.occlusion ? f.instance_count : 1} * 4},
      {&clipped_, std::uint64_t{f.item_capacity} * 4},
      {&pixels_, std::uint64_t{f.width} * f.height * 8},
      {&pyramid_, std::uint64_t{pyramid_words} * 4},
      {&overdraw_, options_.overdraw ? std::uint64_t{f.width} * f.height * 4 : 4},
      {&colors_, std::uint64_t{f.width} * f.height * 4},
      {&upload_, sizeof(GpuFrame) + sizeof(GpuCounters), Memory::kHost},
  };
  for (const Wanted& w : wanted) {
    TRY_LET(buffer, device_.make_buffer(w.bytes, w.memory));
    *w.slot = *buffer;
  }
  set_addresses();
  for (GpuStage& stage : counters_.stages) stage.z = 1;
  for (std::uint32_t pass = 0; pass < 2; ++pass) {
    counters_.stages[STAGE_DRAW + pass] = {3 * scene_.max_cluster_triangles, 0, 0, 0};
  }
  return Ok{};
}

/// Of the scene's buffers and of the frame's own, as the shaders are given them.
void Renderer::set_addresses() {
  GpuFrame& f = frame_;
  f.meshes = scene_.meshes.address();
  f.instances = scene_.instances.address();
  f.nodes = scene_.nodes.address();
  f.groups = scene_.groups.address();
  f.clusters = scene_.clusters.address();
  f.materials = scene_.materials.address();
  f.pages = scene_.pages.address();
  f.page_words = scene_.page_words.address();
  f.ready = scene_.ready.address();
  f.priorities = scene_.priorities.address();
  f.roots = scene_.roots.address();
  f.mesh_uvs = scene_.mesh_uvs.address();
  f.masks = scene_.masks.address();
  f.mask_texels = scene_.mask_texels.address();
  if (scene_.surfaces) {
    f.surfaces = scene_.surfaces.address();
    f.textures = scene_.textures.address();
    f.texels = scene_.texels.address();
  }
  f.visible = visible_.address();
  f.queue = queue_.address();
  f.open_groups = open_groups_.address();
  f.items = items_.address();
  f.retry_nodes = retry_nodes_.address();
  f.retry_clusters = retry_clusters_.address();
  f.retry_instances = retry_instances_.address();
  f.clipped = clipped_.address();
  f.pixels = pixels_.address();
  f.pyramid = pyramid_.address();
  f.overdraw = overdraw_.address();
  f.colors = colors_.address();
  f.counters = counters_block_.address();
}

/// The specialization constants of all shaders, by their ids: each reads those that it has.
std::array<std::uint32_t, 10> Renderer::specialization() const {
  const auto room = [](std::uint32_t count) { return std::max((count + 15) / 16 * 16, 16U); };
  return {options_.double_sided ? 1U : 0U,   options_.frustum ? 1U : 0U,
          options_.occlusion ? 1U : 0U,      options_.hardware != HardwarePath::kNone ? 1U : 0U,
          room(scene_.max_root_vertices),    room(scene_.max_cluster_triangles),
          room(scene_.max_cluster_vertices), room(scene_.max_root_triangles),
          options_.overdraw ? 1U : 0U,       options_.streams ? 1U : 0U};
}

Result<Pipeline> Renderer::make_pipeline(const Pass& pass) {
  if (pass.make != nullptr) return pass.make(device_, options_, specialization());
  const bool is_masked = options_.alpha_mask && pass.masked != nullptr;
  return device_.make_compute(find_shader(is_masked ? pass.masked : pass.shader), specialization());
}

void Renderer::record_begin(Commands& list) {
  list.stamp("begin");
  list.copy(upload_, 0, frame_block_, 0, sizeof(GpuFrame));
  list.copy(upload_, sizeof(GpuFrame), counters_block_, 0, sizeof(GpuCounters));
  list.fill(pixels_, 0, pixels_.bytes(), 0);
  if (options_.streams) list.fill(scene_.priorities, 0, scene_.priorities.bytes(), 0);
  if (options_.overdraw) list.fill(overdraw_, 0, overdraw_.bytes(), 0);
  list.stamp("clear");
}

Status Renderer::record_round(Commands& list, Round round) {
  pipelines_.resize(std::size(kPasses));
  for (std::size_t i = 0; i < pipelines_.size(); ++i) {
    const Pass& pass = *kPasses[i];
    if (!pass.runs(options_, round)) continue;
    if (!pipelines_[i]) {
      TRY_LET(pipeline, make_pipeline(pass));
      pipelines_[i] = *pipeline;
    }
    if (pass.waits) list.barrier();
    pass.record({list, pipelines_[i], round, options_, scene_, frame_, frame_block_, counters_block_});
    list.stamp(std::string(pass.name) + (round == Round::kSecond ? " 2" : ""));
  }
  return Ok{};
}

Status Renderer::record() {
  for (int i = 0; i < 2; ++i) {
    TRY_LET(list, Commands::begin(device_));
    lists_.push_back(*list);
    record_begin(*list);
  }
  TRY(record_round(lists_[0], Round::kFirst));
  if (options_.occlusion) TRY(record_round(lists_[0], Round::kSecond));
  TRY(record_round(lists_[1], Round::kInOrder));
  for (Commands& list : lists_) list.barrier();
  return clear_lists();
}

Status Renderer::decode_roots() {
  if (const Status s = device_.upload(frame_block_, bytes_of(frame_)); !s) return s;
  TRY_LET(list, Commands::begin(device_));
  TRY_LET(roots, device_.make_compute(find_shader("roots.comp"), specialization()));
  const Push push{frame_block_.address()};
  list->dispatch(*roots, bytes_of(push), scene_.mesh_count);
  list->barrier();
  TRY(list->run());
  return Ok{};
}

Status Renderer::clear_lists() {
  TRY_LET(clear, Commands::begin(device_));
  if (options_.occlusion)
    clear->fill(pyramid_, 0, pyramid_.bytes(), 0);  // before the first frame nothing hides anything
  // Places that nobody has filled, of the persistent traversal.
  clear->fill(queue_, 0, queue_.bytes(), 0);
  clear->barrier();
  TRY(clear->run());
  return Ok{};
}

Result<FrameReport> Renderer::draw(const run::Camera& camera, double pixel_error, double scene_depth) {
  TRY_LET(gpu_camera, make_gpu_camera(camera, pixel_error, scene_depth));
  frame_.last = has_last_ ? frame_.camera : *gpu_camera;
  frame_.camera = *gpu_camera;
  has_last_ = true;
  std::memcpy(upload_.mapped(), &frame_, sizeof frame_);
  std::memcpy(upload_.mapped() + sizeof frame_, &counters_, sizeof counters_);
  TRY_LET(times, lists_[0].run());
  TRY_LET(counters, read_counters());
  FrameReport out;
  out.times = std::move(*times);
  out.visible_instances = counters->stages[STAGE_SLOTS].count;
  out.open_groups = counters->stages[STAGE_GROUPS].count + counters->stages[STAGE_GROUPS + 1].count;
  out.items = counters->stages[STAGE_SOFTWARE].count + counters->stages[STAGE_HARDWARE].count;
  if (options_.occlusion)
    out.second_pass_items = out.items - counters->software_before[1] - counters->hardware_before[1];
  (has_far_raster(options_) ? out.far_items : out.hardware_items) = counters->stages[STAGE_HARDWARE].count;
  out.clipped_items = counters->stages[STAGE_CLIPPED].count + counters->stages[STAGE_CLIPPED + 1].count;
  for (std::uint32_t i = STAGE_QUEUE; i < STAGE_COUNT; ++i) out.traversed_nodes += counters->stages[i].count;
  out.not_finite = counters->not_finite;
  out.overflow = counters->overflow;
  for (const std::uint32_t added : counters->added) out.traversed_nodes += added;
  if (out.items > frame_.item_capacity) out.overflow |= OVERFLOW_CLUSTERS;  // both ends together
  if ((out.overflow & OVERFLOW_QUEUE) != 0) {
    TRY(clear_lists());  // places may be left that nobody took
    has_last_ = false;
  }
  return out;
}

std::uint64_t Renderer::list_bytes() const {
  std::uint64_t bytes = 0;
  for (const Buffer* b : {&visible_, &queue_, &open_groups_, &items_, &retry_nodes_, &retry_clusters_,
                          &retry_instances_, &clipped_, &pixels_, &pyramid_}) {
    bytes += b->bytes();
  }
  return bytes;
}

}  // namespace meshlode::draw
