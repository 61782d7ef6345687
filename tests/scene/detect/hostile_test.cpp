// SPDX-License-Identifier: GPL-3.0-or-later
// Detectors may be given anything: no index, no number and no shape makes them crash, hang or disagree with themselves.
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "lab/samples/samples.h"
#include "scene/detect/detect.h"

namespace meshlode::scene {
namespace {

constexpr double kOdd[] = {0.0,
                           -0.0,
                           1.0,
                           -1.0,
                           1e300,
                           -1e300,
                           1e-300,
                           5e-324,
                           1.7e308,
                           -1.7e308,
                           1e16,
                           std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()};

Primitive random_primitive(SplitMix64& random) {
  Primitive out;
  const std::size_t vertices = random.below(40);
  const auto number = [&] { return random.chance(0.7) ? random.signed_unit() : kOdd[random.below(std::size(kOdd))]; };
  const auto single = [&] {
    return static_cast<float>(random.chance(0.9) ? random.signed_unit() : kOdd[random.below(std::size(kOdd))] * 1e-300);
  };
  for (std::size_t v = 0; v < vertices; ++v) {
    const double x = number(), y = number(), z = number();
    out.positions.emplace_back(x, y, z);
    if (random.chance(0.9)) out.normals.emplace_back(single(), single(), single());  // too few, too
    if (random.chance(0.9)) out.uvs[random.below(kMaxUvSets)].emplace_back(single(), single());
  }
  const std::size_t indices = random.below(300);
  for (std::size_t i = 0; i < indices; ++i) {
    out.indices.push_back(random.chance(0.98) ? static_cast<std::uint32_t>(random.below(vertices + 1))
                                              : static_cast<std::uint32_t>(random.next()));
  }
  out.material = random.chance(0.9) ? MaterialId(random.scaled_below(3)) : MaterialId();
  return out;
}

void expect_sane(const std::vector<Fault>& faults, std::uint64_t seed) {
  for (const Fault& fault : faults) {
    EXPECT_GT(fault.count, 0U) << name_of(fault.kind) << " seed " << seed;
    EXPECT_LE(fault.triangles.size(), kMaxListedTriangles);
    EXPECT_LE(fault.triangles.size(), fault.triangle_count);
    for (const FaultCost& cost : fault.costs) {
      EXPECT_TRUE(cost.share >= 0.0 && cost.share <= 1.0)
          << name_of(fault.kind) << " " << cost.share << " seed " << seed;
      EXPECT_TRUE(cost.amount >= 0.0 && std::isfinite(cost.amount)) << name_of(fault.kind) << " seed " << seed;
    }
  }
}

TEST(DetectHostile, AnyNumbersAndAnyIndices) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SplitMix64 random(seed);
    SourceMesh mesh;
    const std::size_t primitives = random.below(4);
    for (std::size_t p = 0; p < primitives; ++p) mesh.primitives.push_back(random_primitive(random));
    std::vector<SceneMaterial> materials(2);
    materials[0].uv_sets_used = static_cast<std::uint32_t>(random.next());
    expect_sane(examine_mesh(mesh, materials), seed);
  }
}

TEST(DetectHostile, NothingAtAll) {
  EXPECT_TRUE(examine_mesh(SourceMesh{}, {}).empty());
  EXPECT_TRUE(examine_mesh(lab::as_mesh(Primitive{}), {}).empty());
  const std::vector<Fault> of_none = examine_scene(Scene{});
  ASSERT_EQ(of_none.size(), 1U);
  EXPECT_EQ(of_none[0].kind, FaultKind::kNothingToDraw);
  Primitive rest;
  rest.indices = {7, 7};  // no triangle
  EXPECT_TRUE(examine_mesh(lab::as_mesh(rest), {}).empty());
  rest.indices.push_back(7);
  const std::vector<Fault> faults = examine_mesh(lab::as_mesh(rest), {});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, FaultKind::kNotFinite);
}

/// Border points that all lie within one cell, edges that all meet in one point, one edge of all triangles, all
/// vertices in one place.
TEST(DetectHostile, ManyThingsInOnePlace) {
  constexpr std::uint32_t kCount = 12'000;
  Primitive heap, fan, book, point;
  SplitMix64 random(1);
  fan.positions.emplace_back(0.0);
  book.positions = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
  for (std::uint32_t i = 0; i < kCount; ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      heap.indices.push_back(static_cast<std::uint32_t>(heap.positions.size()));
      const double wide = i < kCount * 2 / 3 ? 1.0 : 1e-7;
      heap.positions.push_back(wide * Vec3d(random.unit(), random.unit(), random.unit()));
    }
    fan.positions.emplace_back(random.signed_unit(), random.signed_unit(), random.signed_unit());
    fan.indices.insert(fan.indices.end(), {0, i, i + 1});
    book.positions.emplace_back(random.signed_unit(), random.signed_unit(), random.unit());
    book.indices.insert(book.indices.end(), {0, 1, i + 2});
  }
  point.indices = heap.indices;
  point.positions.assign(heap.positions.size(), Vec3d(3.0));
  for (const Primitive& shape : {heap, fan, book, point}) expect_sane(examine_mesh(lab::as_mesh(shape), {}), 0);
}

}  // namespace
}  // namespace meshlode::scene
