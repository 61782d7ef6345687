// SPDX-License-Identifier: GPL-3.0-or-later
// The same in one dispatch with a queue. The second round has next to nothing to do at each depth, where a dispatch for
// each costs 0.008 to 0.013 ms a frame (docs/log/gpu.md).
#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

const Pass kPersistentPass = {
    .name = "traverse",
    .shader = "persistent.comp",
    .runs = [](const RendererOptions& o, Round round) { return round != Round::kInOrder && is_persistent(o, round); },
    .record =
        [](const PassRecorder& to) {
          // More than any device runs at once do no harm: they find nothing. The second round has little work.
          constexpr std::uint32_t kGroups = 1024, kSecondGroups = 256;
          Push push = to.push();
          push.a = queue_parts(to.options) - 1;
          to.dispatch(to.round == Round::kFirst ? kGroups : kSecondGroups, push);
        },
};

}  // namespace meshlode::draw
