// SPDX-License-Identifier: GPL-3.0-or-later
// Roots of a few pixels, from those that the renderer decoded once. As all rasterizers it writes pixels by atomicMax
// alone, so it waits for no other.
#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

const Pass kFarPass = {
    .name = "far",
    .shader = "raster_far.comp",
    .runs = [](const RendererOptions& options, Round) { return has_far_raster(options); },
    .record =
        [](const PassRecorder& to) {
          Push push = to.push();
          push.a = to.round == Round::kInOrder ? 1 : 0;  // all items are at the front, and its own are marked
          to.dispatch_indirect(STAGE_HARDWARE + to.second(), push);
        },
    .waits = false,
    .masked = "raster_far_mask.comp",
};

}  // namespace meshlode::draw
