// SPDX-License-Identifier: GPL-3.0-or-later
// The samples that other tests start from hold what they promise, so that a failing check points at the check.
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "run/decode/decode.h"
#include "support/sample_asset.h"

namespace meshlode::run {
namespace {

using Point = std::array<std::int32_t, 3>;
using Border = std::map<std::pair<Point, Point>, int>;  ///< oriented edge -> how often, opposite ones taken off

void add_triangles(const DecodedCluster& cluster, Border& border) {
  const auto at = [&](std::uint8_t v) {
    const Vec3i p = cluster.position(v);
    return Point{p.x, p.y, p.z};
  };
  for (const auto& triangle : cluster.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Point a = at(triangle[k]);
      const Point b = at(triangle[(k + 1) % 3]);
      const auto back = border.find({b, a});
      if (back != border.end()) {
        if (--back->second == 0) border.erase(back);
      } else {
        ++border[{a, b}];
      }
    }
  }
}

class Sample : public testing::Test {
 protected:
  Sample() : asset_(*Asset::from_vector(test::sample_asset_bytes())), clusters_(*decode_all(asset_)) {}
  Asset asset_;
  std::vector<DecodedCluster> clusters_;
};

TEST_F(Sample, WhatDecodingTakesIsKnownFromTheTables) {
  std::uint64_t bytes = 0;
  for (const format::PageRecord& page : asset_.pages()) bytes += page.bytes;
  std::vector<ClusterId> all;
  std::uint64_t clusters = 0;
  for (std::size_t c = 0; c < clusters_.size(); ++c) {
    all.emplace_back(c);
    const DecodedCluster& cluster = clusters_[c];
    clusters += sizeof cluster + cluster.channels.size() * sizeof(cluster.channels[0]) +
                cluster.triangles.size() * sizeof(cluster.triangles[0]) +
                cluster.triangle_material.size() * sizeof(cluster.triangle_material[0]);
  }
  EXPECT_EQ(count_decoded_bytes(asset_, all), clusters);
  EXPECT_EQ(count_decoded_bytes(asset_), bytes + clusters);
  EXPECT_TRUE(check_decoded_bytes(asset_, kDefaultMaxDecoded));
  const Status refused = check_decoded_bytes(asset_, kDefaultMaxDecoded + 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(refused.error().detail.find("--max-decoded"), std::string::npos);
}

TEST_F(Sample, AFileJustifies64TimesItsSizeWhateverIsAllowed) {
  EXPECT_EQ(decoded_limit(1000, 0), 64000u);
  EXPECT_EQ(decoded_limit(1000, 64001), 64001u);
  EXPECT_EQ(decoded_limit(UINT64_MAX, 5), UINT64_MAX);
  EXPECT_EQ(asset_.max_decoded_bytes(), kDefaultMaxDecoded);
}

TEST_F(Sample, GroupsAndWhatReplacesThemHaveTheSameBorder) {  // I6
  std::size_t compared = 0;
  for (std::size_t g = 0; g < asset_.groups().size(); ++g) {
    const format::GroupRecord& group = asset_.groups()[g];
    if ((group.flags & format::kGroupTerminal) != 0) continue;
    Border finer;
    Border coarser;
    for (std::uint32_t c = 0; c < group.cluster_count; ++c) add_triangles(clusters_[group.first_cluster + c], finer);
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
      if (asset_.clusters()[c].own_group == g) add_triangles(clusters_[c], coarser);
    }
    EXPECT_EQ(finer, coarser) << "group " << g;
    ++compared;
  }
  EXPECT_EQ(compared, 12U);
}

TEST_F(Sample, EveryLevelHasTheBorderOfTheSource) {
  for (std::uint32_t m = 0; m < 3; ++m) {
    const format::MeshRecord& mesh = asset_.meshes()[m];
    for (std::uint32_t level = 0; level < mesh.level_count; ++level) {
      Border border;
      for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
        if (asset_.clusters()[c].level == level) add_triangles(clusters_[c], border);
      }
      EXPECT_EQ(border.size(), m == 0 ? 64U : 0U) << "mesh " << m << ", level " << level;
    }
  }
}

TEST_F(Sample, ErrorsGrowAndSpheresNestTowardsTheCoarse) {  // I4
  for (const format::ClusterRecord& cluster : asset_.clusters()) {
    if (cluster.own_group == format::kNone) continue;
    const format::GroupRecord& own = asset_.groups()[cluster.own_group];
    const format::GroupRecord& coarser = asset_.groups()[cluster.coarser_group];
    EXPECT_GT(coarser.error, own.error);
    const Vec3d apart = Vec3d(own.center[0], own.center[1], own.center[2]) -
                        Vec3d(coarser.center[0], coarser.center[1], coarser.center[2]);
    EXPECT_LT((glm::length(apart) + double(own.radius)) * 1.0005, double(coarser.radius));
  }
}

TEST_F(Sample, LevelZeroIsTheSourceTriangleForTriangle) {  // I1
  const scene::Scene scene = test::sample_scene();
  for (std::uint32_t m = 0; m < 3; ++m) {
    const format::MeshRecord& mesh = asset_.meshes()[m];
    const Vec3d origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
    const double step = std::ldexp(1.0, mesh.grid.log2) * mesh.grid.mantissa;
    std::multiset<std::array<Point, 3>> expected;
    std::multiset<std::array<Point, 3>> stored;
    const auto canonical = [](std::array<Point, 3> t) {
      while (t[0] > t[1] || t[0] > t[2]) t = {t[1], t[2], t[0]};
      return t;
    };
    for (const scene::Primitive& primitive : scene.meshes[m].primitives) {
      for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        std::array<Point, 3> triangle;
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3d q = (primitive.positions[primitive.indices[i + k]] - origin) / step;
          for (int axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(q[axis], std::floor(q[axis]));
            triangle[k][static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(q[axis]);
          }
        }
        expected.insert(canonical(triangle));
      }
    }
    for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
      if (asset_.clusters()[c].level != 0) continue;
      for (const auto& t : clusters_[c].triangles) {
        std::array<Point, 3> triangle;
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3i p = clusters_[c].position(t[k]);
          triangle[k] = {p.x, p.y, p.z};
        }
        stored.insert(canonical(triangle));
      }
    }
    EXPECT_EQ(expected, stored) << "mesh " << m;
  }
}

TEST_F(Sample, TheMeshesHaveTheirKindsOfAttributes) {
  ASSERT_EQ(asset_.meshes().size(), 4U);
  EXPECT_EQ(format::channel_count(asset_.meshes()[0]), 8U);   // position, normal, one UV set
  EXPECT_EQ(format::channel_count(asset_.meshes()[1]), 10U);  // position, normal, colour
  EXPECT_EQ(format::channel_count(asset_.meshes()[2]), 3U);
  EXPECT_EQ(asset_.meshes()[2].normal_mode, format::NormalMode::kFlat);
  EXPECT_EQ(asset_.meshes()[3].group_count, 0U);
  EXPECT_EQ(asset_.instances()[2].flags, format::kInstanceMirrored);
  EXPECT_EQ(asset_.instances()[2].scale, 2.0);
  EXPECT_EQ(asset_.instances()[3].flags, format::kInstanceSingular);
}

}  // namespace
}  // namespace meshlode::run
