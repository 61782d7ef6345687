// SPDX-License-Identifier: GPL-3.0-or-later
// Clusters that are wide on the screen, or cross the near plane, by the device's rasterizer. Drawn in order all items
// are the software's.
#include "draw/gpu/passes/pass.h"
#include "draw/gpu/shaders.h"

namespace meshlode::draw {

const Pass kHardwarePass = {
    .name = "hardware",
    .shader = nullptr,
    .runs = [](const RendererOptions& options,
               Round round) { return options.hardware != HardwarePath::kNone && round != Round::kInOrder; },
    .record =
        [](const PassRecorder& to) {
          const Push push = to.push();
          const std::uint64_t arguments = to.options.hardware == HardwarePath::kMesh
                                              ? arguments_of(STAGE_HARDWARE + push.pass)
                                              : arguments_of(STAGE_DRAW + push.pass) - offsetof(GpuStage, x);
          to.list.draw_indirect(to.pipeline, bytes_of(push), to.counters, arguments, to.frame.width, to.frame.height);
        },
    .waits = false,
    .make = [](Device& device, const RendererOptions& options,
               std::span<const std::uint32_t> constants) -> Result<Pipeline> {
      const bool is_mesh = options.hardware == HardwarePath::kMesh;
      if (is_mesh && !device.info().has_mesh_shaders) {
        return Error{ErrorCode::kUnsupported, device.info().name, "no mesh shaders"};
      }
      constexpr const char* kFragments[] = {"hardware.frag", "hardware_mesh.frag", "hardware_mask.frag",
                                            "hardware_mesh_mask.frag"};
      return device.make_draw(find_shader(is_mesh ? "hardware.mesh" : "hardware.vert"),
                              find_shader(kFragments[(options.alpha_mask ? 2 : 0) + (is_mesh ? 1 : 0)]), constants,
                              is_mesh);
    },
};

}  // namespace meshlode::draw
