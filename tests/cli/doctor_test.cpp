// SPDX-License-Identifier: GPL-3.0-or-later
// doctor names what is wrong with a scene, worst first: of scenes broken on purpose by one known fault, that fault.
#include "meshlode/doctor_words.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/doctor/asset_faults.h"
#include "broken_scenes.h"
#include "hard_case.h"
#include "scene/detect/detect.h"
#include "scene/import/import.h"

namespace meshlode::cli {
namespace {

std::string ids_of(const std::vector<app::Diagnosis>& diagnoses) {
  std::string text;
  for (const app::Diagnosis& one : diagnoses) text += one.id + " " + std::to_string(one.share) + "; ";
  return text;
}

TEST(Doctor, FindsNothingInASoundScene) {
  EXPECT_TRUE(diagnose_scene(test::sound_scene()).empty());
}

TEST(Doctor, NamesTheFaultOfABrokenSceneFirst) {
  for (const test::BrokenScene& broken : test::broken_scenes()) {
    const std::vector<app::Diagnosis> diagnoses = diagnose_scene(broken.scene);
    ASSERT_FALSE(diagnoses.empty()) << broken.id;
    EXPECT_EQ(diagnoses[0].id, broken.id) << ids_of(diagnoses);
    EXPECT_FALSE(diagnoses[0].title.empty());
    EXPECT_FALSE(diagnoses[0].remedy.empty());
    EXPECT_GT(diagnoses[0].share, 0.0) << broken.id;
    ASSERT_FALSE(diagnoses[0].places.empty());
    EXPECT_FALSE(diagnoses[0].places[0].detail.empty()) << broken.id;
    EXPECT_FALSE(diagnoses[0].places[0].costs.empty()) << broken.id;
  }
}

/// What an exporter would write of it: floats, and whatever import makes of them.
TEST(Doctor, NamesTheFaultOfABrokenFileFirst) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "meshlode-doctor-test.glb";
  for (const test::BrokenScene& broken : test::broken_scenes()) {
    if (broken.scene.triangles_in_file > 0) continue;  // glTF says nothing of the kind
    const std::vector<std::uint8_t> bytes = test::as_glb(broken.scene);
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
    const Result<scene::Scene> scene = scene::import_scene(path, {});
    ASSERT_TRUE(scene.ok()) << broken.id << ": " << scene.error().detail;
    const std::vector<app::Diagnosis> diagnoses = diagnose_scene(*scene);
    ASSERT_FALSE(diagnoses.empty()) << broken.id;
    // Import mends normals that are no numbers, and says so.
    EXPECT_EQ(diagnoses[0].id, broken.id == "not-finite" ? "left-out" : broken.id) << ids_of(diagnoses);
  }
  std::filesystem::remove(path);
}

TEST(Doctor, ASceneOfWhichNothingIsLeftIsHigh) {
  const auto severity = [](const scene::Scene& scene, const char* id) -> std::string {
    for (const app::Diagnosis& one : diagnose_scene(scene)) {
      if (one.id == id) return app::severity_of(one.share);
    }
    return "";
  };
  EXPECT_EQ(severity(scene::Scene{}, "nothing-to-draw"), "high");
  scene::Scene flat = test::sound_scene();
  for (Vec3d& p : flat.meshes[0].primitives[0].positions) p = Vec3d(p.x, 0.0, 0.0);
  EXPECT_EQ(severity(flat, "nothing-to-draw"), "high");
  scene::Scene sound = test::sound_scene();
  EXPECT_EQ(severity(sound, "nothing-to-draw"), "");
  sound.triangles_in_file = 4800;
  EXPECT_EQ(severity(sound, "triangles-missing"), "");
  sound.triangles_in_file = 4801;
  EXPECT_EQ(severity(sound, "triangles-missing"), "high");
  sound.meshes[0].drops.repaired = 1;  // known and counted
  EXPECT_EQ(severity(sound, "triangles-missing"), "");
}

/// A shell above the sphere, nearer to it than coarse levels will be to either. A build keeps it: no share is at stake.
TEST(Doctor, CloseLayersAreListed) {
  scene::Scene scene = test::sound_scene();
  scene::SourceMesh shell = scene.meshes[0];
  for (Vec3d& p : shell.primitives[0].positions) p *= 1.005;
  scene.meshes.push_back(std::move(shell));
  scene.instances.emplace_back().mesh = MeshId(1U);
  const std::vector<app::Diagnosis> diagnoses = diagnose_scene(scene);
  ASSERT_EQ(diagnoses.size(), 1U) << ids_of(diagnoses);
  EXPECT_EQ(diagnoses[0].id, "close-layers");
  EXPECT_EQ(diagnoses[0].share, 0.0);
  ASSERT_EQ(diagnoses[0].places.size(), 2U) << "the shell and the sphere below";
  EXPECT_FALSE(diagnoses[0].places[0].triangles.empty());
  scene.meshes[1].primitives[0].positions.clear();
  for (const Vec3d& p : scene.meshes[0].primitives[0].positions) {
    scene.meshes[1].primitives[0].positions.push_back(p * 1.5);
  }
  EXPECT_TRUE(diagnose_scene(scene).empty()) << "far enough";
}

TEST(Doctor, ThereIsABrokenSceneForEveryFault) {
  std::set<std::string> broken;
  for (const test::BrokenScene& scene : test::broken_scenes()) broken.insert(scene.id);
  broken.insert({"left-out", "close-layers"});  // other tests: nothing is broken there
  const std::vector<std::string> ids = source_fault_ids();
  EXPECT_EQ(broken, std::set<std::string>(ids.begin(), ids.end()));
}

/// The case of docs/reference/hard-cases.md that a fault names has that fault somewhere along its parameter.
TEST(Doctor, TheHardCaseThatItNamesHasTheFault) {
  const auto has_fault = [](const test::hard::HardCase& hard_case, scene::FaultKind kind) {
    return std::any_of(hard_case.sweep.begin(), hard_case.sweep.end(), [&](double parameter) {
      const Result<test::hard::Sample> sample = hard_case.make(parameter);
      if (!sample) return kind == scene::FaultKind::kNotFinite;  // import refuses it, with that reason
      const std::vector<scene::Fault> faults = scene::examine_scene(sample->scene);
      return std::any_of(faults.begin(), faults.end(), [&](const scene::Fault& one) { return one.kind == kind; });
    });
  };
  std::size_t count = 0;
  for (const auto& [kind, name] : scene::kFaultNames) {
    const std::string case_name = hard_case_of(kind);
    if (case_name.empty()) continue;
    ++count;
    const auto cases = test::hard::hard_cases();
    const auto found = std::find_if(cases.begin(), cases.end(), [&](const auto& one) { return one.name == case_name; });
    ASSERT_NE(found, cases.end()) << name << " names " << case_name;
    EXPECT_TRUE(has_fault(*found, kind)) << name << " names " << case_name;
  }
  EXPECT_GE(count, 8U);
}

TEST(Doctor, TheHardCasesThatAnAssetsFaultsNameExist) {
  EXPECT_FALSE(app::asset_hard_cases().empty());
  for (const std::string& name : app::asset_hard_cases()) {
    const auto cases = test::hard::hard_cases();
    EXPECT_TRUE(std::any_of(cases.begin(), cases.end(), [&](const auto& one) { return one.name == name; })) << name;
  }
}

TEST(Doctor, SaysWhatTheImportLeftOutLast) {
  scene::Scene scene = test::broken_scenes()[0].scene;
  scene.left_out.push_back({"skin 0", "meshes are static"});
  const std::vector<app::Diagnosis> diagnoses = diagnose_scene(scene);
  ASSERT_EQ(diagnoses.size(), 2U) << ids_of(diagnoses);
  EXPECT_EQ(diagnoses[1].id, "left-out");
  EXPECT_EQ(diagnoses[1].places.at(0).where, "skin 0");
  EXPECT_EQ(diagnoses[1].places[0].detail, "meshes are static");
}

/// What is ranked first is what costs most over the whole scene, whichever mesh has it.
TEST(Doctor, RanksByShareOfTheWholeScene) {
  const std::vector<test::BrokenScene> scenes = test::broken_scenes();
  const auto named = [&](const char* id) {
    return std::find_if(scenes.begin(), scenes.end(), [&](const test::BrokenScene& one) { return one.id == id; })
        ->scene;
  };
  // Degenerate: an eleventh of a sphere of 4800 triangles; turned: two thirds of it.
  scene::Scene both = named("degenerate-faces");
  both.meshes.push_back(named("inconsistent-orientation").meshes[0]);
  both.instances.push_back(both.instances[0]);
  both.instances[1].mesh = MeshId(1U);
  std::vector<app::Diagnosis> diagnoses = diagnose_scene(both);
  ASSERT_EQ(diagnoses.size(), 2U) << ids_of(diagnoses);
  EXPECT_EQ(diagnoses[0].id, "inconsistent-orientation");
  // Twenty more degenerate spheres, and the turned one is a small part.
  for (int i = 0; i < 20; ++i) {
    both.meshes.push_back(both.meshes[0]);
    both.instances.push_back(both.instances[0]);
    both.instances.back().mesh = MeshId(both.meshes.size() - 1);
  }
  diagnoses = diagnose_scene(both);
  ASSERT_EQ(diagnoses.size(), 2U) << ids_of(diagnoses);
  EXPECT_EQ(diagnoses[0].id, "degenerate-faces");
  EXPECT_EQ(diagnoses[0].places.size(), 21U);
}

}  // namespace
}  // namespace meshlode::cli
