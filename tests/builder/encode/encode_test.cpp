// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/encode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "builder/encode/uv_grid.h"
#include "run/decode/decode.h"
#include "support/random.h"
#include "support/sample_asset.h"

namespace meshlode::builder {
namespace {

/// `group_count` groups of level 0, none of them replaced, each with `cluster_count` clusters of 254 triangles and 256
/// vertices with random positions: as large as clusters get.
test::SampleMesh heavy_mesh(std::uint32_t group_count, std::uint32_t cluster_count, const AttributeLayout& layout) {
  test::Random random(5);
  test::SampleMesh out;
  out.mesh.name = "heavy";
  out.mesh.layout = layout;
  out.dag.level_count = 1;
  for (std::uint32_t g = 0; g < group_count; ++g) {
    DagGroup group;
    group.first_cluster = static_cast<std::uint32_t>(out.dag.clusters.size());
    group.cluster_count = cluster_count;
    group.is_terminal = true;
    out.dag.groups.push_back(group);
    for (std::uint32_t c = 0; c < cluster_count; ++c) {
      DagCluster cluster;
      cluster.coarser_group = GroupId{g};
      cluster.first_vertex = static_cast<std::uint32_t>(out.dag.vertex_position.size());
      cluster.vertex_count = 256;
      cluster.first_triangle = static_cast<std::uint32_t>(out.dag.triangles.size());
      cluster.triangle_count = 254;
      for (std::uint32_t v = 0; v < 256; ++v) {
        const auto coordinate = [&] {
          return static_cast<int>(random.below(2 * format::kMaxGridCoordinate)) - format::kMaxGridCoordinate;
        };
        const int x = coordinate();
        const int y = coordinate();
        out.dag.vertex_position.push_back({x, y, coordinate()});
        for (std::uint32_t k = 0; k < layout.stride(); ++k) {
          out.dag.vertex_attributes.push_back(static_cast<float>(random.signed_unit()));
        }
      }
      for (std::uint32_t t = 0; t < 254; ++t) {
        out.dag.triangles.push_back(
            {static_cast<std::uint8_t>(t), static_cast<std::uint8_t>(t + 1), static_cast<std::uint8_t>(t + 2)});
        out.dag.triangle_material.push_back(t / 64);
      }
      out.dag.clusters.push_back(cluster);
    }
  }
  out.hierarchy.sphere_log2 = 0;
  out.hierarchy.group_spheres.assign(group_count, {{0.0F, 0.0F, 0.0F}, 1.0F});
  out.hierarchy.group_errors.assign(group_count, format::kInfiniteError);
  out.hierarchy.cluster_spheres.assign(out.dag.clusters.size(), {{0.0F, 0.0F, 0.0F}, 1.0F});
  out.hierarchy.cluster_cones.assign(out.dag.clusters.size(), {{0, 0, 127}, 127});
  return out;
}

AttributeLayout full_layout() {
  AttributeLayout layout;
  layout.has_normal = true;
  layout.uv_set_count = 4;
  layout.has_color = true;
  return layout;
}

/// The decoded vertex at a position: vertices stand in their order of first use.
std::uint32_t find_vertex(const run::DecodedCluster& cluster, const Vec3i& position) {
  std::uint32_t v = 0;
  while (v < cluster.vertex_count && cluster.position(v) != position) ++v;
  EXPECT_LT(v, cluster.vertex_count);
  return v;
}

Result<EncodedMesh> encode(const test::SampleMesh& sample, const EncodeOptions& options = {}) {
  return encode_mesh(sample.mesh, sample.dag, sample.hierarchy, options);
}

TEST(Encode, NoClusterExceedsTheBoundThatTheBuilderPlansWith) {
  for (const double normal_error : {20.0, 0.1, 0.01}) {
    EncodeOptions options;
    options.normal_error = normal_error;
    options.uv_error.fill(1e-7);
    const AttributeLayout layout = full_layout();
    const std::uint32_t bound = max_cluster_bytes(layout, options, 256, 254, 4);
    const auto mesh = encode(heavy_mesh(1, 2, layout), options);
    ASSERT_TRUE(mesh.ok()) << mesh.error().message();
    EXPECT_LE(mesh->pages[0].bytes.size(), kPageFrameBytes + 2 * bound);
    EXPECT_GE(mesh->pages[0].bytes.size(), bound) << "the bound is not idle";
  }
}

TEST(Encode, AGroupThatFillsNoPageIsRefusedByName) {
  const auto mesh = encode(heavy_mesh(3, 60, AttributeLayout{}));
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(mesh.error().where, "mesh \"heavy\", group 0");
}

TEST(Encode, PagesHoldWholeGroupsInOrderAndAsManyAsFit) {
  const test::SampleMesh sample = heavy_mesh(20, 10, AttributeLayout{});
  const auto mesh = encode(sample);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message();
  ASSERT_GT(mesh->pages.size(), 2U);
  std::uint32_t group = 0;
  std::uint32_t cluster = 0;
  for (std::size_t p = 0; p < mesh->pages.size(); ++p) {
    const EncodedMesh::Page& page = mesh->pages[p];
    EXPECT_EQ(page.first_group, group);
    EXPECT_EQ(page.first_cluster, cluster);
    EXPECT_EQ(page.cluster_count, 10 * page.group_count);
    EXPECT_LE(page.bytes.size(), format::kMaxPageBytes);
    for (std::uint32_t g = group; g < group + page.group_count; ++g) EXPECT_EQ(mesh->groups[g].page, p);
    group += page.group_count;
    cluster += page.cluster_count;
    if (p + 1 < mesh->pages.size()) {
      const std::size_t bytes_of_a_group = page.bytes.size() / page.group_count;
      EXPECT_GT(page.bytes.size() + bytes_of_a_group + 64, format::kMaxPageBytes) << "page " << p << " has room left";
    }
  }
  EXPECT_EQ(group, 20U);
}

TEST(Encode, DependenciesAreThePagesOfTheCoarserClusters) {
  // Two groups of level 0 that do not fit the page of the terminal group above them.
  test::SampleMesh sample = heavy_mesh(3, 30, AttributeLayout{});
  sample.dag.level_count = 2;
  sample.dag.groups[0].level = 1;
  for (std::uint32_t g = 1; g < 3; ++g) {
    sample.dag.groups[g].is_terminal = false;
    sample.dag.groups[g].error = 1.0;
    sample.hierarchy.group_errors[g] = 1.0F;
  }
  for (std::uint32_t c = 0; c < 30; ++c) {
    sample.dag.clusters[c].level = 1;
    sample.dag.clusters[c].own_group = GroupId{c < 15 ? 1U : 2U};
  }
  const auto mesh = encode(sample);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message();
  ASSERT_EQ(mesh->pages.size(), 3U);
  EXPECT_TRUE(mesh->pages[0].dependencies.empty());
  EXPECT_EQ(mesh->pages[1].dependencies, std::vector<std::uint32_t>{0});
  EXPECT_EQ(mesh->pages[2].dependencies, std::vector<std::uint32_t>{0});
}

TEST(Encode, BoundsAreThoseOfTheVerticesOfLevelZero) {
  test::SampleMesh sample = heavy_mesh(3, 2, AttributeLayout{});
  sample.dag.level_count = 2;
  sample.dag.groups[0].level = 1;
  for (std::uint32_t c = 0; c < 2; ++c) {
    sample.dag.clusters[c].level = 1;
    sample.dag.clusters[c].own_group = GroupId{1 + c};
  }
  for (std::uint32_t g = 1; g < 3; ++g) sample.dag.groups[g].is_terminal = false;
  for (std::size_t v = 2 * 256; v < sample.dag.vertex_position.size(); ++v) {
    sample.dag.vertex_position[v] /= 3;  // the coarser clusters reach farther
    sample.dag.vertex_position[v].y += 1000000;
  }
  const auto mesh = encode(sample);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<int> values;
    for (std::size_t v = 2 * 256; v < sample.dag.vertex_position.size(); ++v)
      values.push_back(sample.dag.vertex_position[v][axis]);
    EXPECT_EQ(mesh->record.bounds_min[axis], *std::min_element(values.begin(), values.end())) << axis;
    EXPECT_EQ(mesh->record.bounds_max[axis], *std::max_element(values.begin(), values.end())) << axis;
  }
}

TEST(Encode, TheStepOfUvsIsTheLargestPowerOfTwoWithinTheErrorAskedOrTheDefault) {
  AttributeLayout layout;
  layout.uv_set_count = 1;
  const test::SampleMesh sample = heavy_mesh(1, 1, layout);
  UvRange range;
  for (const float value : sample.dag.vertex_attributes) range.add(value);
  for (const double asked : {0.0, 0.01, 0x1p-12, 1e-5}) {
    EncodeOptions options;
    options.uv_error.fill(asked);
    options.uv_error_may_fall_short = false;  // no limit is asked for by 0, and the others are kept
    const auto mesh = encode(sample, options);
    ASSERT_TRUE(mesh.ok()) << mesh.error().message();
    const double error = asked > 0.0 ? asked : default_uv_error(range);
    const double half_step = 0.5 * format::exp2_exact(mesh->record.uv_log2[0]);
    EXPECT_LE(half_step, error) << asked;
    EXPECT_GT(2.0 * half_step, error) << asked;
  }
}

TEST(Encode, IsTheSameForAnyNumberOfThreads) {  // I10
  const test::SampleMesh sample = heavy_mesh(20, 10, full_layout());
  std::vector<std::vector<std::vector<std::uint8_t>>> results;
  for (const int threads : {1, 2, 4}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      const auto mesh = encode(sample);
      ASSERT_TRUE(mesh.ok());
      std::vector<std::vector<std::uint8_t>> pages;
      for (const auto& page : mesh->pages) pages.push_back(page.bytes);
      results.push_back(pages);
    });
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(Encode, TheLargestCoordinatesComeBackExactly) {
  test::SampleMesh sample = test::sample_tetrahedron();
  for (Vec3i& p : sample.dag.vertex_position)
    p = {p.x > 0 ? format::kMaxGridCoordinate : -format::kMaxGridCoordinate, p.y, p.z};
  const auto asset = run::Asset::from_vector(test::asset_bytes_of(sample));
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  const auto clusters = run::decode_all(*asset);
  ASSERT_TRUE(clusters.ok()) << clusters.error().message();
  std::multiset<std::array<int, 3>> expected;
  std::multiset<std::array<int, 3>> stored;
  for (std::uint32_t v = 0; v < 4; ++v) {
    const Vec3i& p = sample.dag.vertex_position[v];
    const Vec3i q = (*clusters)[0].position(v);
    expected.insert({p.x, p.y, p.z});
    stored.insert({q.x, q.y, q.z});
  }
  EXPECT_EQ(stored, expected);
}

// Floats hold 24 bits: coordinates in the millions cannot be kept to a thousandth. Who asked for it hears so.
TEST(Encode, AUvBudgetThatTheCoordinatesLeaveNoBitsForIsRefusedUnlessItMayFallShort) {
  AttributeLayout layout;
  layout.uv_set_count = 1;
  test::SampleMesh sample = heavy_mesh(1, 1, layout);
  for (float& value : sample.dag.vertex_attributes) value = 3e6F;
  EncodeOptions options;
  options.uv_error.fill(1e-3);
  options.uv_error_may_fall_short = false;
  const auto refused = encode(sample, options);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
  options.uv_error.fill(0.25);
  EXPECT_TRUE(encode(sample, options).ok());
  options.uv_error.fill(1e-3);
  options.uv_error_may_fall_short = true;
  const auto kept = encode(sample, options);
  ASSERT_TRUE(kept.ok());
  EXPECT_EQ(kept->record.uv_log2[0], -2) << "2^24 quarters hold 3 million, 2^24 eighths do not";
}

TEST(Encode, ValuesThatAreNotFiniteBecomeNeutral) {
  test::SampleMesh sample = heavy_mesh(1, 1, full_layout());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const std::size_t stride = sample.mesh.layout.stride();
  for (std::size_t k = 0; k < stride; ++k) sample.dag.vertex_attributes[k] = k % 2 == 0 ? nan : inf;
  for (std::size_t k = 0; k < stride; ++k) sample.dag.vertex_attributes[stride + k] = k < 3 ? 0.0F : -inf;
  sample.hierarchy.nodes.push_back({{0, 0, 0}, 1.0F, format::kInfiniteError, 0, 0});
  for (std::uint32_t& material : sample.dag.triangle_material) material /= 2;
  const auto asset = run::Asset::from_vector(test::asset_bytes_of(sample));
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  const auto clusters = run::decode_all(*asset);
  ASSERT_TRUE(clusters.ok()) << clusters.error().message();
  run::ClusterAttributes attributes;
  run::decode_attributes(asset->meshes()[0], (*clusters)[0], attributes);
  for (std::size_t source = 0; source < 2; ++source) {
    const auto v = find_vertex((*clusters)[0], sample.dag.vertex_position[source]);
    EXPECT_EQ(attributes.normals[v], Vec3f(0.0F, 0.0F, 1.0F));
    for (const auto& uv : attributes.uvs) EXPECT_EQ(uv[v], Vec2f(0.0F));
  }
  EXPECT_EQ(attributes.colors[find_vertex((*clusters)[0], sample.dag.vertex_position[1])], Vec4f(0.0F));
}

TEST(Encode, StoredBoundsAreNeverBelowTheTruth) {
  test::SampleMesh sample = test::sample_tetrahedron();
  for (const double truth : {0.0, 0.1, 1.0 / 3.0, 1e-30, 1e-46, 1e30}) {
    sample.mesh.level0_deviation = truth;
    const auto mesh = encode(sample);
    ASSERT_TRUE(mesh.ok());
    EXPECT_GE(double(mesh->record.level0_deviation), truth);
    EXPECT_LE(double(mesh->record.level0_deviation), truth * (1.0 + 1e-6) + 2e-45);
  }
}

TEST(Encode, TheLargestSphereOfSixteenBitsFits) {
  test::SampleMesh sample = test::sample_patch();
  const float unit = static_cast<float>(format::exp2_exact(sample.hierarchy.sphere_log2));
  sample.hierarchy.cluster_spheres[0] = {{32767.0F * unit, -32767.0F * unit, 0.0F}, 65535.0F * unit};
  EXPECT_TRUE(encode(sample).ok());
  sample.hierarchy.cluster_spheres[0].radius = 65536.0F * unit;
  EXPECT_FALSE(encode(sample).ok());
}

/// Each breaks one limit of the format: the encoder must see it, not the reader.
TEST(Encode, ADagThatTheFormatCannotHoldIsRefused) {
  struct Mistake {
    const char* name;
    void (*make)(test::SampleMesh&);
    ErrorCode code;
  };
  const Mistake mistakes[] = {
      {"a position of 25 bits", [](auto& s) { s.dag.vertex_position[0].x = 1 << 23; }, ErrorCode::kBuildFailed},
      {"a vertex index out of range", [](auto& s) { s.dag.triangles[0][0] = 200; }, ErrorCode::kBuildFailed},
      {"a vertex that no triangle uses", [](auto& s) { s.dag.clusters[0].triangle_count -= 30; },
       ErrorCode::kBuildFailed},
      {"no triangle", [](auto& s) { s.dag.clusters[0].triangle_count = 0; }, ErrorCode::kBuildFailed},
      {"no vertex", [](auto& s) { s.dag.clusters[0].vertex_count = 0; }, ErrorCode::kBuildFailed},
      {"257 vertices", [](auto& s) { s.dag.clusters[0].vertex_count = 257; }, ErrorCode::kBuildFailed},
      {"unsorted materials", [](auto& s) { s.dag.triangle_material[0] = 9; }, ErrorCode::kBuildFailed},
      {"clusters in no group", [](auto& s) { s.dag.groups.back().cluster_count -= 1; }, ErrorCode::kBuildFailed},
      {"an unknown group", [](auto& s) { s.dag.clusters[0].own_group = GroupId{99U}; }, ErrorCode::kBuildFailed},
      {"a sphere between the units", [](auto& s) { s.hierarchy.cluster_spheres[0].center[0] += 1e-5F; },
       ErrorCode::kBuildFailed},
      {"a sphere beyond the largest unit",
       [](auto& s) {
         s.hierarchy.sphere_log2 = format::kMaxSphereLog2;
         s.hierarchy.cluster_spheres[0].center[0] = 0x1p120F;
       },
       ErrorCode::kUnsupported},
      {"a hierarchy of another mesh", [](auto& s) { s.hierarchy.group_errors.pop_back(); }, ErrorCode::kBuildFailed},
      {"attributes of another mesh", [](auto& s) { s.dag.vertex_attributes.pop_back(); }, ErrorCode::kBuildFailed},
      {"a grid below floats", [](auto& s) { s.mesh.grid.log2 = -127; }, ErrorCode::kUnsupported},
      {"a grid above floats", [](auto& s) { s.mesh.grid.log2 = 105; }, ErrorCode::kUnsupported},
  };
  for (const Mistake& mistake : mistakes) {
    test::SampleMesh sample = test::sample_patch();
    mistake.make(sample);
    const auto mesh = encode(sample);
    ASSERT_FALSE(mesh.ok()) << mistake.name;
    EXPECT_EQ(mesh.error().code, mistake.code) << mistake.name;
    EXPECT_NE(mesh.error().where.find("patch"), std::string::npos) << mistake.name;
  }
  EncodeOptions options;
  options.normal_error = 0.009;  // needs more than kMaxNormalScale
  EXPECT_EQ(encode(test::sample_patch(), options).error().code, ErrorCode::kUnsupported);
  options.normal_error = 0.0;
  EXPECT_EQ(encode(test::sample_patch(), options).error().code, ErrorCode::kUsage);
  options = {};
  options.uv_error[0] = -1.0;
  EXPECT_EQ(encode(test::sample_patch(), options).error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace meshlode::builder
