// SPDX-License-Identifier: GPL-3.0-or-later
// What goes in comes out: positions, triangles and materials bit for bit, attributes within what their bits promise.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "run/decode/decode.h"
#include "run/decode/octahedral.h"
#include "support/sample_asset.h"

namespace meshlode::run {
namespace {

Asset open_asset(std::vector<std::uint8_t> bytes) {
  auto asset = Asset::from_vector(std::move(bytes));
  EXPECT_TRUE(asset.ok()) << (asset ? "" : asset.error().message());
  if (!asset) std::abort();
  return std::move(*asset);
}

std::vector<DecodedCluster> decode_or_abort(const Asset& asset) {
  auto clusters = decode_all(asset);
  EXPECT_TRUE(clusters.ok()) << (clusters ? "" : clusters.error().message());
  if (!clusters) std::abort();
  return std::move(*clusters);
}

struct Case {
  const char* name;
  test::SampleMesh (*make)();
};
constexpr Case kCases[] = {
    {"patch", test::sample_patch}, {"sphere", test::sample_sphere}, {"tetrahedron", test::sample_tetrahedron}};
constexpr format::Codec kCodecs[] = {format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd,
                                     format::Codec::kStrips, format::Codec::kDraco};

using Vertex = std::vector<std::int64_t>;  ///< a position, and attributes as the bits of floats where a test has them
/// Corners from the smallest on, in their order, and the material: whatever the order of triangles and vertices.
using Corners = std::pair<std::array<Vertex, 3>, std::uint32_t>;

Corners corners_of(std::array<Vertex, 3> t, std::uint32_t material) {
  std::array<Vertex, 3> least = t;
  for (int turn = 0; turn < 2; ++turn) {
    std::rotate(t.begin(), t.begin() + 1, t.end());
    least = std::min(least, t);
  }
  return {least, material};
}

Vertex vertex_of(const Vec3i& p) {
  return {p.x, p.y, p.z};
}

TEST(Decode, GivesBackTrianglesWithOrientationAndMaterialExactly) {  // I1
  for (const Case& c : kCases) {
    const test::SampleMesh sample = c.make();
    for (const format::Codec codec : kCodecs) {
      const Asset asset = open_asset(test::asset_bytes_of(sample, codec));
      const auto clusters = decode_or_abort(asset);
      ASSERT_EQ(clusters.size(), sample.dag.clusters.size()) << c.name;
      for (std::size_t i = 0; i < clusters.size(); ++i) {
        const builder::DagCluster& dag_cluster = sample.dag.clusters[i];
        ASSERT_EQ(clusters[i].vertex_count, dag_cluster.vertex_count);
        ASSERT_EQ(clusters[i].triangle_count, dag_cluster.triangle_count);
        std::multiset<Corners> expected;
        std::multiset<Corners> stored;
        for (std::uint32_t t = 0; t < dag_cluster.triangle_count; ++t) {
          std::array<Vertex, 3> source;
          std::array<Vertex, 3> decoded;
          for (std::size_t k = 0; k < 3; ++k) {
            const std::uint8_t v = sample.dag.triangles[dag_cluster.first_triangle + t][k];
            source[k] = vertex_of(sample.dag.vertex_position[dag_cluster.first_vertex + v]);
            decoded[k] = vertex_of(clusters[i].position(clusters[i].triangles[t][k]));
          }
          expected.insert(corners_of(source, sample.dag.triangle_material[dag_cluster.first_triangle + t]));
          stored.insert(corners_of(decoded, clusters[i].triangle_material[t]));
        }
        ASSERT_EQ(stored, expected) << c.name << ", cluster " << i;
      }
    }
  }
}

TEST(Decode, VerticesStandInTheirOrderOfFirstUse) {
  for (const Case& c : kCases) {
    for (const DecodedCluster& cluster : decode_or_abort(open_asset(test::asset_bytes_of(c.make())))) {
      std::uint32_t fresh = 0;
      for (const auto& triangle : cluster.triangles) {
        for (const std::uint8_t v : triangle) {
          ASSERT_LE(v, fresh) << c.name;
          fresh = std::max(fresh, v + 1U);
        }
      }
      EXPECT_EQ(fresh, cluster.vertex_count);
    }
  }
}

TEST(Decode, KeepsGroupsErrorsAndSpheresAsTheyWere) {
  for (const Case& c : kCases) {
    const test::SampleMesh sample = c.make();
    const Asset asset = open_asset(test::asset_bytes_of(sample));
    ASSERT_EQ(asset.groups().size(), sample.dag.groups.size());
    for (std::size_t g = 0; g < asset.groups().size(); ++g) {
      const format::GroupRecord& group = asset.groups()[g];
      EXPECT_EQ(group.error, sample.hierarchy.group_errors[g]);
      EXPECT_EQ(group.radius, sample.hierarchy.group_spheres[g].radius);
      EXPECT_EQ(group.level, sample.dag.groups[g].level);
      EXPECT_EQ((group.flags & format::kGroupTerminal) != 0, sample.dag.groups[g].is_terminal);
      EXPECT_EQ(group.deviation, format::kInfiniteError);
    }
    for (std::size_t i = 0; i < asset.clusters().size(); ++i) {
      EXPECT_EQ(asset.clusters()[i].own_group, sample.dag.clusters[i].own_group.value);
      EXPECT_EQ(asset.clusters()[i].coarser_group, sample.dag.clusters[i].coarser_group.value);
    }
  }
}

TEST(Decode, PositionsAreExactInFloat) {
  for (const Case& c : kCases) {
    const test::SampleMesh sample = c.make();
    const Asset asset = open_asset(test::asset_bytes_of(sample));
    const auto clusters = decode_or_abort(asset);
    ClusterAttributes attributes;
    for (const DecodedCluster& cluster : clusters) {
      decode_attributes(asset.meshes()[0], cluster, attributes);
      for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
        const Vec3d exact = sample.mesh.grid.decode(cluster.position(v));
        for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(double(attributes.positions[v][axis]), exact[axis]) << c.name;
      }
    }
  }
}

/// The DAG's vertex of each decoded one: among those at its position the one whose attributes are nearest (on a seam
/// there are several, and they are far apart).
std::vector<std::size_t> match_vertices(const test::SampleMesh& sample, std::size_t cluster_id,
                                        const DecodedCluster& cluster) {
  const builder::DagCluster& dag_cluster = sample.dag.clusters[cluster_id];
  const builder::AttributeLayout& layout = sample.mesh.layout;
  const Asset asset = open_asset(test::asset_bytes_of(sample));
  ClusterAttributes attributes;
  decode_attributes(asset.meshes()[0], cluster, attributes);
  std::vector<std::size_t> sources(cluster.vertex_count);
  for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
    double best = 1e300;
    for (std::size_t s = dag_cluster.first_vertex; s < std::size_t{dag_cluster.first_vertex} + dag_cluster.vertex_count;
         ++s) {
      if (sample.dag.vertex_position[s] != cluster.position(v)) continue;
      const float* stored = sample.dag.vertex_attributes.data() + s * layout.stride();
      double distance = 0.0;
      if (layout.has_normal) distance += glm::length(attributes.normals[v] - Vec3f(stored[0], stored[1], stored[2]));
      if (layout.uv_set_count > 0) {
        distance +=
            glm::length(attributes.uvs[0][v] - Vec2f(stored[layout.uv_offset()], stored[layout.uv_offset() + 1]));
      }
      if (distance >= best) continue;
      best = distance;
      sources[v] = s;
    }
    EXPECT_LT(best, 1.0);
  }
  return sources;
}

TEST(Decode, AttributesStayWithinTheirSteps) {
  for (const Case& c : kCases) {
    const test::SampleMesh sample = c.make();
    const builder::AttributeLayout& layout = sample.mesh.layout;
    const Asset asset = open_asset(test::asset_bytes_of(sample));
    const format::MeshRecord& mesh = asset.meshes()[0];
    const auto clusters = decode_or_abort(asset);
    const double angle_bound = std::sqrt(2.0) / mesh.normal_scale;
    ClusterAttributes attributes;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      decode_attributes(mesh, clusters[i], attributes);
      ASSERT_EQ(attributes.normals.size(), layout.has_normal ? clusters[i].vertex_count : 0U);
      ASSERT_EQ(attributes.uvs[0].size(), layout.uv_set_count > 0 ? clusters[i].vertex_count : 0U);
      ASSERT_EQ(attributes.colors.size(), layout.has_color ? clusters[i].vertex_count : 0U);
      const std::vector<std::size_t> sources = match_vertices(sample, i, clusters[i]);
      for (std::uint32_t v = 0; v < clusters[i].vertex_count; ++v) {
        const std::size_t vertex = sources[v];
        const float* stored = sample.dag.vertex_attributes.data() + vertex * layout.stride();
        if (layout.has_normal) {
          const Vec3d normal(attributes.normals[v]);
          ASSERT_NEAR(glm::length(normal), 1.0, 1e-6);
          ASSERT_LE(glm::length(normal - Vec3d(stored[0], stored[1], stored[2])), angle_bound);
        }
        if (layout.uv_set_count > 0) {
          const double half_step = std::ldexp(0.5, mesh.uv_log2[0]);
          ASSERT_NEAR(attributes.uvs[0][v].x, stored[layout.uv_offset()], half_step);
          ASSERT_NEAR(attributes.uvs[0][v].y, stored[layout.uv_offset() + 1], half_step);
        }
        if (layout.has_color) {
          for (int k = 0; k < 4; ++k) {
            ASSERT_NEAR(attributes.colors[v][k], stored[layout.color_offset() + static_cast<std::uint32_t>(k)],
                        0.5 / 255.0 + 1e-6);
          }
        }
      }
    }
  }
}

// I3: what is equal before encoding is equal after it, whatever cluster it stands in.
TEST(Decode, EqualVerticesHaveEqualIntegersInEveryCluster) {
  for (const Case& c : kCases) {
    const test::SampleMesh sample = c.make();
    const std::size_t stride = sample.mesh.layout.stride();
    const auto clusters = decode_or_abort(open_asset(test::asset_bytes_of(sample)));
    std::map<std::vector<float>, std::vector<std::int32_t>> seen;
    std::size_t shared = 0;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      const std::vector<std::size_t> sources = match_vertices(sample, i, clusters[i]);
      for (std::uint32_t v = 0; v < clusters[i].vertex_count; ++v) {
        const std::size_t vertex = sources[v];
        const Vec3i& q = sample.dag.vertex_position[vertex];
        std::vector<float> key{static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)};
        key.insert(key.end(), sample.dag.vertex_attributes.begin() + static_cast<std::ptrdiff_t>(vertex * stride),
                   sample.dag.vertex_attributes.begin() + static_cast<std::ptrdiff_t>((vertex + 1) * stride));
        const auto first = clusters[i].channels.begin() + static_cast<std::ptrdiff_t>(v) * clusters[i].channel_count;
        const std::vector<std::int32_t> value(first, first + clusters[i].channel_count);
        const auto [at, is_new] = seen.emplace(key, value);
        if (is_new) continue;
        ++shared;
        ASSERT_EQ(at->second, value) << c.name;
      }
    }
    if (clusters.size() > 1) {
      EXPECT_GT(shared, 0U) << c.name;
    }
  }
}

TEST(Decode, ReusesItsOutputAndFillsAllOfIt) {
  const Asset asset = open_asset(test::sample_asset_bytes(format::Codec::kZstd));
  const auto expected = decode_or_abort(asset);
  DecodedCluster reused;
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    const auto page = load_page(asset, PageId{p});
    ASSERT_TRUE(page.ok());
    const format::PageRecord& record = asset.pages()[p];
    for (std::uint32_t i = record.cluster_count; i-- > 0;) {
      decode_cluster(asset, *page, ClusterId{record.first_cluster + i}, reused);
      const DecodedCluster& fresh = expected[record.first_cluster + i];
      EXPECT_EQ(reused.channels, fresh.channels);
      EXPECT_EQ(reused.triangles, fresh.triangles);
      EXPECT_EQ(reused.triangle_material, fresh.triangle_material);
    }
  }
}

TEST(Decode, EveryPairOfStoredIntegersIsAUnitNormal) {
  for (const std::int32_t scale : {1, 7, 255}) {
    for (std::int32_t a = 0; a <= 2 * scale; ++a) {
      for (std::int32_t b = 0; b <= 2 * scale; ++b) {
        const auto point = octahedral_point(a, b, static_cast<std::uint32_t>(a + b) % 6, scale);
        ASSERT_EQ(std::abs(point[0]) + std::abs(point[1]) + std::abs(point[2]), scale) << a << " " << b;
        ASSERT_NEAR(glm::length(Vec3d(octahedral_normal(point))), 1.0, 1e-7);
      }
    }
  }
  // A page that lies about its integers still gives finite numbers.
  for (const std::int32_t a : {0, 1 << 14, (1 << 15) - 2}) {
    for (const std::int32_t b : {0, 1 << 14, (1 << 15) - 2}) {
      const Vec3f normal = octahedral_normal(octahedral_point(a, b, 3, 1));
      EXPECT_TRUE(std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z));
    }
  }
}

}  // namespace
}  // namespace meshlode::run
