// SPDX-License-Identifier: GPL-3.0-or-later
// One line that says what a build decided by its scene.
#include "app/batch/work/decided.h"

#include <vector>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

TEST(Decided, SaysWhatIsKeptByWhichMeshesAndUnderWhichSettings) {
  builder::PipelineOptions options;
  EXPECT_EQ(describe_decided(options, {}),
            "attributes none but positions; aggregates: no mesh (--aggregate masked); codec strips; promise position");
  std::vector<builder::PlanDecision> decisions(5);
  decisions[0] = {"mesh 0: NORMAL", true, "shaded", false, "NORMAL"};
  decisions[1] = {"mesh 1: NORMAL", false, "flat", false, "NORMAL"};
  decisions[2] = {"mesh 0: TEXCOORD_0", true, "sampled", false, "TEXCOORD_0"};
  decisions[3] = {"mesh 1: aggregate", true, "4000 pieces", false};
  decisions[4] = {"mesh 1: TEXCOORD_1", false, "no material samples it", false, "TEXCOORD_1"};
  options.codec = format::Codec::kNone;
  options.promise = format::Promise::kTexels;
  options.aggregate = AggregateChoice::kAuto;
  EXPECT_EQ(describe_decided(options, decisions),
            "attributes NORMAL of some meshes, TEXCOORD_0; aggregates: 1 mesh (--aggregate auto); codec none; promise "
            "texels");
}

}  // namespace
}  // namespace meshlode::app
