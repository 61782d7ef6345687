// SPDX-License-Identifier: GPL-3.0-or-later
// The frame: instances → BVH traversal with the LOD rule → clusters → software and hardware rasterizers → depth
// pyramid, and with occlusion culling once more for what last frame's depth had hidden. The passes are in passes/;
// which of them run is the plan's decision.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "draw/gpu/gpu_scene.h"
#include "draw/gpu/shaders/frame.h"
#include "draw/gpu/vulkan/vulkan.h"
#include "draw/raster/raster.h"
#include "run/select/select.h"

namespace meshlode::draw {

/// How clusters that are wide on the screen, or cross the near plane, are drawn.
enum class HardwarePath : std::uint8_t {
  kNone,    ///< in software as all others: the only way that is bit for bit the CPU's
  kVertex,  ///< vertex pulling, on any device
  kMesh,    ///< mesh shaders, where the device has them
};

struct RendererOptions {
  std::uint32_t width = 0, height = 0;
  bool frustum = true;
  bool occlusion = false;
  bool double_sided = false;  ///< some material is; where none is, nobody looks
  bool alpha_mask = false;    ///< some sample of a masked material may be missing: without, they are drawn opaque
  bool persistent = false;    ///< the BVH in one dispatch with a queue, in the first round too
  bool streams = false;   ///< the scene has a pool of pages (page_pool.h); far roots are not drawn from decoded ones
  bool overdraw = false;  ///< count how often each pixel is drawn, for that view
  HardwarePath hardware = HardwarePath::kNone;
  float hardware_pixels = 256.0F;      ///< a cluster wider than this on the screen is the hardware's; 0: all are
  std::uint32_t max_items = 1u << 22;  ///< of each list, at most; lists are no longer than the scene can fill
};

struct FrameReport {
  std::vector<Commands::Time> times;
  std::uint32_t visible_instances = 0;
  std::uint32_t open_groups = 0;
  std::uint32_t items = 0;  ///< clusters drawn, both passes
  std::uint32_t second_pass_items = 0;
  std::uint32_t hardware_items = 0;
  std::uint32_t far_items = 0;  ///< roots of a few pixels
  std::uint32_t clipped_items = 0;
  std::uint32_t traversed_nodes = 0;  ///< that were open: their children were tested
  std::uint32_t not_finite = 0;
  std::uint32_t overflow = 0;  ///< OVERFLOW_…: the picture is not complete
};
/// "": nothing overflowed; else which list.
[[nodiscard]] std::string describe_overflow(std::uint32_t overflow);

enum class Round : std::uint8_t;  // passes/pass.h
struct Pass;

class Renderer {
 public:
  /// Errors: kUnsupported where the device has no room.
  [[nodiscard]] static Result<Renderer> make(Device device, GpuScene scene, const RendererOptions& options);

  /// Another picture size; the pipelines stay.
  [[nodiscard]] Status resize(std::uint32_t width, std::uint32_t height);

  /// One frame. `scene_depth` as in make_gpu_camera(). An overflow is reported, not an error.
  [[nodiscard]] Result<FrameReport> draw(const run::Camera& camera, double pixel_error, double scene_depth);

  /// What the last frame drew, ascending.
  [[nodiscard]] Result<std::vector<run::ClusterInstance>> read_cut();
  /// Draws what the last frame drew again, with items in ascending order, so that equal depths resolve as on the CPU;
  /// then the picture's items are indices into read_cut().
  [[nodiscard]] Status redraw_in_order();
  [[nodiscard]] Result<VisibilityBuffer> read_pixels();
  /// The last picture as it is, not drawn again; items are indices into read_cut().
  [[nodiscard]] Result<VisibilityBuffer> read_pixels_of_cut();
  /// The last picture in colours: materials, normals and colours at each pixel's own barycentrics, and the textures
  /// that upload_textures() gave the scene. `view` is a VIEW_… of shaders/frame.h; those of a frame's passes are lost
  /// by redraw_in_order().
  struct Resolved {
    Image image;
    double milliseconds = 0.0;
  };
  [[nodiscard]] Result<Resolved> resolve(std::uint32_t view, std::uint32_t level_count);
  /// The views that the last frame's instances were given, by slot (for tests).
  [[nodiscard]] Result<std::vector<GpuVisible>> read_visible();

  [[nodiscard]] const GpuScene& scene() const { return scene_; }
  [[nodiscard]] const RendererOptions& options() const { return options_; }
  [[nodiscard]] std::uint64_t list_bytes() const;  ///< of every buffer that depends on camera or size

 private:
  void set_capacities();
  [[nodiscard]] std::uint32_t place_pyramid();
  [[nodiscard]] Status make_buffers();
  void set_addresses();
  [[nodiscard]] std::array<std::uint32_t, 10> specialization() const;
  [[nodiscard]] Result<Pipeline> make_pipeline(const Pass& pass);
  void record_begin(Commands& list);
  [[nodiscard]] Status record_round(Commands& list, Round round);
  [[nodiscard]] Status record();
  [[nodiscard]] Status clear_lists();
  [[nodiscard]] Status decode_roots();
  [[nodiscard]] Result<GpuCounters> read_counters();
  struct Item {
    run::ClusterInstance key;
    std::uint32_t slot = 0;   ///< and its marks
    std::uint32_t place = 0;  ///< in the list, which is what pixels name
  };
  [[nodiscard]] Result<std::vector<Item>> read_items();

  Device device_;
  GpuScene scene_;
  RendererOptions options_;
  GpuFrame frame_{};
  GpuCounters counters_{};  ///< as every frame begins
  Buffer frame_block_, counters_block_, upload_;
  Buffer visible_, queue_, open_groups_, items_, retry_nodes_, retry_clusters_, retry_instances_, clipped_, pixels_,
      pyramid_, overdraw_, colors_;
  std::vector<Pipeline> pipelines_;  ///< of the passes; empty where one does not run
  Pipeline sort_;
  std::vector<Commands> lists_;  ///< 0: the frame, 1: drawing in order
  bool has_last_ = false;
};

}  // namespace meshlode::draw
