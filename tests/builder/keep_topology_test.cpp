// SPDX-License-Identifier: GPL-3.0-or-later
// --keep-topology: whatever groups are replaced, what is drawn of a manifold is a manifold, and has as many pieces,
// holes and handles as level 0. Cuts are drawn at random over the DAG, far more mixed than any camera's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"
#include "builder/builder.h"
#include "builder/dag/build_dag.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "builder/stage_options.h"
#include "lab/samples/samples.h"
#include "scene/import/import.h"
#include "support/open_surface.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::Random;

/// Of triangles between places. Triangles with two corners in one place are edges (level 0 alone has some).
struct Topology {
  std::uint64_t crowded = 0;  ///< edges of more than two triangles
  std::uint64_t turned = 0;   ///< edges that two triangles use in the same direction
  std::uint64_t pinches = 0;  ///< fans of triangles around vertices, less the vertices
  std::uint64_t pieces = 0;   ///< connected across edges
  std::int64_t euler = 0;     ///< fans - edges + triangles
  std::uint64_t open = 0;     ///< loops of the border

  [[nodiscard]] bool is_manifold() const { return crowded == 0 && turned == 0 && pinches == 0; }
  bool operator==(const Topology&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Topology& t) {
  return out << t.crowded << " crowded and " << t.turned << " turned edges, " << t.pinches << " pinches, " << t.pieces
             << " pieces, Euler characteristic " << t.euler << ", " << t.open << " border loops";
}

Topology topology_of(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  struct Use {
    std::uint32_t low, high, corner, other;  ///< corner: of the triangle at `low`, other: at `high`
    bool is_up;
  };
  std::vector<Use> uses;
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      const std::uint32_t at_a = 3 * t + k, at_b = 3 * t + (k + 1) % 3;
      uses.push_back(a < b ? Use{a, b, at_a, at_b, true} : Use{b, a, at_b, at_a, false});
      vertices.push_back(a);
    }
  }
  const auto key = [](const Use& use) { return std::pair(use.low, use.high); };
  std::sort(uses.begin(), uses.end(), [&](const Use& x, const Use& y) { return key(x) < key(y); });
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  Topology topology;
  DisjointSets fans(3 * triangles.size()), pieces(triangles.size());
  std::uint64_t fan_count = 3 * triangles.size(), edge_count = 0;
  topology.pieces = triangles.size();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> border;  // corners at both ends
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    for (end = i + 1; end < uses.size() && key(uses[end]) == key(uses[i]); ++end) {
      fan_count -= fans.join(uses[i].corner, uses[end].corner) ? 1 : 0;
      fan_count -= fans.join(uses[i].other, uses[end].other) ? 1 : 0;
      topology.pieces -= pieces.join(uses[i].corner / 3, uses[end].corner / 3) ? 1 : 0;
    }
    ++edge_count;
    topology.crowded += end - i > 2 ? 1 : 0;
    topology.turned += end - i == 2 && uses[i].is_up == uses[i + 1].is_up ? 1 : 0;
    if (end - i == 1) border.emplace_back(uses[i].corner, uses[i].other);
  }
  DisjointSets loops(3 * triangles.size());
  std::vector<std::uint32_t> at_border;
  for (const auto& [from, to] : border) {
    loops.join(fans.find(from), fans.find(to));
    at_border.push_back(fans.find(from));
  }
  for (std::uint32_t& fan : at_border) fan = loops.find(fan);
  std::sort(at_border.begin(), at_border.end());
  topology.open = static_cast<std::uint64_t>(std::unique(at_border.begin(), at_border.end()) - at_border.begin());
  topology.pinches = fan_count - vertices.size();
  topology.euler = static_cast<std::int64_t>(fan_count + triangles.size()) - static_cast<std::int64_t>(edge_count);
  return topology;
}

/// What is drawn where these groups are replaced.
Topology topology_of(const LodDag& dag, const std::vector<std::uint8_t>& is_replaced) {
  std::map<std::array<int, 3>, std::uint32_t> names;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const DagCluster& cluster : dag.clusters) {
    if (cluster.own_group.is_valid() && is_replaced[cluster.own_group.value] == 0) continue;
    if (is_replaced[cluster.coarser_group.value] != 0) continue;
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3i& p = dag.vertex_position[cluster.first_vertex + dag.triangles[t][k]];
        triangle[k] = names.emplace(std::array{p.x, p.y, p.z}, static_cast<std::uint32_t>(names.size())).first->second;
      }
      const bool is_edge = triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
      if (!is_edge) triangles.push_back(triangle);
    }
  }
  return topology_of(triangles);
}

/// Each group that can be replaced is, by the chance in percent. Groups are from coarse to fine.
std::vector<std::uint8_t> draw_cut(const LodDag& dag, std::uint64_t chance, Random& random) {
  std::vector<std::uint8_t> is_replaced(dag.groups.size(), 0);
  for (std::size_t g = dag.groups.size(); g-- > 0;) {
    const DagGroup& group = dag.groups[g];
    bool is_there = !group.is_terminal;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const GroupId own = dag.clusters[c].own_group;
      is_there = is_there && (!own.is_valid() || is_replaced[own.value] != 0);
    }
    is_replaced[g] = is_there && random.below(100) < chance ? 1 : 0;
  }
  return is_replaced;
}

std::vector<std::uint8_t> uniform_cut(const LodDag& dag, double error) {
  std::vector<std::uint8_t> is_replaced(dag.groups.size(), 0);
  for (std::size_t g = 0; g < dag.groups.size(); ++g) is_replaced[g] = dag.groups[g].error <= error ? 1 : 0;
  return is_replaced;
}

struct Shape {
  std::string name;
  scene::SourceMesh mesh;
  double position_error = 0.0;  ///< 0: as usual
  std::uint32_t cluster_triangles = 128;
};

LodDag build_kept(const Shape& shape, bool keep_topology = true) {
  PipelineOptions options;
  options.keep_topology = keep_topology;
  options.error_tier = format::ErrorTier::kQem;  // needs no sampling; what is drawn is the same
  options.position_error = shape.position_error;
  options.max_cluster_triangles = shape.cluster_triangles;
  const MeshPlan plan = plan_mesh(shape.mesh, {}, {AttributeChoice::kAuto}, shape.name);
  const auto prepared = prepare_mesh(shape.mesh, plan.layout, prepare_options(options));
  EXPECT_TRUE(prepared.ok());
  if (!prepared) return {};
  const auto dag = build_dag(*prepared, dag_options(options, *prepared, EncodeOptions{}));
  EXPECT_TRUE(dag.ok());
  return dag ? *dag : LodDag{};
}

struct Kept {
  Topology source;
  std::size_t coarsest = 0;  ///< triangles of the coarsest cut
};

/// Draws cuts and holds them to level 0.
Kept expect_kept(const Shape& shape, std::uint32_t mixed_cuts, std::uint32_t uniform_cuts) {
  const LodDag dag = build_kept(shape);
  const Topology source = topology_of(dag, std::vector<std::uint8_t>(dag.groups.size(), 0));
  const bool is_manifold = source.is_manifold();
  const auto expect = [&](const std::vector<std::uint8_t>& is_replaced, const std::string& what) {
    const Topology cut = topology_of(dag, is_replaced);
    if (is_manifold) {
      EXPECT_EQ(cut, source) << shape.name << ", " << what;
    } else {
      EXPECT_LE(cut.crowded, source.crowded) << shape.name << ", " << what;
    }
  };
  Random random(7);
  for (std::uint32_t i = 0; i < mixed_cuts; ++i) {
    const std::uint64_t chance = 30 + random.below(70);
    expect(draw_cut(dag, chance, random), "mixed cut " + std::to_string(i));
  }
  std::vector<double> errors;
  for (const DagGroup& group : dag.groups) {
    if (std::isfinite(group.error)) errors.push_back(group.error);
  }
  std::sort(errors.begin(), errors.end());
  for (std::uint32_t i = 1; i <= uniform_cuts && !errors.empty(); ++i) {
    expect(uniform_cut(dag, errors[i * errors.size() / uniform_cuts - 1]), "uniform cut " + std::to_string(i));
  }
  std::size_t coarsest = 0;
  for (const DagCluster& cluster : dag.clusters) {
    coarsest += dag.groups[cluster.coarser_group.value].is_terminal ? cluster.triangle_count : 0;
  }
  return {source, coarsest};
}

/// A tube around a closed curve. \pre its parts are farther apart than two radii
template <class Curve>
scene::SourceMesh tube(const Curve& curve, std::uint32_t along, std::uint32_t around, double radius) {
  scene::Primitive shape;
  constexpr double kTurn = 6.283185307179586;
  for (std::uint32_t i = 0; i < along; ++i) {
    const double t = kTurn * i / along;
    const Vec3d center = curve(t), tangent = glm::normalize(curve(t + 1e-4) - curve(t - 1e-4));
    const Vec3d side = glm::normalize(glm::cross(tangent, Vec3d(0.1, 0.2, 1.0)));
    const Vec3d up = glm::cross(side, tangent);
    for (std::uint32_t j = 0; j < around; ++j) {
      const double a = kTurn * j / around;
      shape.positions.push_back(center + radius * (std::cos(a) * side + std::sin(a) * up));
    }
  }
  for (std::uint32_t i = 0; i < along; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around;
      const std::uint32_t c = (i + 1) % along * around + j, d = (i + 1) % along * around + (j + 1) % around;
      for (const std::uint32_t v : {a, c, b, b, c, d}) shape.indices.push_back(v);
    }
  }
  return lab::as_mesh(std::move(shape));
}

scene::SourceMesh trefoil(std::uint32_t along, std::uint32_t around, double radius) {
  return tube(
      [](double t) {
        return Vec3d(std::sin(t) + 2.0 * std::sin(2.0 * t), std::cos(t) - 2.0 * std::cos(2.0 * t), -std::sin(3.0 * t));
      },
      along, around, radius);
}

/// A block of `n`³ cells with a shaft through the middle of every `pitch`-th row along each axis, by its faces: handles
/// by the dozen. Shafts of one axis meet those of the others.
scene::SourceMesh sponge(int n, int pitch, double bend) {
  const auto is_solid = [&](int x, int y, int z) {
    for (const int c : {x, y, z}) {
      if (c < 0 || c >= n) return false;
    }
    const auto is_shaft = [&](int a, int b) { return a % pitch == pitch / 2 && b % pitch == pitch / 2; };
    return !is_shaft(x, y) && !is_shaft(y, z) && !is_shaft(z, x);
  };
  scene::Primitive shape;
  std::map<std::array<int, 3>, std::uint32_t> ids;
  const auto id_of = [&](int x, int y, int z) {
    const auto [at, is_new] = ids.emplace(std::array{x, y, z}, static_cast<std::uint32_t>(shape.positions.size()));
    if (is_new) shape.positions.emplace_back(x + 2.0 * bend * y * z, y + bend * x * x, z + bend * x * y);
    return at->second;
  };
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z) {
        if (!is_solid(x, y, z)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          for (const int side : {0, 1}) {
            std::array<int, 3> next{x, y, z};
            next[axis] += side == 0 ? -1 : 1;
            if (is_solid(next[0], next[1], next[2])) continue;
            std::array<std::uint32_t, 4> corner{};
            for (std::size_t k = 0; k < 4; ++k) {
              std::array<int, 3> p{x, y, z};
              p[axis] += side;
              p[(axis + 1) % 3] += k == 1 || k == 2 ? 1 : 0;
              p[(axis + 2) % 3] += k >= 2 ? 1 : 0;
              corner[k] = id_of(p[0], p[1], p[2]);
            }
            if (side == 0) std::swap(corner[1], corner[3]);
            for (const std::size_t k : {0U, 1U, 2U, 0U, 2U, 3U}) shape.indices.push_back(corner[k]);
          }
        }
      }
    }
  }
  return lab::as_mesh(std::move(shape));
}

/// Two closed sheets `gap` apart, of which each is `thickness` thin.
scene::SourceMesh two_blades(std::uint32_t n, double thickness, double gap) {
  scene::Primitive both = lab::make_blade(n, thickness);
  const auto count = static_cast<std::uint32_t>(both.positions.size());
  const std::vector<std::uint32_t> indices = both.indices;
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vec3d p = both.positions[v];
    both.positions.push_back(p + Vec3d(0.013, 1.0, 0.007) * gap);
  }
  for (const std::uint32_t v : indices) both.indices.push_back(v + count);
  return lab::as_mesh(std::move(both));
}

/// A closed shell of `n` x `n` cells, rough as whole numbers, whose two sides are one apart everywhere: what moves on
/// one side comes to where the other one is.
scene::SourceMesh rough_shell(int n, std::uint64_t seed) {
  Random random(seed);
  scene::Primitive shape;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const auto height = static_cast<double>(random.below(4));
      shape.positions.emplace_back(i, j, height);
      shape.positions.emplace_back(i, j, height + 1.0);
    }
  }
  const auto id = [n](int i, int j, int side) { return static_cast<std::uint32_t>(2 * (i * (n + 1) + j) + side); };
  const auto add_quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    for (const std::uint32_t v : {a, b, c, a, c, d}) shape.indices.push_back(v);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      add_quad(id(i, j, 1), id(i + 1, j, 1), id(i + 1, j + 1, 1), id(i, j + 1, 1));
      add_quad(id(i, j, 0), id(i, j + 1, 0), id(i + 1, j + 1, 0), id(i + 1, j, 0));
    }
    add_quad(id(i, 0, 0), id(i + 1, 0, 0), id(i + 1, 0, 1), id(i, 0, 1));
    add_quad(id(n, i, 0), id(n, i + 1, 0), id(n, i + 1, 1), id(n, i, 1));
    add_quad(id(i + 1, n, 0), id(i, n, 0), id(i, n, 1), id(i + 1, n, 1));
    add_quad(id(0, i + 1, 0), id(0, i, 0), id(0, i, 1), id(0, i + 1, 1));
  }
  return lab::as_mesh(std::move(shape));
}

std::vector<Shape> closed_shapes() {
  std::vector<Shape> shapes;
  shapes.push_back({"torus", lab::as_mesh(lab::make_torus(96, 32)), 0.0});
  shapes.push_back({"thin torus", lab::as_mesh(lab::make_torus(300, 8, 1.0, 0.01)), 0.0, 64});
  shapes.push_back({"thin torus on a coarse grid", lab::as_mesh(lab::make_torus(300, 8, 1.0, 0.02)), 0.003, 64});
  shapes.push_back({"trefoil", trefoil(320, 12, 0.2), 0.0, 64});
  shapes.push_back({"trefoil on a coarse grid", trefoil(320, 12, 0.1), 0.01, 32});
  shapes.push_back({"blade", lab::as_mesh(lab::make_blade(30)), 0.0});
  shapes.push_back({"two blades", two_blades(30, 2e-3, 4e-3), 0.0, 64});
  shapes.push_back({"sponge", sponge(20, 4, 1e-3), 0.0});
  shapes.push_back({"sponge in small clusters", sponge(16, 4, 1e-3), 0.0, 24});
  shapes.push_back({"sphere on a coarse grid", lab::as_mesh(lab::make_sphere(24)), 0.02, 32});
  shapes.push_back({"flat cube", lab::as_mesh(lab::make_cube(24)), 0.02, 32});
  // Where the grid's step is a cell's, a vertex can hardly go anywhere but where one is or was.
  shapes.push_back({"cube on its own cells", lab::as_mesh(lab::make_cube(32)), 0.055, 32});
  shapes.push_back({"sponge on its own cells", sponge(20, 4, 0.0), 0.87, 32});
  for (const std::uint64_t seed : {1U, 2U}) {
    shapes.push_back({"rough shell " + std::to_string(seed), rough_shell(40, seed), 0.87, 24});
  }
  shapes.push_back({"boxes", lab::as_mesh(lab::make_box_soup(60)), 0.0});
  shapes.push_back({"rock", lab::as_mesh(lab::make_rock(20)), 0.0});
  return shapes;
}

TEST(KeepTopology, WhatIsCountedIsTheTopology) {
  EXPECT_EQ(topology_of({{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}}), (Topology{0, 0, 0, 1, 2, 0}));
  EXPECT_EQ(topology_of({{{0, 1, 2}}}), (Topology{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(topology_of({{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}}).crowded, 1U);
  EXPECT_EQ(topology_of({{{0, 1, 2}, {0, 1, 3}}}).turned, 1U);
  const Topology bow = topology_of({{{0, 1, 2}, {0, 3, 4}}});
  EXPECT_EQ(bow, (Topology{0, 0, 1, 2, 2, 2}));
}

TEST(KeepTopology, EveryCutOfAClosedManifoldIsOneOfTheSameTopology) {
  for (const Shape& shape : closed_shapes()) {
    const Topology source = expect_kept(shape, 24, 10).source;
    EXPECT_TRUE(source.is_manifold() && source.open == 0) << shape.name << ": " << source;
  }
}

TEST(KeepTopology, WithoutItTheSameShapesLoseTheirs) {
  std::uint32_t broken = 0;
  for (const Shape& shape : closed_shapes()) {
    const LodDag dag = build_kept(shape, false);
    const std::vector<std::uint8_t> none(dag.groups.size(), 0);
    Random random(7);
    broken += topology_of(dag, draw_cut(dag, 100, random)) == topology_of(dag, none) ? 0 : 1;
  }
  EXPECT_GE(broken, 6U) << "or they say little";
}

TEST(KeepTopology, ItIsNotKeptAtThePriceOfNoLevels) {
  EXPECT_LE(expect_kept({"torus", lab::as_mesh(lab::make_torus(96, 32)), 0.0}, 4, 4).coarsest, 128U);
  EXPECT_LE(expect_kept({"trefoil", trefoil(320, 12, 0.2), 0.0}, 4, 4).coarsest, 256U);
}

TEST(KeepTopology, OpenSurfacesKeepTheirLoops) {
  std::uint32_t manifolds = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    Random random(seed);
    test::OpenSurfaceOptions options = test::random_surface_options(random, 40);
    options.side = 24;
    if (seed % 2 == 0) options = {.side = 24, .spacing = 30, .noise = 14};
    test::IntegerMesh surface = test::make_open_surface(options, random);
    if (seed % 2 == 0) {  // eight holes that touch nothing
      std::vector<std::array<std::uint32_t, 3>> rest;
      for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const bool is_hole = t / 48 % 5 == 3 && (t % 48 == 10 || t % 48 == 30);
        if (!is_hole) rest.push_back(surface.triangles[t]);
      }
      surface.triangles = std::move(rest);
    }
    const Shape shape{"surface " + std::to_string(seed), lab::as_mesh(test::as_primitive(surface, 1e-3)),
                      seed % 3 == 0 ? 0.004 : 0.0, 24};
    manifolds += expect_kept(shape, 20, 10).source.is_manifold() ? 1 : 0;
  }
  EXPECT_GE(manifolds, 8U) << "the others are held to fewer things";
}

TEST(KeepTopology, TheBunnyStaysAManifold) {
  const char* folder = std::getenv("MESHLODE_MODELS");
  const std::filesystem::path path = std::filesystem::path(folder ? folder : "") / "bunny.glb";
  if (folder == nullptr || !std::filesystem::exists(path)) GTEST_SKIP() << "set MESHLODE_MODELS to run this test";
  const auto scene = scene::import_scene(path, {});
  ASSERT_TRUE(scene.ok());
  expect_kept({"bunny", scene->meshes[0], 0.0}, 3, 3);
}

}  // namespace
}  // namespace meshlode::builder
