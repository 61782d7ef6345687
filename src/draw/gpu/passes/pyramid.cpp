// SPDX-License-Identifier: GPL-3.0-or-later
// The farthest depths of the first round, by which the second one is culled. The next frame's first round is tested
// against this pyramid too: what the second round drew is not in it, so it hides less than it could, never more. One
// more pyramid costs more than the few clusters that it would hide.
#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

const Pass kPyramidPass = {
    .name = "pyramid",
    .shader = "pyramid.comp",
    .runs = [](const RendererOptions& options, Round round) { return options.occlusion && round == Round::kFirst; },
    .record =
        [](const PassRecorder& to) {
          to.dispatch(((to.frame.width + 63) / 64) * ((to.frame.height + 63) / 64), to.push());
        },
};

}  // namespace meshlode::draw
