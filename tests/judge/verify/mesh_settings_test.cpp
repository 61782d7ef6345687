// SPDX-License-Identifier: GPL-3.0-or-later
// Each mesh is held to its own settings where the asset says that it has some.
#include <algorithm>
#include <set>
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

/// Two spheres with smooth normals; the second is coarser, of another tier, and without its normals.
scene::Scene two_spheres() {
  const auto sphere = [](const char* name) {
    return lab::as_mesh(lab::with_smooth_normals(lab::make_sphere(10)), name);
  };
  scene::Scene scene = lab::as_scene(sphere("first"));
  scene.meshes.push_back(sphere("second"));
  scene.instances.emplace_back().mesh = MeshId(1U);
  return scene;
}

std::vector<std::uint8_t> build_apart(const scene::Scene& scene) {
  builder::PipelineOptions options;
  options.position_error = 0.001;
  options.mesh_options.assign(2, options);
  options.mesh_options[1].position_error = 0.05;
  options.mesh_options[1].error_tier = format::ErrorTier::kCertified;
  options.mesh_options[1].drop = kAttributeNormal;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes) << bytes.error().message();
  return bytes ? std::move(*bytes) : std::vector<std::uint8_t>{};
}

std::set<std::string> rules_found(const std::vector<std::uint8_t>& bytes, const scene::Scene& scene) {
  const auto asset = run::Asset::from_vector(bytes);
  EXPECT_TRUE(asset) << asset.error().message();
  const VerifyReport report = verify_asset(*asset, scene, {.uniform_cuts = 3, .cameras = 3});
  std::set<std::string> rules;
  for (const Finding& finding : report.findings) rules.insert(finding.id);
  return rules;
}

TEST(MeshSettings, MeshesAreHeldToTheirOwn) {
  const scene::Scene scene = two_spheres();
  const std::vector<std::uint8_t> bytes = build_apart(scene);
  EXPECT_TRUE(rules_found(bytes, scene).empty()) << *rules_found(bytes, scene).begin();
}

/// Taken for the first mesh's, they are wrong in all they say, and so are the whole's for the second.
TEST(MeshSettings, OfAnotherMeshAreFound) {
  const scene::Scene scene = two_spheres();
  test::AssetEdit edit(build_apart(scene));
  const std::string from = R"("meshes":[1])";
  const auto found = std::search(edit.bytes().begin(), edit.bytes().end(), from.begin(), from.end());
  ASSERT_NE(found, edit.bytes().end());
  found[static_cast<std::ptrdiff_t>(from.size()) - 2] = '0';
  edit.seal();
  const std::set<std::string> rules = rules_found(edit.bytes(), scene);
  EXPECT_TRUE(rules.contains("V110")) << "the second one's normals are missing";
  EXPECT_TRUE(rules.contains("V112")) << "the tiers are exchanged";
  EXPECT_TRUE(rules.contains("V113")) << "the second one moved farther than the whole may";
}

}  // namespace
}  // namespace meshlode::judge
