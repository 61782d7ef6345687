// SPDX-License-Identifier: GPL-3.0-or-later
// The same in one dispatch with a queue. The second round has next to nothing to do at each depth, where a dispatch for
// each costs 0.008 to 0.013 ms a frame (docs/log/gpu.md).
#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

bool is_persistent(const RendererOptions& options, Round round) {
  return options.persistent || round == Round::kSecond;
}

std::uint32_t queue_parts(const RendererOptions& options) {
  return options.occlusion && !options.persistent ? 3 : 2;
}

const Pass kPersistentPass = {
    .name = "traverse",
    .shader = "persistent.comp",
    .runs = [](const RendererOptions& options,
               Round round) { return round != Round::kInOrder && is_persistent(options, round); },
    .record =
        [](const PassRecorder& to) {
          // More than any device runs at once do no harm: they find nothing. What last frame's depth hid is little
          // work.
          constexpr std::uint32_t kGroups = 1024, kSecondGroups = 256;
          Push push = to.push();
          push.a = queue_parts(to.options) - 1;
          to.dispatch(to.round == Round::kFirst ? kGroups : kSecondGroups, push);
        },
};

}  // namespace meshlode::draw
