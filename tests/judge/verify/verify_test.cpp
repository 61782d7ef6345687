// SPDX-License-Identifier: GPL-3.0-or-later
// The asset against its source: nothing is found in the sample, and each rule finds the one thing that was changed.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "judge/validate/edit.h"
#include "judge/validate/judged_sample.h"
#include "judge/validate/rules.h"
#include "judge/verify/verify.h"
#include "run/read/asset.h"
#include "support/plate_scene.h"
#include "support/sample_asset.h"

namespace meshlode::judge {
namespace {

using test::AssetEdit;

std::string describe(const VerifyReport& report) {
  std::string text;
  for (const Finding& f : report.findings) text += f.id + ": " + f.where + ": " + f.detail + "\n";
  return text;
}

bool has(const VerifyReport& report, const std::string& id) {
  return std::any_of(report.findings.begin(), report.findings.end(), [&](const Finding& f) { return f.id == id; });
}

VerifyReport verify_bytes(const std::vector<std::uint8_t>& bytes, const scene::Scene& scene,
                          const VerifyOptions& options = {}) {
  Result<run::Asset> asset = run::Asset::from_vector(bytes);
  EXPECT_TRUE(asset.ok()) << asset.error().message();
  return verify_asset(*asset, scene, options);
}

const std::vector<std::uint8_t>& sample() {
  static const std::vector<std::uint8_t> bytes = test::judged_sample_bytes();
  return bytes;
}

TEST(Verify, FindsNothingInTheSample) {
  const VerifyReport report = verify_bytes(sample(), test::sample_scene());
  EXPECT_EQ(report.finding_count, 0U) << describe(report);
  std::set<std::string> invariants;
  for (const VerifyReport::Check& check : report.checks) {
    invariants.insert(check.invariant);
    EXPECT_EQ(check.failures, 0U) << check.what;
    EXPECT_TRUE(check.skipped || check.items > 0) << check.what;
    EXPECT_TRUE(!check.skipped || check.invariant == "I7") << check.what;
  }
  for (const char* id : {"I1", "I2", "I3", "I4", "I5", "I6", "I7", "I8"}) EXPECT_TRUE(invariants.contains(id)) << id;
}

TEST(Verify, CutsAndCamerasAreCounted) {
  const VerifyReport report =
      verify_bytes(sample(), test::sample_scene(), {.uniform_cuts = 17, .cameras = 9, .seed = 5});
  EXPECT_TRUE(std::any_of(report.checks.begin(), report.checks.end(),
                          [](const auto& c) { return c.invariant == "I8" && c.items == 9; }));
}

std::size_t count(const VerifyReport& report, const std::string& id) {
  return static_cast<std::size_t>(
      std::count_if(report.findings.begin(), report.findings.end(), [&](const Finding& f) { return f.id == id; }));
}

/// The plate's asset against the same scene with another plate, looked at from six places.
VerifyReport verify_plate(const std::vector<std::uint8_t>& drawn, const test::PlateSceneOptions& source = {}) {
  return verify_bytes(drawn, test::plate_scene(source), {.uniform_cuts = 2, .cameras = 6, .deviation_cuts = 0});
}

std::vector<std::uint8_t> build_plate(const test::PlateSceneOptions& options) {
  builder::PipelineReport built;
  auto bytes = builder::build_lode(test::plate_scene(options), {}, {}, built);
  EXPECT_TRUE(bytes) << bytes.error().message();
  return std::move(*bytes);
}

/// V211 by itself: what else differs from the source other rules name.
TEST(Verify, AnotherSurfaceThanTheSourcesIsFound) {
  const std::vector<std::uint8_t> plate = build_plate({});
  const VerifyReport own = verify_plate(plate);
  ASSERT_TRUE(own.surfaces);
  EXPECT_EQ(own.surfaces->pictures, 36U);
  EXPECT_GT(own.surfaces->all.pixels, 36U * 5000U);
  const test::PlateSceneOptions sunk{.plate_moved = {0.0, 0.0, -1.25}}, deleted{.has_plate = false},
      swapped{.are_materials_swapped = true}, aside{.plate_moved = {0.2, 0.0, 0.0}};
  for (const test::PlateSceneOptions& mutant : {sunk, deleted, swapped}) {
    EXPECT_GT(count(verify_plate(build_plate(mutant)), "V211"), count(own, "V211"));
  }
  EXPECT_GT(count(verify_plate(plate, deleted), "V211"), count(own, "V211")) << "what the source has not";
  EXPECT_EQ(count(verify_plate(build_plate(aside)), "V211"), count(own, "V211"))
      << "less than a pixel, where two are allowed";
}

TEST(Verify, WhatPixelsShowIsDrawnFromAsManyPlacesAsCamerasAreAskedFor) {
  const auto pictures = [](std::uint32_t cameras) {
    const VerifyReport report =
        verify_bytes(sample(), test::sample_scene(), {.uniform_cuts = 1, .cameras = cameras, .deviation_cuts = 0});
    return report.surfaces ? report.surfaces->pictures : 0;
  };
  EXPECT_EQ(pictures(0), 0U);
  EXPECT_EQ(pictures(1), 6U);
  EXPECT_EQ(pictures(50), 36U);
}

struct Break {
  const char* rule;
  const char* what;
  std::function<void(scene::Scene&)> source;
  std::function<void(AssetEdit&)> asset;
};

/// A binary STL.
std::vector<std::uint8_t> one_facet() {
  return std::vector<std::uint8_t>(84 + 50);
}

const std::vector<Break>& breaks() {
  static const auto keep = [](auto&) {};
  static const std::vector<Break> all{
      {"V101", "a triangle turned over",
       [](scene::Scene& s) {
         auto& i = s.meshes[1].primitives[0].indices;
         std::swap(i[0], i[1]);
       },
       keep},
      {"V101", "a triangle lost from the source",
       [](scene::Scene& s) {
         auto& i = s.meshes[1].primitives[0].indices;
         i.resize(i.size() - 3);
       },
       keep},
      {"V101", "a triangle of another material",
       [](scene::Scene& s) {
         auto& p = s.meshes[1].primitives[0];
         p.material = MaterialId(1 - p.material.value);
       },
       keep},
      {"V101", "a vertex moved by a step", [](scene::Scene& s) { s.meshes[1].primitives[0].positions[0].x += 1.0; },
       keep},
      {"V101", "another origin", keep, [](AssetEdit& e) { e.mesh(1, [](auto& m) { m.origin[0] += 1.0; }); }},
      {"V101", "a strip that goes the other way", keep,
       [](AssetEdit& e) {
         const auto clusters = e.clusters();
         for (std::uint32_t c = 0; c < clusters.size(); ++c) {
           if (clusters[c].own_group != format::kNone) continue;
           const auto bit = e.layout(c).turn_bit + 1;
           e.put_page_bits(c, bit, 1, 1U - e.page_bits(c, bit, 1));
           return;
         }
       }},
      {"V102", "a degenerate triangle more",
       [](scene::Scene& s) {
         auto& i = s.meshes[1].primitives[0].indices;
         i.insert(i.end(), {0, 0, 1});
       },
       keep},
      {"V102", "a duplicate counted as degenerate", keep,
       [](AssetEdit& e) {
         e.mesh(3, [](auto& m) {
           m.dropped_degenerate = 0;
           m.dropped_duplicate = 1;
         });
       }},
      {"V102", "a repair that was not", [](scene::Scene& s) { s.meshes[1].drops.repaired = 1; }, keep},
      {"V103", "another name", [](scene::Scene& s) { s.meshes[0].name += "x"; }, keep},
      {"V103", "a mesh more", [](scene::Scene& s) { s.meshes.emplace_back(); }, keep},
      {"V103", "another diagonal", keep, [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.diagonal *= 1.0 + 1e-6; }); }},
      {"V103", "source vertices", keep, [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.source_vertices += 1; }); }},
      {"V104", "a normal by ten degrees",
       [](scene::Scene& s) {
         auto& n = s.meshes[1].primitives[0].normals[0];
         n = glm::normalize(n + Vec3f(0.1F, -0.1F, 0.1F));
       },
       keep},
      {"V104", "a colour by one step",
       [](scene::Scene& s) {
         auto& c = s.meshes[1].primitives[0].colors[0];
         c.x = c.x > 0.5F ? c.x - 1.0F / 255.0F : c.x + 1.0F / 255.0F;
       },
       keep},
      {"V104", "a UV by two steps",
       [](scene::Scene& s) {
         for (auto& p : s.meshes[0].primitives) {
           if (!p.uvs[0].empty()) p.uvs[0][0].x += 1e-3F;
         }
       },
       keep},
      {"V105", "a vertex off the grid", [](scene::Scene& s) { s.meshes[1].primitives[0].positions[0].x += 1e-4; },
       keep},
      {"V106", "a material's colour", [](scene::Scene& s) { s.materials[0].base_color.x *= 0.5F; }, keep},
      {"V106", "a material more", [](scene::Scene& s) { s.materials.emplace_back(); }, keep},
      {"V107", "an instance moved", [](scene::Scene& s) { s.instances[0].transform[3][0] += 1.0; }, keep},
      {"V107", "an instance of another mesh", [](scene::Scene& s) { s.instances[0].mesh = MeshId(2U); }, keep},
      {"V107", "an instance more", [](scene::Scene& s) { s.instances.push_back(s.instances[0]); }, keep},
      {"V108", "another source", [](scene::Scene& s) { s.source_hash[0] = 'f'; }, keep},
      {"V110", "a vertex colour that matters",
       [](scene::Scene& s) {
         s.meshes[0].primitives[0].colors.assign(s.meshes[0].primitives[0].positions.size(), Vec4f(0.5F));
       },
       keep},
      {"V110", "flat normals left out", keep,
       [](AssetEdit& e) { e.mesh(2, [](auto& m) { m.normal_mode = format::NormalMode::kNone; }); }},
      {"V110", "a UV set that a material came to sample",
       [](scene::Scene& s) {
         s.meshes[0].primitives[0].uvs[1] = s.meshes[0].primitives[0].uvs[0];
         for (auto& m : s.materials) m.uv_sets_used = 3;
       },
       keep},
      {"V111", "caps below the clusters", keep,
       [](AssetEdit& e) {
         auto& bytes = e.bytes();
         const std::string from = "\"cluster_triangles\":256";
         const auto found = std::search(bytes.begin(), bytes.end(), from.begin(), from.end());
         ASSERT_NE(found, bytes.end());
         found[static_cast<std::ptrdiff_t>(from.size()) - 3] = '0';
         found[static_cast<std::ptrdiff_t>(from.size()) - 2] = '1';
         // "016" is no JSON number: a space keeps the length
         found[static_cast<std::ptrdiff_t>(from.size()) - 3] = ' ';
       }},
      {"V114", "a border that coarser levels do not have",
       [](scene::Scene& s) {
         for (scene::SourceMesh& mesh : s.meshes) {
           if (!mesh.primitives.empty()) mesh.primitives[0].indices.resize(mesh.primitives[0].indices.size() / 6 * 3);
         }
       },
       [](AssetEdit& e) {
         const std::string from = "\"cluster_triangles\":256", to = "\"lock_borders\":    true";
         ASSERT_EQ(from.size(), to.size());
         const auto found = std::search(e.bytes().begin(), e.bytes().end(), from.begin(), from.end());
         ASSERT_NE(found, e.bytes().end());
         std::copy(to.begin(), to.end(), found);
       }},
      {"V113", "a budget that the normals do not keep", keep,
       [](AssetEdit& e) {
         const std::string from = "\"normal_error\":0.1";
         const auto found = std::search(e.bytes().begin(), e.bytes().end(), from.begin(), from.end());
         ASSERT_NE(found, e.bytes().end());
         found[static_cast<std::ptrdiff_t>(from.size()) - 1] = '0';
       }},
      {"V113", "a budget that the UVs do not keep", keep,
       [](AssetEdit& e) {
         const std::string from = "\"uv_error\":0.0001";
         const auto found = std::search(e.bytes().begin(), e.bytes().end(), from.begin(), from.end());
         ASSERT_NE(found, e.bytes().end());
         found[static_cast<std::ptrdiff_t>(from.size()) - 1] = '0';
       }},
      {"V112", "another tier", keep,
       [](AssetEdit& e) { e.mesh(2, [](auto& m) { m.error_tier = format::ErrorTier::kCertified; }); }},
      {"V115", "a file of one facet", [](scene::Scene& s) { s.source_name = "sample.STL"; }, keep},
      {"V109", "an image's byte", [](scene::Scene& s) { s.blobs[0].bytes[0] ^= 1U; }, keep},
      {"V109", "the scene document", [](scene::Scene& s) { s.document += " "; }, keep},
  };
  return all;
}

TEST(Verify, EachBreakIsFoundByItsRule) {
  const std::vector<std::uint8_t> file = one_facet();
  for (const Break& broken : breaks()) {
    scene::Scene scene = test::sample_scene();
    broken.source(scene);
    AssetEdit edit(sample());
    broken.asset(edit);
    edit.seal();
    const VerifyReport report =
        verify_bytes(edit.bytes(), scene, {.uniform_cuts = 3, .cameras = 3, .source_bytes = file});
    EXPECT_TRUE(has(report, broken.rule)) << broken.rule << ", " << broken.what << "; found:\n" << describe(report);
  }
}

TEST(Verify, AQuickLookFindsNothingInTheSampleAndSaysWhatItLeftOut) {
  const VerifyReport report = verify_bytes(sample(), test::sample_scene(), {.is_quick = true});
  EXPECT_EQ(report.finding_count, 0U) << describe(report);
  std::set<std::string> skipped, checked;
  for (const VerifyReport::Check& check : report.checks) (check.skipped ? skipped : checked).insert(check.invariant);
  EXPECT_TRUE(skipped.contains("I1") && !checked.contains("I1"));
  EXPECT_TRUE(skipped.contains("I5")) << "cuts and cameras";
  for (const char* id : {"I2", "I3", "I4", "I5", "I6", "I8"}) EXPECT_TRUE(checked.contains(id)) << id;
}

TEST(Verify, AQuickLookFindsEachBreakOfWhatSurroundsTheGeometry) {
  const std::vector<std::uint8_t> file = one_facet();
  const std::set<std::string> left_out{"V101", "V102", "V104", "V105", "V114"};
  std::set<std::string> found;
  for (const Break& broken : breaks()) {
    const bool is_of_mesh = std::string(broken.rule) == "V103" && std::string(broken.what) != "a mesh more";
    if (left_out.contains(broken.rule) || is_of_mesh) continue;
    scene::Scene scene = test::sample_scene();
    broken.source(scene);
    AssetEdit edit(sample());
    broken.asset(edit);
    edit.seal();
    const VerifyReport report = verify_bytes(edit.bytes(), scene, {.is_quick = true, .source_bytes = file});
    EXPECT_TRUE(has(report, broken.rule)) << broken.rule << ", " << broken.what << "; found:\n" << describe(report);
    found.insert(broken.rule);
  }
  EXPECT_GE(found.size(), 8U);
}

TEST(Verify, EachSourceRuleHasABreak) {
  std::set<std::string> broken;
  for (const Break& b : breaks()) broken.insert(b.rule);
  for (const RuleInfo& rule : all_rules()) {
    EXPECT_TRUE(rule.id.substr(0, 2) != "V1" || broken.contains(std::string(rule.id))) << rule.id;
  }
}

/// What may be dropped and what may not, on a grid of two triangles.
class VerifyDrops : public testing::Test {
 protected:
  static VerifyReport verify_with(const std::function<void(scene::Primitive&)>& change,
                                  const std::function<void(format::MeshRecord&)>& counts) {
    scene::Scene scene = test::sample_scene();
    change(scene.meshes[1].primitives[0]);
    AssetEdit edit(sample());
    edit.mesh(1, counts);
    edit.seal();
    return verify_bytes(edit.bytes(), scene, {.uniform_cuts = 1, .cameras = 1});
  }
};

TEST_F(VerifyDrops, ARotatedDuplicateIsDroppedOnce) {
  const auto duplicate = [](scene::Primitive& p) {
    p.indices.insert(p.indices.end(), {p.indices[1], p.indices[2], p.indices[0]});
  };
  const VerifyReport told = verify_with(duplicate, [](auto& m) {
    m.source_triangles += 1;
    m.dropped_duplicate += 1;
  });
  EXPECT_EQ(told.finding_count, 0U) << describe(told);
  EXPECT_TRUE(has(verify_with(duplicate,
                              [](auto& m) {
                                m.source_triangles += 1;
                                m.dropped_degenerate += 1;
                              }),
                  "V102"));
  EXPECT_GT(verify_with(duplicate, [](auto&) {}).finding_count, 0U);
}

TEST_F(VerifyDrops, AReversedTwinIsNoDuplicate) {
  const auto twin = [](scene::Primitive& p) {
    p.indices.insert(p.indices.end(), {p.indices[1], p.indices[0], p.indices[2]});
  };
  EXPECT_TRUE(has(verify_with(twin,
                              [](auto& m) {
                                m.source_triangles += 1;
                                m.dropped_duplicate += 1;
                              }),
                  "V101"));
}

TEST_F(VerifyDrops, ATriangleOnALineStaysWhereItLiesAlongAnEdge) {
  // Three positions on one line, all distinct, by how far the third is along the edge from the first to the second.
  const auto verify_line = [](double at) {
    const auto line = [at](scene::Primitive& p) {
      const auto first = static_cast<std::uint32_t>(p.positions.size());
      const Vec3d a = p.positions[p.indices[0]];
      const Vec3d b = p.positions[p.indices[1]];
      for (const Vec3d& q : {a, b, a + (b - a) * at}) {
        p.positions.push_back(q);
        p.normals.push_back(p.normals[0]);
        p.colors.push_back(p.colors[0]);
      }
      p.indices.insert(p.indices.end(), {first, first + 1, first + 2});
    };
    return verify_with(line, [](auto& m) {
      m.source_triangles += 1;
      m.dropped_degenerate += 1;
      m.source_vertices += 3;
    });
  };
  const VerifyReport inside = verify_line(0.5);  // it may not go missing, whatever is counted
  EXPECT_TRUE(has(inside, "V101"));
  EXPECT_TRUE(has(inside, "V102"));
  for (const double beyond : {-1.0, 2.0}) {
    const VerifyReport outside = verify_line(beyond);
    EXPECT_EQ(outside.finding_count, 0U) << beyond << ": " << describe(outside);
  }
}

}  // namespace
}  // namespace meshlode::judge
