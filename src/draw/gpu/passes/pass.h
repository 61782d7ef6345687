// SPDX-License-Identifier: GPL-3.0-or-later
// The passes of a frame, each a file of this folder: when it runs, and which dispatches it records. Renderer makes
// their pipelines and walks along them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "draw/gpu/push.h"
#include "draw/gpu/renderer.h"

namespace meshlode::draw {

/// Each time that the passes are walked along.
enum class Round : std::uint8_t {
  kFirst,    ///< by the depth of the frame before, where occlusion culling is on
  kSecond,   ///< what that had hidden, by the depth of this frame: with occlusion culling alone
  kInOrder,  ///< the rasterizers again, over the last frame's items in ascending order
};

/// Where a stage's arguments lie among the counters.
constexpr std::uint64_t arguments_of(std::uint32_t stage) {
  return offsetof(GpuCounters, stages) + sizeof(GpuStage) * stage + offsetof(GpuStage, x);
}

/// What a pass records by.
struct PassRecorder {
  Commands& list;
  const Pipeline& pipeline;
  Round round;
  const RendererOptions& options;
  const GpuScene& scene;
  const GpuFrame& frame;
  const Buffer& frame_block;
  const Buffer& counters;

  /// The arguments that all passes have.
  [[nodiscard]] Push push() const { return {frame_block.address(), round == Round::kSecond ? 1U : 0U}; }
  /// 1 in the second round: of stages that have two.
  [[nodiscard]] std::uint32_t second() const { return push().pass; }
  void dispatch(std::uint32_t groups, const Push& push) const { list.dispatch(pipeline, bytes_of(push), groups); }
  void dispatch_indirect(std::uint32_t stage, const Push& push) const {
    list.dispatch_indirect(pipeline, bytes_of(push), counters, arguments_of(stage));
  }
};

struct Pass {
  const char* name;    ///< of its time
  const char* shader;  ///< of all_shaders(); null where `make` knows
  bool (*runs)(const RendererOptions& options, Round round);
  void (*record)(const PassRecorder& to);
  bool waits = true;             ///< for all that was recorded before it
  const char* masked = nullptr;  ///< the shader with the alpha test, where it has another
  /// Instead of a compute pipeline.
  Result<Pipeline> (*make)(Device& device, const RendererOptions& options,
                           std::span<const std::uint32_t> constants) = nullptr;
};

extern const Pass kInstancesPass, kTraversePass, kPersistentPass, kClustersPass, kSoftwarePass, kFarPass, kClippedPass,
    kHardwarePass, kPyramidPass;

/// The BVH by one dispatch with a queue instead of one a depth.
inline bool is_persistent(const RendererOptions& o, Round round) {
  return o.persistent || round == Round::kSecond;
}
/// The dispatches of single depths fill two parts of the queue in turn; the persistent traversal keeps one of its own
/// empty.
inline std::uint32_t queue_parts(const RendererOptions& o) {
  return o.occlusion && !o.persistent ? 3 : 2;
}
/// Roots of a few pixels have a rasterizer of their own. With hardware raster every cluster is asked for its size on
/// the screen; of a pool the decoded roots could be evicted.
inline bool has_far_raster(const RendererOptions& o) {
  return o.hardware == HardwarePath::kNone && !o.streams;
}

}  // namespace meshlode::draw
