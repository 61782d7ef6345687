// SPDX-License-Identifier: GPL-3.0-or-later
// --lock-borders: tiles that are built apart with one grid abut at any pair of levels, bit for bit, wherever they lie;
// and every cut of whatever else has an open border keeps each vertex of it (V114).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "builder/builder.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::builder {
namespace {

constexpr std::uint32_t kCells = 96;  // a side of a tile: two tiles share 97 vertices
constexpr std::size_t kLevels = 10;

/// A square of terrain, `size` a side, with its low corner at (x, y). What two tiles have at one place is the same.
scene::Primitive make_tile(double x, double y, double size) {
  scene::Primitive tile;
  for (std::uint32_t j = 0; j <= kCells; ++j) {
    for (std::uint32_t i = 0; i <= kCells; ++i) {
      const double u = (x + size * i / kCells) / size, v = (y + size * j / kCells) / size;
      const double height = 0.12 * std::sin(5.0 * u) * std::cos(4.0 * v) + 0.03 * std::sin(31.0 * u + 17.0 * v);
      tile.positions.push_back({u * size, v * size, double{static_cast<float>(size * height)}});
    }
  }
  for (std::uint32_t j = 0; j < kCells; ++j) {
    for (std::uint32_t i = 0; i < kCells; ++i) {
      const std::uint32_t a = j * (kCells + 1) + i, b = a + 1, c = b + kCells + 1, d = a + kCells + 1;
      tile.indices.insert(tile.indices.end(), {a, b, c, a, c, d});
    }
  }
  return tile;
}

run::Asset build_scene(const scene::Scene& scene, const PipelineOptions& options) {
  PipelineReport report;
  auto bytes = build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes) << bytes.error().message();
  auto asset = run::Asset::from_vector(std::move(*bytes));
  EXPECT_TRUE(asset) << asset.error().message();
  return std::move(*asset);
}

using Point = std::array<double, 3>;
using Edge = std::pair<Point, Point>;

/// One mesh of an asset, its clusters decoded, moved by an instance.
class Drawn {
 public:
  Drawn(const run::Asset& asset, MeshId mesh, Vec3d moved = Vec3d(0.0)) : asset_(asset), mesh_(mesh), moved_(moved) {
    auto decoded = run::decode_all(asset);
    EXPECT_TRUE(decoded) << decoded.error().message();
    clusters_ = std::move(*decoded);
  }

  /// `count` errors from the finest to the coarsest cut.
  [[nodiscard]] std::vector<double> errors(std::size_t count) const {
    const format::MeshRecord& record = asset_.meshes()[mesh_.value];
    std::set<double> all{0.0};
    for (std::uint32_t g = record.first_group; g < record.first_group + record.group_count; ++g) {
      const float error = asset_.groups()[g].error;
      if (error < format::kInfiniteError) all.insert(double{error});
    }
    const std::vector<double> sorted(all.begin(), all.end());
    std::vector<double> chosen;
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(sorted[i * (sorted.size() - 1) / (count - 1)]);
    return chosen;
  }

  [[nodiscard]] std::size_t count_triangles(double error) const {
    std::size_t count = 0;
    for (const ClusterId c : run::select_uniform(asset_, mesh_, error).clusters) {
      count += clusters_[c.value].triangles.size();
    }
    return count;
  }

  /// Edges of one triangle of a cut whose ends have this x, in the world, each from its lesser end.
  [[nodiscard]] std::set<Edge> border_at(double x, double error) const {
    std::map<Edge, int> uses;
    for (const ClusterId c : run::select_uniform(asset_, mesh_, error).clusters) {
      const run::DecodedCluster& cluster = clusters_[c.value];
      for (const auto& t : cluster.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
          ++uses[std::minmax(world(cluster.position(t[k])), world(cluster.position(t[(k + 1) % 3])))];
        }
      }
    }
    std::set<Edge> border;
    for (const auto& [edge, count] : uses) {
      if (count == 1 && edge.first[0] == x && edge.second[0] == x) border.insert(edge);
    }
    return border;
  }

 private:
  [[nodiscard]] Point world(const Vec3i& q) const {
    const format::MeshRecord& record = asset_.meshes()[mesh_.value];
    const double step = std::ldexp(static_cast<double>(record.grid.mantissa), record.grid.log2);
    Point out{};
    for (int k = 0; k < 3; ++k) out[static_cast<std::size_t>(k)] = moved_[k] + (record.origin[k] + step * q[k]);
    return out;
  }

  const run::Asset& asset_;
  MeshId mesh_;
  Vec3d moved_;
  std::vector<run::DecodedCluster> clusters_;
};

void expect_proven(const run::Asset& asset, const scene::Scene& scene) {
  const judge::VerifyReport report = judge::verify_asset(
      asset, scene, {.uniform_cuts = 20, .cameras = 3, .deviation_cuts = 2, .deviation_samples = 2000});
  EXPECT_EQ(report.finding_count, 0U);
  for (const judge::Finding& f : report.findings) ADD_FAILURE() << f.id << ' ' << f.where << ": " << f.detail;
  const auto is_of_rule = [](const judge::VerifyReport::Check& check) {
    return check.what.starts_with("every vertex of locked borders");
  };
  EXPECT_TRUE(std::any_of(report.checks.begin(), report.checks.end(), is_of_rule)) << "V114 was asked";
}

/// Pairs of cuts from (finest, coarsest) to (coarsest, finest): their borders are one polyline of so many edges.
void expect_abut(const Drawn& left, const Drawn& right, double x, std::size_t edges) {
  const std::vector<double> of_left = left.errors(kLevels), of_right = right.errors(kLevels);
  const std::set<Edge> border = left.border_at(x, 0.0);
  EXPECT_EQ(border.size(), edges);
  for (std::size_t i = 0; i < kLevels; ++i) {
    EXPECT_EQ(left.border_at(x, of_left[i]), border) << "at " << of_left[i];
    EXPECT_EQ(right.border_at(x, of_right[kLevels - 1 - i]), border) << "at " << of_right[kLevels - 1 - i];
  }
  EXPECT_LT(4 * left.count_triangles(of_left.back()), left.count_triangles(0.0)) << "or it says nothing";
}

struct Place {
  friend void PrintTo(const Place& place, std::ostream* out) { *out << place.name; }
  const char* name;
  double x, y, size, grid_step;
};

PipelineOptions locked(double grid_step = 0.0) {
  PipelineOptions options;
  options.lock_borders = true;
  options.grid_step = grid_step;
  return options;
}

class Tiles : public testing::TestWithParam<Place> {};

/// The grid's plane that x comes to.
double on_grid(double x, const run::Asset& asset) {
  const format::MeshRecord& record = asset.meshes()[0];
  const double step = std::ldexp(static_cast<double>(record.grid.mantissa), record.grid.log2);
  return std::floor(x / step + 0.5) * step;
}

TEST_P(Tiles, BuiltApartAbutAtAnyPairOfLevels) {
  const auto& [name, x, y, size, grid_step] = GetParam();
  const scene::Scene left_scene = lab::as_scene(lab::as_mesh(make_tile(x, y, size)));
  const scene::Scene right_scene = lab::as_scene(lab::as_mesh(make_tile(x + size, y, size)));
  const run::Asset left = build_scene(left_scene, locked(grid_step));
  const run::Asset right = build_scene(right_scene, locked(grid_step));
  expect_abut(Drawn(left, MeshId(0U)), Drawn(right, MeshId(0U)), on_grid(x + size, left), kCells);
  expect_proven(left, left_scene);
}

INSTANTIATE_TEST_SUITE_P(Places, Tiles,
                         testing::Values(Place{"at zero, a power of two", 0.0, 0.0, 1.0, 0x1p-14},
                                         Place{"at zero, another step", 0.0, 0.0, 1.0, 0.0001},
                                         Place{"at a million, a power of two", 1e6, -1e6, 96.0, 0x1p-10},
                                         Place{"at a million, three of them", 1e6, 2e6, 96.0, 3.0 * 0x1p-10},
                                         Place{"at a million, another step", -1e6, 1e6, 96.0, 0.007}));

TEST(Tiles, WithoutTheLockTheyDoNot) {
  PipelineOptions options = locked(0x1p-14);
  options.lock_borders = false;
  const run::Asset left = build_scene(lab::as_scene(lab::as_mesh(make_tile(0.0, 0.0, 1.0))), options);
  const Drawn drawn(left, MeshId(0U));
  EXPECT_NE(drawn.border_at(1.0, drawn.errors(kLevels).back()), drawn.border_at(1.0, 0.0))
      << "or the tests say nothing";
}

/// A piece of a kit has coordinates of its own and stands where an instance puts it.
TEST(Tiles, OfOneFileAbutWhereInstancesMoveThemByStepsOfTheGrid) {
  const double step = 3.0 * 0x1p-14;
  const Vec3d moved(5000.0 * step, 12288.0 * step, -step);
  scene::Primitive piece = make_tile(1.0, 0.0, 1.0);
  for (Vec3d& p : piece.positions) p -= moved;
  scene::Scene scene = lab::as_scene(lab::as_mesh(make_tile(0.0, 0.0, 1.0), "left"));
  scene.meshes.push_back(lab::as_mesh(std::move(piece), "right"));
  scene.instances.emplace_back().mesh = MeshId(1U);
  scene.instances.back().transform[3] = {moved.x, moved.y, moved.z, 1.0};
  const run::Asset asset = build_scene(scene, locked(step));
  expect_abut(Drawn(asset, MeshId(0U)), Drawn(asset, MeshId(1U), moved), on_grid(1.0, asset), kCells);
}

/// Two meshes of one file with the settings of each: the second one's border is not kept.
TEST(Tiles, EachMeshMayBeLockedByItself) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(make_tile(0.0, 0.0, 1.0), "left"));
  scene.meshes.push_back(lab::as_mesh(make_tile(1.0, 0.0, 1.0), "right"));
  scene.instances.emplace_back().mesh = MeshId(1U);
  PipelineOptions options = locked(0x1p-14);
  const run::Asset both = build_scene(scene, options);
  expect_abut(Drawn(both, MeshId(0U)), Drawn(both, MeshId(1U)), 1.0, kCells);

  options.mesh_options.assign(2, options);
  options.mesh_options[1].lock_borders = false;
  const run::Asset one = build_scene(scene, options);
  const Drawn left(one, MeshId(0U)), right(one, MeshId(1U));
  const std::set<Edge> border = left.border_at(1.0, 0.0);
  EXPECT_EQ(left.border_at(1.0, left.errors(kLevels).back()), border);
  EXPECT_NE(right.border_at(1.0, right.errors(kLevels).back()), border);
  expect_proven(one, scene);
}

/// What is locked is what the words say, group by group: a stuck group is one of the border, and no other is stuck.
TEST(Tiles, GroupsThatTheBorderHoldsSaySo) {
  const run::Asset asset = build_scene(lab::as_scene(lab::as_mesh(make_tile(0.0, 0.0, 1.0))), locked(0x1p-14));
  std::size_t held = 0;
  for (const format::GroupRecord& group : asset.groups()) {
    if ((group.flags & format::kGroupStuck) == 0) continue;
    EXPECT_EQ(group.stuck_reason, format::StuckReason::kBorder);
    ++held;
  }
  EXPECT_GT(held, 0U) << "384 vertices of the border take more than one cluster";
}

struct Open {
  friend void PrintTo(const Open& open, std::ostream* out) { *out << open.name; }
  const char* name;
  std::function<scene::Primitive()> make;
};

class LockedBorders : public testing::TestWithParam<Open> {};

/// With and without topology, in two tiers.
TEST_P(LockedBorders, AreInEveryCut) {
  const scene::Scene scene = lab::as_scene(lab::as_mesh(GetParam().make()));
  for (const bool keep_topology : {false, true}) {
    PipelineOptions options = locked();
    options.keep_topology = keep_topology;
    options.error_tier = keep_topology ? format::ErrorTier::kMeasured : format::ErrorTier::kQem;
    const run::Asset asset = build_scene(scene, options);
    expect_proven(asset, scene);
  }
}

/// A strip of one row, narrower than a step of its grid: there its two borders are one line, and nothing holds them.
scene::Primitive make_thread() {
  scene::Primitive thread = make_tile(0.0, 0.0, 1.0);
  for (Vec3d& p : thread.positions) p = {40.0 * p.x + p.y, 1e-6 * p.y, 0.01 * std::sin(40.0 * p.x)};
  return thread;
}

INSTANTIATE_TEST_SUITE_P(Shapes, LockedBorders,
                         testing::Values(Open{"terrain", [] { return lab::make_terrain(60, 40); }},
                                         Open{"moebius", [] { return lab::make_moebius(400, 8); }},
                                         Open{"three sheets", [] { return lab::make_three_sheets(24); }},
                                         Open{"slivers", [] { return lab::make_slivers(400); }},
                                         Open{"zero areas", [] { return lab::make_zero_areas(20); }},
                                         Open{"duplicates", [] { return lab::make_duplicates(20); }},
                                         Open{"far plane", [] { return lab::make_far_plane(24); }},
                                         Open{"foliage", [] { return lab::make_foliage(300); }},
                                         Open{"loose pieces", [] { return lab::make_loose_pieces(300); }},
                                         Open{"thread", make_thread}));

std::size_t count_locked(scene::SourceMesh mesh) {
  PrepareOptions options;
  options.locks_borders = true;
  const auto prepared = prepare_mesh(mesh, {}, options);
  EXPECT_TRUE(prepared) << prepared.error().message();
  return static_cast<std::size_t>(std::count(prepared->is_border_locked.begin(), prepared->is_border_locked.end(), 1));
}

/// The border is of the whole mesh, by exact position: an edge between two primitives is none, nor one of a copy.
TEST(OpenBorder, IsOfTheWholeMeshAndOfEdgesOfOneTriangle) {
  EXPECT_EQ(count_locked(lab::as_mesh(lab::make_plane(8))), 32U);
  EXPECT_EQ(count_locked(lab::as_mesh(lab::make_sphere(8))), 0U);
  scene::SourceMesh halves = lab::as_mesh(lab::make_plane(8));
  scene::Primitive& first = halves.primitives[0];
  scene::Primitive second = first;
  const auto middle = static_cast<std::ptrdiff_t>(first.indices.size() / 2 / 3 * 3);
  second.indices.assign(first.indices.begin() + middle, first.indices.end());
  first.indices.resize(static_cast<std::size_t>(middle));
  halves.primitives.push_back(second);
  EXPECT_EQ(count_locked(halves), 32U) << "two primitives";
  halves.primitives.push_back(second);
  EXPECT_EQ(count_locked(halves), 32U) << "and half of it twice";
  std::swap(halves.primitives.back().indices[0], halves.primitives.back().indices[1]);
  EXPECT_LT(count_locked(halves), 33U) << "another side of a triangle closes its edges";
}

}  // namespace
}  // namespace meshlode::builder
