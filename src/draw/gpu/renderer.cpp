// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/renderer.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "base/try.h"
#include "draw/gpu/gpu_camera.h"
#include "draw/gpu/push.h"
#include "draw/gpu/shaders.h"

namespace meshlode::draw {

namespace {

constexpr std::uint32_t kPersistentGroups = 1024;  ///< more than any device runs at once do no harm: they find nothing
constexpr std::uint32_t kSecondGroups = 256;       ///< what last frame's depth hid is little work

std::uint64_t arguments_of(std::uint32_t stage) {
  return offsetof(GpuCounters, stages) + sizeof(GpuStage) * stage + offsetof(GpuStage, x);
}

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
  TRY(out.make_pipelines());
  TRY(out.resize(options.width, options.height));
  if (out.has_far_raster()) {
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
      {&queue_, std::uint64_t{f.queue_capacity} * queue_parts() * 8},
      {&open_groups_, std::uint64_t{f.group_capacity} * 8},
      {&items_, std::uint64_t{f.item_capacity} * 8},
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

// With hardware raster every cluster is asked for its size on the screen; flat selection asks every instance.
bool Renderer::has_far() const {
  return options_.far_instances && options_.hardware == HardwarePath::kNone && !options_.flat_selection;
}
// The dispatches of single depths fill two parts in turn; the persistent traversal keeps one of its own empty.
std::uint32_t Renderer::queue_parts() const {
  return options_.occlusion && options_.persistent_second && !options_.persistent ? 3 : 2;
}
bool Renderer::has_far_raster() const {
  return has_far() && options_.far_raster && !options_.streams;
}

Status Renderer::make_pipelines() {
  const bool has_hardware = options_.hardware != HardwarePath::kNone;
  const std::uint32_t frustum = options_.frustum ? 1 : 0, occlusion = options_.occlusion ? 1 : 0;
  const auto room = [](std::uint32_t count) { return std::max((count + 15) / 16 * 16, 16u); };
  const std::array<std::uint32_t, 10> constants = {options_.double_sided ? 1u : 0u,
                                                   frustum,
                                                   occlusion,
                                                   has_hardware ? 1u : 0u,
                                                   options_.raster_group,
                                                   room(scene_.max_cluster_triangles),
                                                   room(scene_.max_cluster_vertices),
                                                   0,
                                                   options_.overdraw ? 1u : 0u,
                                                   options_.streams ? 1u : 0u};
  std::array<std::uint32_t, 10> far_constants = constants;
  far_constants[3] = has_far() ? 1 : 0;
  far_constants[4] = options_.far_lanes;
  far_constants[5] = has_far_raster() ? 1 : 0;
  far_constants[6] = room(scene_.max_root_vertices);
  far_constants[7] = room(scene_.max_root_triangles);
  const bool is_masked = options_.alpha_mask;
  struct Wanted {
    Pipeline* slot;
    std::span<const std::uint32_t> spirv;
  };
  const Wanted wanted[] = {{&instances_, shaders::instances()},
                           {&traverse_, shaders::traverse()},
                           {&persistent_, shaders::persistent()},
                           {&flat_, shaders::flat()},
                           {&clusters_, shaders::clusters()},
                           {&raster_, is_masked ? shaders::raster_mask() : shaders::raster()},
                           {&sort_, shaders::sort()},
                           {&raster_far_, is_masked ? shaders::raster_far_mask() : shaders::raster_far()},
                           {&roots_, shaders::roots()},
                           {&raster_clip_, is_masked ? shaders::raster_clip_mask() : shaders::raster_clip()},
                           {&pyramid_build_, shaders::pyramid()}};
  for (const Wanted& w : wanted) {
    const bool is_far = w.slot == &instances_ || w.slot == &raster_far_;
    TRY_LET(pipeline, device_.make_compute(w.spirv, is_far ? far_constants : constants));
    *w.slot = *pipeline;
  }
  if (!has_hardware) return Ok{};
  const bool is_mesh = options_.hardware == HardwarePath::kMesh;
  if (is_mesh && !device_.info().has_mesh_shaders) {
    return Error{ErrorCode::kUnsupported, device_.info().name, "no mesh shaders"};
  }
  const std::span<const std::uint32_t> fragments[] = {shaders::hardware_frag(), shaders::hardware_mesh_frag(),
                                                      shaders::hardware_mask_frag(),
                                                      shaders::hardware_mesh_mask_frag()};
  TRY_LET(draw, device_.make_draw(is_mesh ? shaders::hardware_mesh() : shaders::hardware_vert(),
                                  fragments[(is_masked ? 2 : 0) + (is_mesh ? 1 : 0)], constants, is_mesh));
  hardware_ = *draw;
  return Ok{};
}

void Renderer::record_begin(Commands& list) {
  list.stamp("begin");
  list.copy(upload_, 0, frame_block_, 0, sizeof(GpuFrame));
  list.copy(upload_, sizeof(GpuFrame), counters_block_, 0, sizeof(GpuCounters));
  list.fill(pixels_, 0, pixels_.bytes(), 0);
  if (options_.streams) list.fill(scene_.priorities, 0, scene_.priorities.bytes(), 0);
  if (options_.overdraw) list.fill(overdraw_, 0, overdraw_.bytes(), 0);
  list.barrier();
  list.stamp("clear");
}

void Renderer::record_selection(Commands& list, std::uint32_t pass) {
  const char* suffix = pass == 0 ? "" : " 2";
  Push push{frame_block_.address(), pass};
  if (pass == 0) {
    list.dispatch(instances_, bytes_of(push), (scene_.instance_count + kGroupSize - 1) / kGroupSize);
  } else {
    list.dispatch_indirect(instances_, bytes_of(push), counters_block_, arguments_of(STAGE_RETRY_INSTANCES));
    push.a = 1;
    list.dispatch_indirect(clusters_, bytes_of(push), counters_block_, arguments_of(STAGE_RETRY_CLUSTERS));
    push.a = 0;
  }
  list.barrier();
  list.stamp(std::string("instances") + suffix);
  if (options_.flat_selection) {
    list.dispatch_indirect(flat_, bytes_of(push), counters_block_, arguments_of(STAGE_SLOTS));
    list.barrier();
  }
  const bool is_persistent = options_.persistent || (pass == 1 && options_.persistent_second);
  if (is_persistent && !options_.flat_selection) {
    push.a = queue_parts() - 1;
    list.dispatch(persistent_, bytes_of(push), pass == 0 ? kPersistentGroups : kSecondGroups);
    push.a = 0;
    list.barrier();
  }
  // The leaves of the last depth are tested with the nodes above them.
  const std::uint32_t depths = options_.flat_selection || is_persistent ? 0 : std::max(scene_.bvh_depth, 2u) - 1;
  for (push.depth = 0; push.depth < depths; ++push.depth) {
    list.dispatch_indirect(traverse_, bytes_of(push), counters_block_,
                           arguments_of(STAGE_QUEUE + MAX_DEPTH * pass + push.depth));
    list.barrier();
  }
  list.stamp(std::string("traverse") + suffix);
  list.dispatch_indirect(clusters_, bytes_of(push), counters_block_, arguments_of(STAGE_GROUPS + pass));
  list.barrier();
  list.stamp(std::string("clusters") + suffix);
}

void Renderer::record_raster(Commands& list, std::uint32_t pass, bool in_order) {
  const Push push{frame_block_.address(), pass, 0, in_order ? 1u : 0u};
  list.dispatch_indirect(raster_, bytes_of(push), counters_block_, arguments_of(STAGE_SOFTWARE + pass));
  if (has_far_raster()) {
    // They write pixels by atomicMax alone, so nobody waits for anybody.
    list.stamp(pass == 0 ? "software" : "software 2");
    list.dispatch_indirect(raster_far_, bytes_of(push), counters_block_, arguments_of(STAGE_HARDWARE + pass));
    list.barrier();
    list.stamp(pass == 0 ? "far" : "far 2");
  } else {
    list.barrier();
    list.stamp(pass == 0 ? "software" : "software 2");
  }
  list.dispatch_indirect(raster_clip_, bytes_of(push), counters_block_, arguments_of(STAGE_CLIPPED + pass));
  if (options_.hardware != HardwarePath::kNone) {
    list.stamp(pass == 0 ? "clipped" : "clipped 2");
    const bool is_mesh = options_.hardware == HardwarePath::kMesh;
    const std::uint64_t arguments =
        is_mesh ? arguments_of(STAGE_HARDWARE + pass) : arguments_of(STAGE_DRAW + pass) - offsetof(GpuStage, x);
    list.draw_indirect(hardware_, bytes_of(push), counters_block_, arguments, frame_.width, frame_.height);
    list.barrier();
    list.stamp(pass == 0 ? "hardware" : "hardware 2");
    return;
  }
  list.barrier();
  list.stamp(pass == 0 ? "clipped" : "clipped 2");
}

void Renderer::record_pyramid(Commands& list) {
  const Push push{frame_block_.address()};
  const std::uint32_t tiles = ((frame_.width + 63) / 64) * ((frame_.height + 63) / 64);
  list.dispatch(pyramid_build_, bytes_of(push), tiles);
  list.barrier();
  list.stamp("pyramid");
}

Status Renderer::record() {
  for (int i = 0; i < 2; ++i) {
    TRY_LET(list, Commands::begin(device_));
    lists_.push_back(*list);
  }
  Commands& list = lists_[0];
  record_begin(list);
  record_selection(list, 0);
  record_raster(list, 0);
  if (options_.occlusion) {
    // The next frame's first pass is tested against this pyramid too: what the second pass drew is not in it, so it
    // hides less than it could, never more. One more pyramid costs more than the few clusters that it would hide.
    record_pyramid(list);
    record_selection(list, 1);
    record_raster(list, 1);
  }
  record_begin(lists_[1]);
  record_raster(lists_[1], 0, true);
  return clear_lists();
}

Status Renderer::decode_roots() {
  if (const Status s = device_.upload(frame_block_, bytes_of(frame_)); !s) return s;
  TRY_LET(list, Commands::begin(device_));
  const Push push{frame_block_.address()};
  list->dispatch(roots_, bytes_of(push), scene_.mesh_count);
  list->barrier();
  TRY(list->run());
  return Ok{};
}

Status Renderer::clear_lists() {
  TRY_LET(clear, Commands::begin(device_));
  if (options_.occlusion)
    clear->fill(pyramid_, 0, pyramid_.bytes(), 0);  // before the first frame nothing hides anything
  // Places that nobody has filled.
  if (options_.persistent || options_.persistent_second) clear->fill(queue_, 0, queue_.bytes(), 0);
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
  (has_far_raster() ? out.far_items : out.hardware_items) = counters->stages[STAGE_HARDWARE].count;
  out.clipped_items = counters->stages[STAGE_CLIPPED].count + counters->stages[STAGE_CLIPPED + 1].count;
  for (std::uint32_t i = STAGE_QUEUE; i < STAGE_COUNT; ++i) out.traversed_nodes += counters->stages[i].count;
  out.not_finite = counters->not_finite;
  out.overflow = counters->overflow;
  for (const std::uint32_t added : counters->added) out.traversed_nodes += added;
  if (out.items > frame_.item_capacity) out.overflow |= OVERFLOW_CLUSTERS;  // both ends together
  if ((options_.persistent || options_.persistent_second) && (out.overflow & OVERFLOW_QUEUE) != 0) {
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
