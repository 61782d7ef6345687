// SPDX-License-Identifier: GPL-3.0-or-later
// <meshlode/runtime.h>: opening, selecting, loading and decoding through the public types alone.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include <meshlode/build.h>
#include <meshlode/runtime.h>

#include "arrays.h"

namespace meshlode {
namespace {

using test::Arrays;

const std::vector<std::uint8_t>& sphere_bytes(format::Codec codec = format::Codec::kNone) {
  static std::map<format::Codec, std::vector<std::uint8_t>> made;
  std::vector<std::uint8_t>& bytes = made[codec];
  if (bytes.empty()) {
    const Arrays arrays(lab::with_smooth_normals(lab::make_sphere(40)));
    BuildOptions options;
    options.codec = format::is_written(codec) ? codec : format::Codec::kNone;
    auto built = test::build_one(arrays.primitive(), options);
    if (built) bytes = test::stored_as(std::move(*built), codec);
  }
  return bytes;
}

/// Net number of times each directed edge is used; a closed surface sums to zero everywhere.
class EdgeSum {
 public:
  void add(const ClusterIntegers& cluster) {
    for (const auto& t : cluster.triangles) {
      for (std::size_t k = 0; k < 3; ++k) add_edge(point(cluster, t[k]), point(cluster, t[(k + 1) % 3]));
    }
  }
  [[nodiscard]] bool is_closed() const {
    return std::all_of(sum_.begin(), sum_.end(), [](const auto& edge) { return edge.second == 0; });
  }

 private:
  using Point = std::array<std::int32_t, 3>;
  static Point point(const ClusterIntegers& cluster, std::uint8_t i) {
    const std::int32_t* v = &cluster.values[std::size_t{i} * cluster.channel_count];
    return {v[0], v[1], v[2]};
  }
  void add_edge(const Point& a, const Point& b) {
    if (a < b)
      ++sum_[{a, b}];
    else if (b < a)
      --sum_[{b, a}];
  }
  std::map<std::pair<Point, Point>, int> sum_;
};

EdgeSum sum_of(const AssetFile& asset, const std::vector<std::uint32_t>& clusters) {
  EdgeSum sum;
  ClusterIntegers integers;
  for (const std::uint32_t c : clusters) {
    const auto page = asset.load_page(asset.page_of(c));
    EXPECT_TRUE(page.ok());
    EXPECT_TRUE(asset.decode(*page, c, integers).ok());
    sum.add(integers);
  }
  return sum;
}

TEST(ApiRuntime, OpensFromViewAndFromBytesAlike) {
  const auto& bytes = sphere_bytes();
  ASSERT_FALSE(bytes.empty());
  const auto viewed = AssetFile::view(bytes);
  const auto taken = AssetFile::take(bytes);
  ASSERT_TRUE(viewed.ok() && taken.ok());
  EXPECT_EQ(viewed->clusters().size(), taken->clusters().size());
  EXPECT_EQ(viewed->header().magic, format::kMagic);
  EXPECT_FALSE(viewed->meta_json().empty());
}

TEST(ApiRuntime, GarbageIsRefused) {
  EXPECT_EQ(AssetFile::take({}).error().code, ErrorCode::kInvalid);
  EXPECT_EQ(AssetFile::take(std::vector<std::uint8_t>(1000, 7)).error().code, ErrorCode::kInvalid);
  EXPECT_EQ(AssetFile::open("/no/such/file.lode").error().code, ErrorCode::kIo);
  std::vector<std::uint8_t> cut = sphere_bytes();
  cut.resize(cut.size() / 2);
  EXPECT_EQ(AssetFile::take(std::move(cut)).error().code, ErrorCode::kInvalid);
}

TEST(ApiRuntime, CutsFromTwentyOneViewpointsAreClosedSpheres) {
  const auto asset = AssetFile::view(sphere_bytes());
  ASSERT_TRUE(asset.ok());
  std::set<std::size_t> sizes;
  for (const double distance : {0.0, 1.01, 1.5, 3.0, 10.0, 100.0, 1e6}) {
    for (const double pixels : {0.25, 1.0, 8.0}) {
      View view;
      view.eye = {distance, 0.1 * distance, 0.0};
      const auto items = asset->select_view(view, pixels);
      ASSERT_TRUE(items.ok()) << items.error().message();
      ASSERT_FALSE(items->empty());
      std::vector<std::uint32_t> clusters;
      for (const DrawItem& item : *items) {
        EXPECT_EQ(item.instance, 0U);
        clusters.push_back(item.cluster);
      }
      EXPECT_TRUE(std::is_sorted(clusters.begin(), clusters.end()));
      EXPECT_TRUE(sum_of(*asset, clusters).is_closed()) << "distance " << distance << ", pixels " << pixels;
      sizes.insert(clusters.size());
    }
  }
  EXPECT_GT(sizes.size(), 2U) << "the cut follows the camera";
}

TEST(ApiRuntime, UniformCutsAreClosedAndStateTheirError) {
  const auto asset = AssetFile::view(sphere_bytes());
  ASSERT_TRUE(asset.ok());
  const double level0 = asset->meshes()[0].level0_deviation;
  std::size_t last = asset->clusters().size() + 1;
  for (const double error : {0.0, 1e-4, 1e-3, 1e-2, 1e-1, std::numeric_limits<double>::infinity()}) {
    const auto cut = asset->select_uniform(0, error);
    ASSERT_TRUE(cut.ok());
    EXPECT_LE(cut->stored_error, std::max(error, level0));
    EXPECT_GE(cut->stored_error, level0);
    EXPECT_LE(cut->clusters.size(), last) << "coarser cuts have no more clusters";
    last = cut->clusters.size();
    EXPECT_TRUE(sum_of(*asset, cut->clusters).is_closed());
  }
}

TEST(ApiRuntime, FloatsAreTheIntegersOnTheGrid) {
  const auto asset = AssetFile::view(sphere_bytes());
  ASSERT_TRUE(asset.ok());
  const format::MeshRecord& mesh = asset->meshes()[0];
  const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
  ClusterIntegers integers;
  ClusterFloats floats;
  for (std::uint32_t c = 0; c < asset->clusters().size(); ++c) {
    const auto page = asset->load_page(asset->page_of(c));
    ASSERT_TRUE(page.ok());
    ASSERT_TRUE(asset->decode(*page, c, integers).ok());
    ASSERT_TRUE(asset->decode(*page, c, floats).ok());
    ASSERT_EQ(integers.vertex_count, asset->clusters()[c].vertex_count());
    ASSERT_EQ(integers.triangle_count, asset->clusters()[c].triangle_count());
    ASSERT_EQ(floats.positions.size(), integers.vertex_count);
    ASSERT_EQ(floats.normals.size(), integers.vertex_count);
    EXPECT_EQ(floats.triangles, integers.triangles);
    for (std::uint32_t v = 0; v < integers.vertex_count; ++v) {
      double radius2 = 0.0, cosine = 0.0, length2 = 0.0;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const double exact = step * integers.values[v * integers.channel_count + k];
        EXPECT_EQ(static_cast<double>(floats.positions[v][k]), exact);
        const double p = mesh.origin[k] + exact;
        radius2 += p * p;
        cosine += p * static_cast<double>(floats.normals[v][k]);
        length2 += static_cast<double>(floats.normals[v][k]) * static_cast<double>(floats.normals[v][k]);
      }
      EXPECT_NEAR(length2, 1.0, 1e-5);
      EXPECT_GT(cosine / std::sqrt(radius2), 0.7) << "normals of a sphere point outwards";
      if (asset->clusters()[c].level == 0) {
        EXPECT_NEAR(std::sqrt(radius2), 1.0, 1e-3);
      }
    }
  }
}

TEST(ApiRuntime, EveryCodecDecodesToTheSameIntegers) {
  const auto plain = AssetFile::view(sphere_bytes());
  ASSERT_TRUE(plain.ok());
  for (const format::Codec codec : {format::Codec::kLz4, format::Codec::kZstd, format::Codec::kStrips}) {
    const auto packed = AssetFile::view(sphere_bytes(codec));
    ASSERT_TRUE(packed.ok());
    ASSERT_EQ(packed->pages().size(), plain->pages().size());
    for (std::uint32_t p = 0; p < plain->pages().size(); ++p) {
      const auto a = plain->load_page(p);
      const auto b = packed->load_page(p);
      ASSERT_TRUE(a.ok() && b.ok());
      EXPECT_TRUE(std::ranges::equal(a->bytes(), b->bytes()));
    }
  }
}

TEST(ApiRuntime, WrongIdsViewsAndPagesAreUsageErrors) {
  const auto asset = AssetFile::view(sphere_bytes());
  const auto other = AssetFile::take(sphere_bytes());
  ASSERT_TRUE(asset.ok() && other.ok());
  const auto cluster_count = static_cast<std::uint32_t>(asset->clusters().size());
  ClusterIntegers integers;
  EXPECT_EQ(asset->load_page(static_cast<std::uint32_t>(asset->pages().size())).error().code, ErrorCode::kUsage);
  const auto page = asset->load_page(asset->page_of(0));
  ASSERT_TRUE(page.ok());
  EXPECT_EQ(asset->decode(*page, cluster_count, integers).error().code, ErrorCode::kUsage);
  EXPECT_EQ(other->decode(*page, 0, integers).error().code, ErrorCode::kUsage) << "a page of another asset";
  for (std::uint32_t c = 0; c < cluster_count; ++c) {
    if (asset->page_of(c) != page->page()) {
      EXPECT_EQ(asset->decode(*page, c, integers).error().code, ErrorCode::kUsage);
      break;
    }
  }
  EXPECT_EQ(asset->select_uniform(1, 0.0).error().code, ErrorCode::kUsage);
  EXPECT_EQ(asset->select_uniform(0, -1.0).error().code, ErrorCode::kUsage);
  EXPECT_EQ(asset->select_uniform(0, std::nan("")).error().code, ErrorCode::kUsage);
  const auto refuses = [&](auto change) {
    View view;
    change(view);
    const auto items = asset->select_view(view, 1.0);
    return !items.ok() && items.error().code == ErrorCode::kUsage;
  };
  EXPECT_TRUE(refuses([](View& v) { v.eye[1] = std::nan(""); }));
  EXPECT_TRUE(refuses([](View& v) { v.fovy_radians = 4.0; }));
  EXPECT_TRUE(refuses([](View& v) { v.near_distance = 0.0; }));
  EXPECT_TRUE(refuses([](View& v) { v.height_px = 0; }));
  EXPECT_TRUE(refuses([](View& v) { v.is_orthographic = true, v.ortho_height = -1.0; }));
  EXPECT_FALSE(asset->select_view({}, std::nan("")).ok());
}

TEST(ApiRuntime, ThreadsMayShareAnAsset) {
  const auto asset = AssetFile::view(sphere_bytes(format::Codec::kZstd));
  ASSERT_TRUE(asset.ok());
  std::atomic<int> failures = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      ClusterFloats floats;
      for (int round = 0; round < 10; ++round) {
        View view;
        view.eye = {1.5 + i, 0.0, 0.1 * round};
        const auto items = asset->select_view(view, 1.0);
        if (!items.ok()) ++failures;
        for (const DrawItem& item : items.ok() ? *items : std::vector<DrawItem>{}) {
          const auto page = asset->load_page(asset->page_of(item.cluster));
          if (!page.ok() || !asset->decode(*page, item.cluster, floats).ok()) ++failures;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(failures, 0);
}

TEST(ApiRuntime, MovingAnAssetKeepsItsViews) {
  auto first = AssetFile::take(sphere_bytes());
  ASSERT_TRUE(first.ok());
  const auto clusters = first->clusters();
  auto page = first->load_page(0);
  ASSERT_TRUE(page.ok());
  const AssetFile second = std::move(*first);
  EXPECT_EQ(second.clusters().data(), clusters.data());
  ClusterIntegers integers;
  EXPECT_TRUE(second.decode(*page, second.pages()[0].first_cluster, integers).ok());
}

}  // namespace
}  // namespace meshlode
