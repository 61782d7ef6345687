// SPDX-License-Identifier: GPL-3.0-or-later
// Levels of an aggregate: complete, ever fewer, the same for any thread count and at any scale.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "builder/aggregate/thin_mesh.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

ThinMesh thin(scene::Primitive shape, std::uint32_t leaf_triangles = 256) {
  shape.normals.clear();
  shape.uvs[0].clear();
  Result<PreparedMesh> mesh = prepare_mesh(lab::as_mesh(std::move(shape)), {}, {});
  EXPECT_TRUE(mesh.ok()) << mesh.error().message();
  const std::vector<SourceMaterial> materials(1);
  return thin_mesh(*mesh, materials, {.leaf_triangles = leaf_triangles});
}

TEST(ThinMesh, LevelsCoverAllLeavesWithEverFewerTriangles) {
  const ThinMesh mesh = thin(lab::make_grass(1000));
  EXPECT_EQ(mesh.leaf_triangles.items.size(), 2000U);
  std::vector<std::uint8_t> is_there(2000, 0);
  for (const std::uint32_t t : mesh.leaf_triangles.items) ++is_there[t];
  for (const std::uint8_t count : is_there) EXPECT_EQ(count, 1);
  ASSERT_GE(mesh.levels.size(), 5U);
  std::size_t before = 2000;
  for (const std::vector<ThinGroup>& level : mesh.levels) {
    std::uint32_t next = 0;
    std::size_t triangles = 0;
    bool is_whole = true;
    for (const ThinGroup& group : level) {
      EXPECT_EQ(group.first_leaf, next);
      next = group.end_leaf;
      EXPECT_EQ(group.material.size(), group.triangles.size());
      triangles += group.triangles.size();
      is_whole = is_whole && group.pixel_size < std::numeric_limits<double>::infinity();
      EXPECT_GT(group.pixel_size, 0.0);
    }
    EXPECT_EQ(next, mesh.leaf_triangles.size());
    if (!is_whole) continue;  // left out, for the next one
    EXPECT_LT(triangles, before);
    before = triangles;
  }
  EXPECT_LT(mesh.levels[0][0].pixel_size, 0.2) << "of a field that is 2 wide";
}

TEST(ThinMesh, SingleTrianglesAreThinnedOutFromTheFirstLevelOn) {
  // A card each is no level: nothing would be fewer.
  scene::Primitive blades = lab::make_grass(2000);
  blades.indices.clear();
  for (std::uint32_t v = 0; v + 3 < blades.positions.size(); v += 4)
    blades.indices.insert(blades.indices.end(), {v, v + 1, v + 2});
  const ThinMesh mesh = thin(blades);
  ASSERT_GE(mesh.levels.size(), 5U);
  std::vector<std::size_t> before;
  for (std::size_t leaf = 0; leaf < mesh.leaf_triangles.size(); ++leaf)
    before.push_back(mesh.leaf_triangles.of(leaf).size());
  for (const std::vector<ThinGroup>& level : mesh.levels) {
    std::vector<std::size_t> after;
    for (std::size_t g = 0; g < level.size(); ++g) {
      if (!(level[g].pixel_size < std::numeric_limits<double>::infinity())) continue;
      const std::size_t children = before.size() / level.size();
      std::size_t replaced = 0;
      for (std::size_t k = 0; k < children; ++k) replaced += before[g * children + k];
      after.push_back(level[g].triangles.size());
      EXPECT_LE(static_cast<double>(after.back()), 0.75 * static_cast<double>(replaced));
    }
    if (after.size() == level.size()) before = after;
  }
  EXPECT_LT(mesh.levels[0][0].pixel_size, std::numeric_limits<double>::infinity());
}

TEST(ThinMesh, IsTheSameForAnyThreadCountAndAtAnyScale) {
  const auto with_threads = [](int threads) {
    ThinMesh mesh;
    tbb::task_arena arena(threads);
    arena.execute([&] { mesh = thin(lab::make_box_soup(120)); });
    return mesh;
  };
  const ThinMesh one = with_threads(1), four = with_threads(4);
  const ThinMesh large = thin(lab::scaled(lab::make_box_soup(120), 1024.0));
  ASSERT_EQ(one.levels.size(), four.levels.size());
  ASSERT_EQ(one.levels.size(), large.levels.size());
  for (std::size_t l = 0; l < one.levels.size(); ++l) {
    for (std::size_t g = 0; g < one.levels[l].size(); ++g) {
      EXPECT_EQ(one.levels[l][g].pixel_size, four.levels[l][g].pixel_size);
      EXPECT_EQ(one.levels[l][g].triangles, four.levels[l][g].triangles);
      EXPECT_EQ(1024.0 * one.levels[l][g].pixel_size, large.levels[l][g].pixel_size) << "a power of two is exact";
      EXPECT_EQ(one.levels[l][g].triangles.size(), large.levels[l][g].triangles.size());
    }
  }
}

TEST(ThinMesh, FewCardsAreFivePixelsWideAtMost) {
  // A soup is full: however large its cards are, each pixel is covered.
  const ThinMesh mesh = thin(lab::make_box_soup(2000));
  std::size_t seen = 0;
  for (const std::vector<ThinGroup>& level : mesh.levels) {
    const ThinGroup& group = level.front();
    if (level.size() > 1 || group.triangles.size() > 512 || !std::isfinite(group.pixel_size)) continue;
    double area = 0.0;
    for (const Corners& c : group.triangles) area += 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
    // Settling changes the factor by little.
    EXPECT_LT(area / static_cast<double>(group.triangles.size()), 1.1 * 25.0 * group.pixel_size * group.pixel_size);
    ++seen;
  }
  EXPECT_GT(seen, 3U);
}

TEST(ThinMesh, OddPiecesEndInLevelsOrInNone) {
  // All in one place; in one line; flat on the ground; one piece; far apart and tiny; huge.
  scene::Primitive heap, flat = lab::make_grass(300), line = lab::make_grass(300), dust = lab::make_grass(300);
  for (int k = 0; k < 300; ++k) {
    const auto first = static_cast<std::uint32_t>(heap.positions.size());
    heap.positions.insert(heap.positions.end(), {{0, 0, 0}, {1.0 + 1e-3 * k, 0, 0}, {0, 1, 0}});
    heap.indices.insert(heap.indices.end(), {first, first + 1, first + 2});
  }
  for (Vec3d& p : flat.positions) p.y = 0.0;
  for (Vec3d& p : line.positions) p = {p.x, 1e-5 * p.y, 1e-5 * p.z};
  for (std::size_t v = 0; v < dust.positions.size(); ++v) {
    const Vec3d middle = dust.positions[v / 4 * 4];
    dust.positions[v] = 1e6 * middle + 1e-3 * (dust.positions[v] - middle);
  }
  for (const scene::Primitive& shape :
       {heap, flat, line, dust, lab::make_grass(1), lab::make_loose_pieces(400), lab::scaled(lab::make_grass(300), 1e9),
        lab::scaled(lab::make_grass(300), 1e-6)}) {
    const ThinMesh mesh = thin(shape);
    for (const std::vector<ThinGroup>& level : mesh.levels) {
      for (const ThinGroup& group : level) {
        EXPECT_FALSE(std::isnan(group.pixel_size));
        for (const Corners& corners : group.triangles) {
          for (const Vec3d& p : corners) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
        }
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
