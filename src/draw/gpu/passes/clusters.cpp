// SPDX-License-Identifier: GPL-3.0-or-later
// The members of open groups that are drawn, and in the second round the clusters that last frame's depth had hidden.
#include "draw/gpu/passes/pass.h"

namespace meshlode::draw {

const Pass kClustersPass = {
    .name = "clusters",
    .shader = "clusters.comp",
    .runs = [](const RendererOptions&, Round round) { return round != Round::kInOrder; },
    .record =
        [](const PassRecorder& to) {
          Push push = to.push();
          to.dispatch_indirect(STAGE_GROUPS + to.second(), push);
          push.a = 1;
          if (to.round == Round::kSecond) to.dispatch_indirect(STAGE_RETRY_CLUSTERS, push);
        },
};

}  // namespace meshlode::draw
