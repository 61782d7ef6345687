// SPDX-License-Identifier: GPL-3.0-or-later
// The BVH of all visible instances by the LOD rule, a dispatch a depth.
#include <algorithm>

#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

const Pass kTraversePass = {
    .name = "traverse",
    .shader = "traverse.comp",
    .runs = [](const RendererOptions& o, Round round) { return round != Round::kInOrder && !is_persistent(o, round); },
    .record =
        [](const PassRecorder& to) {
          Push push = to.push();
          // The leaves of the last depth are tested with the nodes above them.
          for (; push.depth < std::max(to.scene.bvh_depth, 2U) - 1; ++push.depth) {
            if (push.depth > 0) to.list.barrier();
            to.dispatch_indirect(STAGE_QUEUE + MAX_DEPTH * push.pass + push.depth, push);
          }
        },
};

}  // namespace meshlode::draw
