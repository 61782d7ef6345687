// SPDX-License-Identifier: GPL-3.0-or-later
// What a build needs, known before it: counts within 32 bits, and memory, held against what builds in children took.
#include "builder/needs.h"
#include "builder/builder.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

TEST(Needs, CountsBeyondWhatIdsHoldAreRefusedInOneLine) {
  EXPECT_TRUE(check_mesh_counts({kMaxMeshTriangles, kMaxMeshVertices}, "mesh 0"));
  const Status triangles = check_mesh_counts({kMaxMeshTriangles + 1, 3}, "mesh 7 'scan'");
  ASSERT_FALSE(triangles);
  EXPECT_EQ(triangles.error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(triangles.error().message(),
            "mesh 7 'scan': 214000001 triangles, at most 214000000 are built into one mesh: split it");
  EXPECT_FALSE(check_mesh_counts({1, kMaxMeshVertices + 1}, "mesh 0"));
  EXPECT_FALSE(check_mesh_counts({UINT64_MAX, UINT64_MAX}, "mesh 0")) << "no product wraps";
  // All levels together, in corners, and the corners of the source.
  EXPECT_LT(static_cast<double>(kMaxMeshTriangles) * 3.0 / (1.0 - 0.85), std::exp2(32));
}

TEST(Needs, MaterialsThatALabelHasNoRoomForAreRefused) {
  EXPECT_TRUE(check_material_count(kMaxMaterials));
  const Status refused = check_material_count(kMaxMaterials + 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(refused.error().message().find("8388608 materials"), std::string::npos) << refused.error().message();
}

TEST(Needs, FlatNormalsBesideOthersMakeAVertexOfEachCorner) {
  scene::SourceMesh mesh;
  mesh.primitives.resize(2);
  mesh.primitives[0].positions.resize(4);
  mesh.primitives[0].indices = {0, 1, 2, 0, 2, 3};
  mesh.primitives[1] = mesh.primitives[0];
  EXPECT_EQ(count_mesh(mesh).triangles, 4u);
  EXPECT_EQ(count_mesh(mesh).vertices, 8u);
  mesh.primitives[0].normals.resize(4);
  EXPECT_EQ(count_mesh(mesh).vertices, 10u);
}

constexpr std::uint64_t kMiB = 1u << 20u;

/// Meshes that take so many bytes in work, beside `always` without the threads'.
MemoryEstimate estimate_of(std::uint64_t always, const std::vector<std::uint64_t>& meshes) {
  MemoryEstimate estimate{always, {}};
  for (std::size_t i = 0; i < meshes.size(); ++i) estimate.working.push_back({meshes[i], i});
  return estimate;
}

TEST(Needs, MoreThanIsAllowedIsRefusedAndSaysForWhatAndWhatToDo) {
  scene::Scene scene;
  scene.meshes.resize(2);
  scene.meshes[1].name = "hill";
  scene.meshes[1].primitives.resize(1);
  scene.meshes[1].primitives[0].indices.resize(15);
  EXPECT_TRUE(fit_memory(estimate_of(57 * kMiB, {40 * kMiB}), scene, 1, 100 * kMiB));
  MemoryEstimate estimate{57 * kMiB + 1, {{40 * kMiB, 1}, {2 * kMiB, 0}}};
  const auto refused = fit_memory(estimate, scene, 8, 100 * kMiB);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBuildFailed);
  EXPECT_EQ(
      refused.error().detail,
      "the build needs about 100.1MiB of memory, 40MiB of it for mesh 1 'hill' of 5 triangles; 100MiB are allowed "
      "by --max-memory: allow more, or split the mesh or the scene");
  EXPECT_TRUE(fit_memory(estimate_of(1, {}), scene, 4, 0));
  const auto machine = fit_memory(estimate_of(std::uint64_t{1} << 60u, {}), scene, 1, 0);
  ASSERT_FALSE(machine);
  EXPECT_NE(machine.error().detail.find("are available: free some"), std::string::npos) << machine.error().detail;
}

TEST(Needs, AsManyMeshesAreInWorkAtOnceAsFitAndThenFewerThreads) {
  const MemoryEstimate estimate = estimate_of(10 * kMiB, {50 * kMiB, 30 * kMiB, 20 * kMiB, 20 * kMiB});
  EXPECT_EQ(estimate.bytes(0, 0), 10 * kMiB);
  EXPECT_EQ(estimate.bytes(2, 1), 93 * kMiB);
  EXPECT_EQ(estimate.bytes(9, 16), 178 * kMiB);
  const auto fit = [&](std::uint64_t limit, std::uint32_t threads) {
    const auto found = fit_memory(estimate, {}, threads, limit);
    EXPECT_TRUE(found);
    return found ? std::pair(found->at_once, found->threads) : std::pair<std::size_t, std::uint32_t>();
  };
  using Fit = std::pair<std::size_t, std::uint32_t>;
  EXPECT_EQ(fit(178 * kMiB, 16), Fit(4, 16));
  EXPECT_EQ(fit(178 * kMiB, 3), Fit(3, 3)) << "one a thread";
  EXPECT_EQ(fit(178 * kMiB - 1, 16), Fit(3, 16));
  EXPECT_EQ(fit(138 * kMiB, 16), Fit(2, 16));
  EXPECT_EQ(fit(108 * kMiB, 16), Fit(1, 16));
  EXPECT_EQ(fit(108 * kMiB - 1, 16), Fit(1, 15));
  EXPECT_EQ(fit(63 * kMiB, 16), Fit(1, 1));
  scene::Scene scene;
  scene.meshes.resize(4);
  EXPECT_FALSE(fit_memory(estimate, scene, 16, 63 * kMiB - 1));
  EXPECT_EQ(fit_memory(estimate_of(1, {}), {}, 0, 100 * kMiB)->at_once, 1u) << "a scene without meshes";
}

/// A wavy sheet of 2 · n² triangles, `count` times.
scene::Scene sheets(std::uint32_t n, std::size_t count, bool has_attributes) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].uv_sets_used = has_attributes ? 1 : 0;
  scene::Primitive sheet;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      sheet.positions.emplace_back(x, y,
                                   0.03 * std::sin(40.0 * x) * std::cos(31.0 * y) + 0.002 * ((i * 7 + j * 13) % 5));
      if (!has_attributes) continue;
      sheet.uvs[0].emplace_back(static_cast<float>(x), static_cast<float>(y));
      sheet.normals.emplace_back(0.0F, static_cast<float>(std::sin(x)), static_cast<float>(std::cos(x)));
      sheet.colors.emplace_back(static_cast<float>(x), 0.5F, static_cast<float>(y), 1.0F);
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t q = j * (n + 1) + i;
      for (const std::uint32_t corner : {q, q + 1, q + n + 2, q, q + n + 2, q + n + 1}) sheet.indices.push_back(corner);
    }
  }
  sheet.material = MaterialId(0U);
  scene::SourceMesh mesh;
  mesh.primitives.push_back(std::move(sheet));
  scene.meshes.assign(count, mesh);
  return scene;
}

TEST(Needs, OneMeshAfterAnotherGivesTheSameBytes) {
  const scene::Scene scene = sheets(40, 5, false);
  PipelineOptions options;
  PipelineReport side_by_side, one_by_one;
  const MemoryEstimate estimate = estimate_memory(scene, options);
  tbb::task_arena arena(4);
  arena.execute([&] {
    const auto all = build_lode(scene, options, {}, side_by_side);
    options.max_memory = estimate.bytes(1, 4);
    const auto each = build_lode(scene, options, {}, one_by_one);
    ASSERT_TRUE(all && each);
    EXPECT_EQ(*all, *each);
    const auto taken_apart = build_lode(scene::Scene(scene), options, {}, one_by_one);
    ASSERT_TRUE(taken_apart);
    EXPECT_EQ(*all, *taken_apart) << "the scene is freed along the way";
    options.max_memory = estimate.bytes(1, 1) - 1;
    PipelineReport refused;
    EXPECT_FALSE(build_lode(scene, options, {}, refused)) << "too much for one thread";
    EXPECT_EQ(refused.memory_estimate, estimate.bytes(1, 1));
  });
  EXPECT_EQ(side_by_side.memory_estimate, estimate.bytes(4, 4));
  EXPECT_EQ(one_by_one.memory_estimate, estimate.bytes(1, 4));
}

/// Triangles that share nothing, within a box of 2 and of about `size` each.
scene::Scene loose(std::uint32_t count, double size = 0.05) {
  scene::Scene scene = sheets(1, 1, false);
  scene::Primitive& primitive = scene.meshes[0].primitives[0];
  primitive.positions.clear();
  primitive.indices.clear();
  for (std::uint32_t i = 0; i < 3 * count; ++i) {
    const std::uint32_t triangle = i / 3;
    const double t = triangle;
    primitive.positions.emplace_back(std::sin(t) + size * std::sin(7.0 * i),
                                     std::cos(1.7 * t) + size * std::cos(5.0 * i),
                                     std::sin(0.3 * t) + size * std::sin(3.0 * i));
    primitive.indices.push_back(i);
  }
  return scene;
}

/// The same surface with a vertex for each corner.
scene::Scene unshared(scene::Scene scene) {
  for (scene::SourceMesh& mesh : scene.meshes) {
    for (scene::Primitive& primitive : mesh.primitives) {
      std::vector<Vec3d> positions;
      for (std::uint32_t& index : primitive.indices) {
        positions.push_back(primitive.positions[index]);
        index = static_cast<std::uint32_t>(positions.size() - 1);
      }
      primitive.positions = std::move(positions);
    }
  }
  return scene;
}

/// Texture coordinates that no two triangles share.
scene::Scene split(scene::Scene scene) {
  for (scene::SourceMesh& mesh : scene.meshes) {
    for (scene::Primitive& primitive : mesh.primitives) {
      scene::Primitive apart;
      apart.material = primitive.material;
      for (const std::uint32_t index : primitive.indices) {
        const auto corner = static_cast<std::uint32_t>(apart.positions.size());
        apart.indices.push_back(corner);
        apart.positions.push_back(primitive.positions[index]);
        apart.uvs[0].emplace_back(static_cast<float>(std::sin(1.7 * corner)),
                                  static_cast<float>(std::cos(2.3 * corner)));
      }
      primitive = std::move(apart);
    }
  }
  return scene;
}

/// Tiles of 8 by 8 cells take turns.
scene::Scene in_two_materials(scene::Scene scene, std::uint32_t n) {
  scene.materials.resize(2, scene.materials.front());
  for (scene::SourceMesh& mesh : scene.meshes) {
    mesh.primitives.push_back(mesh.primitives.front());
    const std::vector<std::uint32_t> indices = mesh.primitives.front().indices;
    for (std::uint32_t m = 0; m < 2; ++m) {
      mesh.primitives[m].material = MaterialId(m);
      mesh.primitives[m].indices.clear();
    }
    for (std::uint32_t i = 0; i < indices.size(); ++i) {
      const std::uint32_t cell = i / 6, x = cell % n / 8, y = cell / n / 8;
      mesh.primitives[(x + y) % 2].indices.push_back(indices[i]);
    }
  }
  return scene;
}

struct Measured {
  std::uint64_t estimate = 0, peak = 0;  ///< bytes
};

/// The scene made and built in a child of its own, so that its peak is nobody else's.
template <class MakeScene>
Measured measure(const MakeScene& make_scene, format::ErrorTier tier, int threads,
                 AggregateChoice aggregate = AggregateChoice::kNever,
                 format::Promise promise = format::Promise::kPosition) {
  Measured out;
  int ends[2];
  if (pipe(ends) != 0) return out;
  const pid_t child = fork();
  if (child == 0) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    arena.execute([&] {
      PipelineOptions options;
      options.error_tier = tier;
      options.aggregate = aggregate;
      options.promise = promise;
      PipelineReport report;
      const scene::Scene scene = make_scene();
      const auto bytes = build_lode(scene, options, {}, report);
      if (!bytes) _exit(2);
      if (write(ends[1], &report.memory_estimate, sizeof(report.memory_estimate)) < 0) _exit(3);
    });
    _exit(0);
  }
  close(ends[1]);
  const bool has_estimate = read(ends[0], &out.estimate, sizeof(out.estimate)) == sizeof(out.estimate);
  close(ends[0]);
  int status = 0;
  rusage usage{};
  EXPECT_EQ(wait4(child, &status, 0, &usage), child);
  EXPECT_TRUE(has_estimate && WIFEXITED(status) && WEXITSTATUS(status) == 0);
  out.peak = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  return out;
}

/// Never less than what is taken, and at most 1.8 times as much and what the program itself is taken for.
void expect_close(const Measured& measured, const std::string& what) {
  if (test::kIsSanitized) GTEST_SKIP() << "a sanitizer's own memory is not estimated";
  const double ratio = static_cast<double>(measured.estimate) / static_cast<double>(measured.peak);
  std::printf("%s: %.1f MiB estimated, %.1f MiB taken, %.2f\n", what.c_str(),
              static_cast<double>(measured.estimate) / 0x1p20, static_cast<double>(measured.peak) / 0x1p20, ratio);
  EXPECT_GE(ratio, 1.0) << what;
  EXPECT_LE(static_cast<double>(measured.estimate), 1.8 * static_cast<double>(measured.peak) + 24.0 * 0x1p20) << what;
}

TEST(Needs, WhatTwoThreadsKeepIsNotRefusedToSixteen) {
  const scene::Scene scene = sheets(20, 1, false);
  PipelineOptions options;
  tbb::task_arena arena(16);
  for (const std::uint32_t threads : {2U, 5U}) {
    options.max_memory = estimate_memory(scene, options).bytes(1, threads);
    arena.execute([&] {
      PipelineReport report;
      const auto bytes = build_lode(scene, options, {}, report);
      EXPECT_TRUE(bytes) << bytes.error().message();
      EXPECT_EQ(report.memory_estimate, options.max_memory) << "as many threads as fit";
    });
  }
}

// GoogleTest runs such suites first: a child that is forked once there are threads has none of them, and waits for
// ever.
TEST(NeedsDeathTest, MemoryIsEstimatedFromAboveAndCloseEnough) {
  using enum format::ErrorTier;
  expect_close(measure([] { return sheets(160, 1, false); }, kMeasured, 1), "51,200 triangles, one thread");
  expect_close(measure([] { return sheets(160, 1, true); }, kMeasured, 2),
               "with normals, UVs and colours, two threads");
  expect_close(measure([] { return in_two_materials(sheets(160, 1, false), 160); }, kMeasured, 1), "in two materials");
  expect_close(measure([] { return sheets(160, 1, false); }, kQem, 2), "the quadric's tier");
  expect_close(measure([] { return sheets(160, 1, false); }, kCertified, 2), "the certified tier");
  expect_close(measure([] { return sheets(50, 12, false); }, kMeasured, 2), "twelve meshes of 5,000");
  expect_close(measure([] { return sheets(20, 1, false); }, kMeasured, 1), "800 triangles");
  expect_close(measure([] { return loose(20000); }, kMeasured, 1), "20,000 loose triangles");
  expect_close(measure([] { return unshared(sheets(120, 1, false)); }, kMeasured, 1),
               "28,800 triangles, no vertex shared");
  expect_close(measure([] { return split(sheets(200, 1, true)); }, kMeasured, 1), "80,000 triangles, each a chart");
  expect_close(measure([] { return loose(400); }, kMeasured, 2, AggregateChoice::kAlways), "an aggregate of 400");
  expect_close(measure([] { return loose(4000, 0.003); }, kMeasured, 2, AggregateChoice::kAlways), "of 4,000 crumbs");
  expect_close(measure([] { return loose(4000, 0.0005); }, kMeasured, 2, AggregateChoice::kAlways), "of tiny ones");
  expect_close(measure([] { return loose(20000); }, kMeasured, 1, AggregateChoice::kAlways), "of 20,000 triangles");
  for (const format::ErrorTier tier : {kMeasured, kCertified}) {
    expect_close(
        measure([] { return sheets(80, 1, true); }, tier, 2, AggregateChoice::kNever, format::Promise::kAppearance),
        "12,800 triangles whose appearance is promised");
    expect_close(
        measure([] { return sheets(80, 1, false); }, tier, 2, AggregateChoice::kNever, format::Promise::kAppearance),
        "flat ones");
  }
}

TEST(NeedsDeathTest, MemoryOfMoreIsToo) {
  using enum format::ErrorTier;
  for (const format::ErrorTier tier : {kQem, kCertified}) {
    expect_close(measure([] { return split(sheets(200, 1, true)); }, tier, 1), "80,000 triangles, each a chart");
  }
  expect_close(measure([] { return loose(200000); }, kMeasured, 2, AggregateChoice::kAlways), "of 200,000");
}

TEST(Needs, AScenesImagesAreCounted) {
  scene::Scene scene = sheets(4, 1, false);
  const std::uint64_t without = estimate_memory(scene, {}).always;
  scene.blobs.resize(1);
  scene.blobs[0].bytes.resize(1000000);
  EXPECT_EQ(estimate_memory(scene, {}).always, without + 2000000);
}

}  // namespace
}  // namespace meshlode::builder
