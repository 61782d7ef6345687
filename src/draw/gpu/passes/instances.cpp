// SPDX-License-Identifier: GPL-3.0-or-later
// Instances that may be seen get a slot; those of which one root alone is open go past the BVH.
#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

const Pass kInstancesPass = {
    .name = "instances",
    .shader = "instances.comp",
    .runs = [](const RendererOptions&, Round round) { return round != Round::kInOrder; },
    .record =
        [](const PassRecorder& to) {
          if (to.round == Round::kSecond) return to.dispatch_indirect(STAGE_RETRY_INSTANCES, to.push());
          to.dispatch((to.scene.instance_count + kGroupSize - 1) / kGroupSize, to.push());
        },
};

}  // namespace meshlode::draw
