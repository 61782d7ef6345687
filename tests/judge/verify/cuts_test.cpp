// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts as a cross-check: a selection that is wrong in one way is found by the rule for that way.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "judge/validate/edit.h"
#include "judge/validate/judged_sample.h"
#include "judge/verify/cuts.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace meshlode::judge {
namespace {

class CutChecks : public testing::Test {
 protected:
  CutChecks()
      : asset_(std::move(*run::Asset::from_vector(test::judged_sample_bytes()))),
        clusters_(std::move(*run::decode_all(asset_))) {
    for (std::uint32_t m = 0; m < asset_.meshes().size(); ++m)
      judges_.push_back(make_mesh_judge(asset_, MeshId(m), clusters_));
  }

  RuleLog check_cameras_with(const Selectors& selectors) {
    RuleLog log;
    totals_ = check_cameras(asset_, judges_, 50, 7, log, selectors);
    return log;
  }
  RuleLog check_uniform_with(const Selectors& selectors) {
    RuleLog log;
    for (const MeshJudge& judge : judges_) check_uniform_cuts(asset_, judge, 40, log, selectors);
    return log;
  }

  run::Asset asset_;
  std::vector<run::DecodedCluster> clusters_;
  std::vector<MeshJudge> judges_;
  CameraTotals totals_;
};

TEST_F(CutChecks, TheRealSelectionPasses) {
  EXPECT_EQ(check_cameras_with({}).finding_count(), 0U);
  EXPECT_EQ(totals_.cameras, 50U);
  EXPECT_EQ(totals_.cuts, 50U * 4U);  // five instances, one of them singular
  EXPECT_EQ(check_uniform_with({}).finding_count(), 0U);
}

TEST_F(CutChecks, AClusterLeftOutIsAHole) {
  Selectors wrong;
  wrong.flat = [](const run::Asset& asset, const run::Camera& camera, double t) {
    auto cut = run::select_flat(asset, camera, t);
    cut.pop_back();
    return cut;
  };
  wrong.bvh = wrong.flat;
  const RuleLog log = check_cameras_with(wrong);
  EXPECT_GT(log.count_of(Rule::kV201), 0U);
  EXPECT_EQ(log.count_of(Rule::kV203), 0U);
}

TEST_F(CutChecks, AHoleInAClosedMeshIsABorder) {
  Selectors wrong;
  wrong.flat = [](const run::Asset& asset, const run::Camera& camera, double t) {
    auto cut = run::select_flat(asset, camera, t);
    const auto ball =
        std::find_if(cut.begin(), cut.end(), [](const run::ClusterInstance& c) { return c.instance.value == 1; });
    cut.erase(ball);
    return cut;
  };
  const RuleLog log = check_cameras_with(wrong);
  EXPECT_GT(log.count_of(Rule::kV203), 0U);
  // Where the ball is its one root, what is left is empty, and closed: coverage sees it.
  EXPECT_GT(log.count_of(Rule::kV202), 0U);
  EXPECT_EQ(log.count_of(Rule::kV201), 50U);
}

TEST_F(CutChecks, AClusterDrawnOverItsOwnFinerOnesIsAnOverlap) {
  Selectors wrong;
  wrong.uniform = [](const run::Asset& asset, MeshId mesh, double error) {
    run::UniformCut cut = run::select_uniform(asset, mesh, error);
    const auto& record = asset.meshes()[mesh.value];
    const ClusterId root(record.first_cluster);
    if (cut.clusters.empty() || cut.clusters[0] != root) cut.clusters.insert(cut.clusters.begin(), root);
    return cut;
  };
  const RuleLog log = check_uniform_with(wrong);
  EXPECT_GT(log.count_of(Rule::kV201), 0U);
  EXPECT_GT(log.count_of(Rule::kV204), 0U);
}

TEST_F(CutChecks, AnEmptyCutIsFound) {
  Selectors wrong;
  wrong.uniform = [](const run::Asset&, MeshId, double) { return run::UniformCut{}; };
  EXPECT_GT(check_uniform_with(wrong).count_of(Rule::kV201), 0U);
}

TEST_F(CutChecks, AnotherThresholdIsNotTheRule) {
  Selectors wrong;
  wrong.flat = [](const run::Asset& asset, const run::Camera& camera, double t) {
    return run::select_flat(asset, camera, t * 1.5);
  };
  wrong.bvh = wrong.flat;
  const RuleLog log = check_cameras_with(wrong);
  EXPECT_GT(log.count_of(Rule::kV204), 0U);
  EXPECT_EQ(log.count_of(Rule::kV201), 0U);  // the cut is whole, only not the one that was asked for
  EXPECT_EQ(log.count_of(Rule::kV202), 0U);
}

/// The sample so small at so far a place that no double lies between its corners there: every instance scaled by 2^-k,
/// with 30 for each translation.
run::Asset shrink_at_30(int k) {
  test::AssetEdit edit(test::judged_sample_bytes());
  for (std::uint32_t i = 0; i < edit.instances().size(); ++i) {
    edit.instance(i, [&](auto& instance) {
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          instance.transform[4 * row + column] = std::ldexp(instance.transform[4 * row + column], -k);
        }
        instance.transform[4 * row + 3] = 30.0;
      }
      instance.scale = std::ldexp(instance.scale, -k);
    });
  }
  edit.seal();
  return std::move(*run::Asset::from_vector(edit.bytes()));
}

/// From 2^-40 of the distance to 2^-140: what is drawn is right, and another rule is not.
TEST_F(CutChecks, AnInstanceThatItsPlaceSwallowsIsJudgedByItsShape) {
  Selectors wrong;
  wrong.flat = [](const run::Asset& asset, const run::Camera& camera, double t) {
    return run::select_flat(asset, camera, t * 1.5);
  };
  wrong.bvh = wrong.flat;
  for (const int k : {30, 40, 50, 55, 60, 70, 90, 140}) {
    SCOPED_TRACE(k);
    const run::Asset tiny = shrink_at_30(k);
    RuleLog log, other;
    const CameraTotals totals = check_cameras(tiny, judges_, 200, 7, log);
    EXPECT_EQ(log.finding_count(), 0U);
    EXPECT_LT(totals.too_close * 100, totals.decisions) << "nearly all is decided";
    check_cameras(tiny, judges_, 200, 7, other, wrong);
    EXPECT_GT(other.count_of(Rule::kV204), 0U) << "a fault of the same size is found";
  }
}

/// A mesh that is authored far away and brought back: what is left of its place by the difference of two large numbers
/// is as wrong as they were rounded, and no more is held against the selection than that.
TEST_F(CutChecks, WhatCancelsIsJudgedAsFarAsDoublesHoldIt) {
  Selectors wrong;
  wrong.flat = [](const run::Asset& asset, const run::Camera& camera, double t) {
    return run::select_flat(asset, camera, t * 1.5);
  };
  wrong.bvh = wrong.flat;
  for (const double far : {0x1p20, 0x1p30, 0x1p44, 0x1p47}) {
    SCOPED_TRACE(far);
    test::AssetEdit edit(test::judged_sample_bytes());
    const Vec3d moved(far, 0.7 * far, -0.3 * far);
    for (std::uint32_t m = 0; m < edit.meshes().size(); ++m) {
      edit.mesh(m, [&](auto& mesh) {
        for (int k = 0; k < 3; ++k) mesh.origin[k] += moved[k];
      });
    }
    for (std::uint32_t i = 0; i < edit.instances().size(); ++i) {
      edit.instance(i, [&](auto& instance) {
        for (int row = 0; row < 3; ++row) {
          double* m = instance.transform + 4 * row;
          m[3] -= m[0] * moved.x + m[1] * moved.y + m[2] * moved.z;
        }
      });
    }
    edit.seal();
    const run::Asset away = std::move(*run::Asset::from_vector(edit.bytes()));
    RuleLog log, other;
    check_cameras(away, judges_, 2000, 7, log);
    EXPECT_EQ(log.count_of(Rule::kV204), 0U);
    check_cameras(away, judges_, 2000, 7, other, wrong);
    EXPECT_GT(other.count_of(Rule::kV204), 0U);
  }
}

TEST_F(CutChecks, AWrongStoredErrorIsFound) {
  Selectors wrong;
  wrong.uniform = [](const run::Asset& asset, MeshId mesh, double error) {
    run::UniformCut cut = run::select_uniform(asset, mesh, error);
    cut.stored_error *= 0.5;
    cut.stored_error -= 1e-30;
    return cut;
  };
  EXPECT_GT(check_uniform_with(wrong).count_of(Rule::kV205), 0U);
}

TEST_F(CutChecks, AHierarchyThatPrunesTooMuchIsFound) {
  test::AssetEdit edit(test::judged_sample_bytes());
  const auto mesh = edit.meshes()[1];
  edit.node(mesh.first_node, [](auto& node) { node.error = 0.0F; });
  edit.seal();
  const run::Asset broken = std::move(*run::Asset::from_vector(edit.bytes()));
  RuleLog log;
  check_cameras(broken, judges_, 20, 1, log);
  EXPECT_GT(log.count_of(Rule::kV203), 0U);
  EXPECT_EQ(log.count_of(Rule::kV201), 0U);  // the flat rule needs no hierarchy
}

TEST_F(CutChecks, ErrorsThatFallMakeACutThatDrawsTwice) {
  // A finer group with a larger error than its coarser one: between the two both sides are drawn, or none.
  test::AssetEdit edit(test::judged_sample_bytes());
  const auto groups = edit.groups();
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    if (groups[g].mesh == 1 && groups[g].level == 0) edit.group(g, [](auto& group) { group.error = 1e6F; });
  }
  edit.seal();
  const run::Asset broken = std::move(*run::Asset::from_vector(edit.bytes()));
  RuleLog log;
  check_uniform_cuts(broken, judges_[1], 40, log);
  EXPECT_GT(log.count_of(Rule::kV201), 0U);
}

TEST_F(CutChecks, AMovedBorderVertexOpensCuts) {
  // The last cluster of the ball's middle level moves by one grid step: its group no longer fits its neighbours.
  test::AssetEdit edit(test::judged_sample_bytes());
  const auto clusters = edit.clusters();
  const auto mesh = edit.meshes()[1];
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    if (clusters[c].level != 1) continue;
    edit.move_minimum(c, 0, 1);
    break;
  }
  edit.seal();
  const run::Asset broken = std::move(*run::Asset::from_vector(edit.bytes()));
  const std::vector<run::DecodedCluster> decoded = std::move(*run::decode_all(broken));
  const MeshJudge judge = make_mesh_judge(broken, MeshId(1U), decoded);
  RuleLog log;
  check_uniform_cuts(broken, judge, 40, log);
  EXPECT_GT(log.count_of(Rule::kV202), 0U);
}

}  // namespace
}  // namespace meshlode::judge
