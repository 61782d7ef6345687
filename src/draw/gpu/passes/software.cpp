// SPDX-License-Identifier: GPL-3.0-or-later
// The software rasterizer: every item that is not the hardware's or a far root, a workgroup each.
#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

const Pass kSoftwarePass = {
    .name = "software",
    .shader = "raster.comp",
    .runs = [](const RendererOptions&, Round) { return true; },
    .record = [](const PassRecorder& to) { to.dispatch_indirect(STAGE_SOFTWARE + to.second(), to.push()); },
    .masked = "raster_mask.comp",
};

}  // namespace meshlode::draw
