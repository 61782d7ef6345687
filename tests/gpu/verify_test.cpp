// SPDX-License-Identifier: GPL-3.0-or-later
// The whole of verify --gpu, against a source that is not the asset's: what the GPU draws is the CPU's, and the picture
// is not the source's.
#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "gpu/verify_gpu.h"
#include "gpu_support.h"
#include "import/import.h"

namespace meshlode::gpu::test {
namespace {

using VerifyGpu = GpuTest;

TEST_F(VerifyGpu, AnotherSourceIsToldFromAnotherDrawing) {
  const std::vector<std::uint8_t> bytes = build_file(MESHLODE_DATA "/crystal.glb");
  const auto asset = Asset::from_vector(bytes);
  const auto scene = import_scene(MESHLODE_DATA "/crystal.glb", {});
  ASSERT_TRUE(asset && scene);
  std::vector<Surface> larger;
  for (const SourceMesh& mesh : scene->meshes) {
    larger.push_back(surface_of_source(mesh));
    for (Vec3d& p : larger.back().positions) p *= 1.1;
  }
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "verify_gpu_maps";
  std::filesystem::create_directories(folder);
  GpuVerifyOptions options;
  options.orbits = 1;
  options.out_folder = folder.string();
  const auto report = verify_on_gpu(*asset, larger, options);
  ASSERT_TRUE(report) << report.error().message();
  const auto failures_of = [&](const std::string& id) {
    const auto check =
        std::find_if(report->checks.begin(), report->checks.end(), [&](const GpuCheck& c) { return c.id == id; });
    EXPECT_NE(check, report->checks.end()) << id;
    if (check == report->checks.end()) return std::uint64_t{0};
    EXPECT_TRUE(check->items > 0 || check->is_skipped) << id;
    return check->failures;
  };
  for (const char* id : {"V401", "V402", "V403", "V404", "V407", "V408"}) EXPECT_EQ(failures_of(id), 0U) << id;
  EXPECT_GT(failures_of("V405"), 0U) << "a tenth of the size is many pixels";
  EXPECT_FALSE(report->cameras.empty());
  std::size_t maps = 0;
  for (const JudgedCamera& judged : report->cameras) {
    for (const std::string& map : judged.maps) {
      ++maps;
      EXPECT_TRUE(std::filesystem::exists(folder / map)) << map;
    }
  }
  EXPECT_GT(maps, 0U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace meshlode::gpu::test
