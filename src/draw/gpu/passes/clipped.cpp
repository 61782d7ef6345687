// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles that the software rasterizer left because they have to be clipped.
#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

const Pass kClippedPass = {
    .name = "clipped",
    .shader = "raster_clip.comp",
    .runs = [](const RendererOptions&, Round) { return true; },
    .record = [](const PassRecorder& to) { to.dispatch_indirect(STAGE_CLIPPED + to.second(), to.push()); },
    .masked = "raster_clip_mask.comp",
};

}  // namespace meshlode::draw
