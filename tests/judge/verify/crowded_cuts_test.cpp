// SPDX-License-Identifier: GPL-3.0-or-later
// Edges of cuts with more than two triangles: told of any asset, and a finding (V207) where it says that it keeps
// topology and a cut has more than level 0.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "judge/validate/edit.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"

namespace meshlode::judge {
namespace {

/// Tori as thin as threads: their tubes fold together on coarse levels.
scene::Scene threads() {
  return lab::as_scene(lab::as_mesh(lab::make_torus(300, 8, 1.0, 0.01)));
}

std::vector<std::uint8_t> build_threads(bool keep_topology) {
  builder::PipelineOptions options;
  options.error_tier = format::ErrorTier::kQem;
  options.keep_topology = keep_topology;
  options.max_cluster_triangles = 64;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(threads(), options, {}, report);
  EXPECT_TRUE(bytes) << bytes.error().message();
  return bytes ? std::move(*bytes) : std::vector<std::uint8_t>{};
}

VerifyReport verify_bytes(const std::vector<std::uint8_t>& bytes, std::uint32_t cuts = 40) {
  const auto asset = run::Asset::from_vector(bytes);
  EXPECT_TRUE(asset) << asset.error().message();
  return verify_asset(*asset, threads(), {.uniform_cuts = cuts, .cameras = 3});
}

/// The same file, which now says that it was built with --keep-topology.
std::vector<std::uint8_t> with_promise(const std::vector<std::uint8_t>& bytes) {
  test::AssetEdit edit(bytes);
  const std::string from = "\"cluster_vertices\":256", to = "\"keep_topology\" : true";
  EXPECT_EQ(from.size(), to.size());
  const auto found = std::search(edit.bytes().begin(), edit.bytes().end(), from.begin(), from.end());
  EXPECT_NE(found, edit.bytes().end());
  if (found != edit.bytes().end()) std::copy(to.begin(), to.end(), found);
  edit.seal();
  return edit.bytes();
}

TEST(CrowdedCuts, AreToldWhereNothingIsPromised) {
  const VerifyReport report = verify_bytes(build_threads(false));
  EXPECT_EQ(report.finding_count, 0U);
  ASSERT_TRUE(report.crowded_edges.has_value());
  EXPECT_EQ(report.crowded_edges->level0, 0U);
  EXPECT_GT(report.crowded_edges->most, 0U) << "or the other tests say nothing";
  EXPECT_FALSE(report.crowded_edges->keeps_topology);
  EXPECT_FALSE(verify_bytes(build_threads(false), 0).crowded_edges->most > 0);
}

TEST(CrowdedCuts, AreAFindingWhereTopologyIsSaidToBeKept) {
  const VerifyReport report = verify_bytes(with_promise(build_threads(false)));
  EXPECT_GT(report.finding_count, 0U);
  for (const Finding& finding : report.findings) EXPECT_EQ(finding.id, "V207") << finding.where << finding.detail;
  EXPECT_TRUE(report.crowded_edges->keeps_topology);
}

TEST(CrowdedCuts, AreNotThereWhereTopologyIsKept) {
  const VerifyReport report = verify_bytes(build_threads(true));
  EXPECT_EQ(report.finding_count, 0U);
  ASSERT_TRUE(report.crowded_edges.has_value());
  EXPECT_TRUE(report.crowded_edges->keeps_topology);
  EXPECT_GT(report.crowded_edges->cuts, 5U);
  EXPECT_EQ(report.crowded_edges->most, 0U);
}

}  // namespace
}  // namespace meshlode::judge
