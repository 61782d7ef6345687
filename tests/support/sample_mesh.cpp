// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/sample_mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "builder/hierarchy/culling_bounds.h"

namespace meshlode::test {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A lattice point of the parametrisation that a shape is built over; `side` parts wedges along a seam.
struct Corner {
  int face = 0, i = 0, j = 0, side = 0;
  auto operator<=>(const Corner&) const = default;
};
using CornerTriangle = std::array<Corner, 3>;
struct MaterialTriangle {
  CornerTriangle corners;
  std::uint32_t material = 0;
};
using TriangleList = std::vector<MaterialTriangle>;

using Point2 = std::pair<int, int>;
using Triangle2 = std::array<Point2, 3>;

/// Two triangles for each quad of [i0, i1] × [j0, j1] at the given step, counter-clockwise.
std::vector<Triangle2> grid_triangles(int i0, int i1, int j0, int j1, int step) {
  std::vector<Triangle2> out;
  for (int j = j0; j < j1; j += step) {
    for (int i = i0; i < i1; i += step) {
      out.push_back({Point2{i, j}, Point2{i + step, j}, Point2{i + step, j + step}});
      out.push_back({Point2{i, j}, Point2{i + step, j + step}, Point2{i, j + step}});
    }
  }
  return out;
}

/// Triangles between an outer line and a shorter inner line that lies on its left, both running the same way.
void zip(const std::vector<Point2>& outer, const std::vector<Point2>& inner, std::vector<Triangle2>& out) {
  std::size_t a = 0;
  std::size_t b = 0;
  const auto along = [&](const Point2& p) {
    const Point2 d{outer.back().first - outer.front().first, outer.back().second - outer.front().second};
    return (p.first - outer.front().first) * d.first + (p.second - outer.front().second) * d.second;
  };
  while (a + 1 < outer.size() || b + 1 < inner.size()) {
    const bool step_outer =
        b + 1 == inner.size() || (a + 1 < outer.size() && along(outer[a + 1]) <= along(inner[b + 1]));
    if (step_outer) {
      out.push_back({outer[a], outer[a + 1], inner[b]});
      ++a;
    } else {
      out.push_back({outer[a], inner[b + 1], inner[b]});
      ++b;
    }
  }
}

/// The square [0, n]² with every border vertex kept and the interior thinned to the lattice margin … n - margin.
std::vector<Triangle2> thinned_square(int n, int margin, int step) {
  std::vector<Triangle2> out = grid_triangles(margin, n - margin, margin, n - margin, step);
  const auto turn = [n](Point2 p, int quarter) {
    for (int k = 0; k < quarter; ++k) p = {n - p.second, p.first};
    return p;
  };
  for (int quarter = 0; quarter < 4; ++quarter) {
    std::vector<Point2> outer;
    std::vector<Point2> inner;
    for (int i = 0; i <= n; ++i) outer.push_back(turn({i, 0}, quarter));
    for (int i = margin; i <= n - margin; i += step) inner.push_back(turn({i, margin}, quarter));
    zip(outer, inner, out);
  }
  return out;
}

/// What a shape says about its corners.
struct Shape {
  std::function<Vec3i(const Corner&)> position;
  std::function<std::vector<float>(const Corner&)> attributes;
};

/// Adds clusters and groups from coarse to fine, which is the order of a LodDag.
class DagMaker {
 public:
  DagMaker(SampleMesh& out, const Shape& shape) : out_(out), shape_(shape) {}

  /// Starts a group; clusters follow with add_cluster.
  GroupId add_group(std::uint32_t level, double error) {
    builder::DagGroup group;
    group.level = level;
    group.first_cluster = static_cast<std::uint32_t>(out_.dag.clusters.size());
    group.is_terminal = error == kInfinity;
    group.error = error;
    group.quadric_error = group.is_terminal ? kInfinity : 0.75 * error;
    group.deviation = kInfinity;
    out_.dag.groups.push_back(group);
    out_.dag.level_count = std::max(out_.dag.level_count, level + 1);
    return GroupId{out_.dag.groups.size() - 1};
  }

  void add_cluster(std::uint32_t level, GroupId own, TriangleList triangles) {
    std::stable_sort(triangles.begin(), triangles.end(),
                     [](const MaterialTriangle& a, const MaterialTriangle& b) { return a.material < b.material; });
    builder::LodDag& dag = out_.dag;
    builder::DagCluster cluster;
    cluster.level = level;
    cluster.own_group = own;
    cluster.coarser_group = GroupId{dag.groups.size() - 1};
    cluster.first_vertex = static_cast<std::uint32_t>(dag.vertex_position.size());
    cluster.first_triangle = static_cast<std::uint32_t>(dag.triangles.size());
    cluster.triangle_count = static_cast<std::uint32_t>(triangles.size());
    std::map<Corner, std::uint8_t> local;
    for (const MaterialTriangle& triangle : triangles) {
      std::array<std::uint8_t, 3> indices{};
      for (std::size_t k = 0; k < 3; ++k) {
        const Corner& corner = triangle.corners[k];
        const auto [at, is_new] = local.emplace(corner, static_cast<std::uint8_t>(local.size()));
        indices[k] = at->second;
        if (!is_new) continue;
        dag.vertex_position.push_back(shape_.position(corner));
        const std::vector<float> attributes = shape_.attributes(corner);
        dag.vertex_attributes.insert(dag.vertex_attributes.end(), attributes.begin(), attributes.end());
      }
      dag.triangles.push_back(indices);
      dag.triangle_material.push_back(triangle.material);
    }
    cluster.vertex_count = static_cast<std::uint32_t>(local.size());
    dag.clusters.push_back(cluster);
    ++dag.groups.back().cluster_count;
  }

  /// The prepared mesh and the source: the same triangles as level 0. Vertices of equal corners are one wedge; corners
  /// with equal positions are one position.
  void set_source(const TriangleList& triangles) {
    builder::PreparedMesh& mesh = out_.mesh;
    const auto by_value = [](const Vec3i& a, const Vec3i& b) {
      return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
    };
    std::map<Vec3i, std::uint32_t, decltype(by_value)> positions(by_value);
    std::map<std::pair<std::uint32_t, std::vector<float>>, std::uint32_t> wedges;
    const std::uint32_t material_count =
        1U + std::max_element(triangles.begin(), triangles.end(), [](const auto& a, const auto& b) {
               return a.material < b.material;
             })->material;
    out_.source.name = mesh.name;
    out_.source.primitives.resize(material_count);
    std::vector<std::map<std::uint32_t, std::uint32_t>> primitive_vertex(material_count);
    for (const MaterialTriangle& triangle : triangles) {
      builder::WedgeTriangle wedge_triangle{};
      scene::Primitive& primitive = out_.source.primitives[triangle.material];
      primitive.material = MaterialId{triangle.material};
      for (std::size_t k = 0; k < 3; ++k) {
        const Corner& corner = triangle.corners[k];
        const Vec3i position = shape_.position(corner);
        const std::vector<float> attributes = shape_.attributes(corner);
        const auto [p, is_new_position] =
            positions.emplace(position, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new_position) mesh.positions.push_back(position);
        const auto [w, is_new_wedge] =
            wedges.emplace(std::pair{p->second, attributes}, static_cast<std::uint32_t>(mesh.wedge_position.size()));
        if (is_new_wedge) {
          mesh.wedge_position.push_back(p->second);
          mesh.wedge_attributes.insert(mesh.wedge_attributes.end(), attributes.begin(), attributes.end());
        }
        wedge_triangle[k] = w->second;
        const auto [v, is_new_vertex] = primitive_vertex[triangle.material].emplace(
            w->second, static_cast<std::uint32_t>(primitive.positions.size()));
        if (is_new_vertex) add_source_vertex(primitive, position, attributes);
        primitive.indices.push_back(v->second);
      }
      mesh.triangles.push_back(wedge_triangle);
      mesh.triangle_material.push_back(triangle.material);
    }
    mesh.source_triangles = mesh.triangles.size();
    for (const scene::Primitive& primitive : out_.source.primitives) mesh.source_vertices += primitive.positions.size();
    Vec3i low = mesh.positions.front();
    Vec3i high = low;
    for (const Vec3i& p : mesh.positions) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    mesh.diagonal = glm::length(mesh.grid.decode(high - low));
  }

 private:
  void add_source_vertex(scene::Primitive& primitive, const Vec3i& position,
                         const std::vector<float>& attributes) const {
    const builder::AttributeLayout& layout = out_.mesh.layout;
    primitive.positions.push_back(out_.mesh.origin + out_.mesh.grid.decode(position));
    if (layout.has_normal) primitive.normals.emplace_back(attributes[0], attributes[1], attributes[2]);
    if (layout.uv_set_count > 0) {
      primitive.uvs[0].emplace_back(attributes[layout.uv_offset()], attributes[layout.uv_offset() + 1]);
    }
    if (layout.has_color) {
      const float* c = &attributes[layout.color_offset()];
      primitive.colors.emplace_back(c[0], c[1], c[2], c[3]);
    }
  }

  SampleMesh& out_;
  const Shape& shape_;
};

double radius_around(const Vec3d& center, const SampleMesh& sample, const builder::DagCluster& cluster) {
  double radius = 0.0;
  for (std::size_t v = cluster.first_vertex; v < std::size_t{cluster.first_vertex} + cluster.vertex_count; ++v) {
    radius = std::max(radius, glm::length(sample.mesh.grid.decode(sample.dag.vertex_position[v]) - center));
  }
  return radius;
}

/// Spheres around box centres, grown by a part in a thousand at each step: far above every rounding (I4).
void fill_hierarchy(SampleMesh& sample) {
  constexpr double kMargin = 1.001;
  const builder::LodDag& dag = sample.dag;
  builder::Hierarchy& out = sample.hierarchy;
  const auto to_sphere = [](const Vec3d& center, double radius) {
    return builder::Hierarchy::Sphere{
        {static_cast<float>(center.x), static_cast<float>(center.y), static_cast<float>(center.z)},
        static_cast<float>(radius * kMargin)};
  };
  const auto center_of = [](const builder::Hierarchy::Sphere& sphere) {
    return Vec3d(sphere.center[0], sphere.center[1], sphere.center[2]);
  };
  const auto box_center = [&](std::uint32_t first_cluster, std::uint32_t cluster_count) {
    Vec3d low(kInfinity);
    Vec3d high(-kInfinity);
    for (std::uint32_t c = first_cluster; c < first_cluster + cluster_count; ++c) {
      const builder::DagCluster& cluster = dag.clusters[c];
      for (std::size_t v = cluster.first_vertex; v < std::size_t{cluster.first_vertex} + cluster.vertex_count; ++v) {
        low = glm::min(low, sample.mesh.grid.decode(dag.vertex_position[v]));
        high = glm::max(high, sample.mesh.grid.decode(dag.vertex_position[v]));
      }
    }
    return (low + high) * 0.5;
  };

  out.cluster_cones.assign(dag.clusters.size(), builder::Hierarchy::Cone{{0, 0, 127}, 127});  // never culled
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    const Vec3d center = box_center(c, 1);
    out.cluster_spheres.push_back(to_sphere(center, radius_around(center, sample, dag.clusters[c])));
  }
  out.sphere_log2 = builder::choose_sphere_log2(out.cluster_spheres);
  for (builder::Hierarchy::Sphere& sphere : out.cluster_spheres) sphere = builder::snap_sphere(sphere, out.sphere_log2);
  out.group_spheres.resize(dag.groups.size());
  out.group_errors.resize(dag.groups.size());
  for (std::size_t g = dag.groups.size(); g-- > 0;) {  // fine to coarse: the spheres below exist already
    const builder::DagGroup& group = dag.groups[g];
    const Vec3d center = box_center(group.first_cluster, group.cluster_count);
    double radius = 0.0;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const builder::DagCluster& cluster = dag.clusters[c];
      const builder::Hierarchy::Sphere& tight = out.cluster_spheres[c];
      radius = std::max(radius, glm::length(center_of(tight) - center) + double(tight.radius));
      if (!cluster.own_group.is_valid()) continue;
      const builder::Hierarchy::Sphere& finer = out.group_spheres[cluster.own_group.value];
      radius = std::max(radius, glm::length(center_of(finer) - center) + double(finer.radius));
    }
    out.group_spheres[g] = to_sphere(center, radius);
    out.group_errors[g] = group.is_terminal ? format::kInfiniteError : static_cast<float>(group.error);
  }

  // The root, a leaf for each coarse group, and an inner node above the leaves of level 0 where there is more than one.
  std::vector<std::uint32_t> coarse;
  std::vector<std::uint32_t> fine;
  for (std::uint32_t g = 0; g < dag.groups.size(); ++g) {
    (dag.groups[g].level > 0 || dag.groups.size() == 1 ? coarse : fine).push_back(g);
  }
  const auto leaf = [&](std::uint32_t g) {
    format::NodeRecord node{};
    std::copy(std::begin(out.group_spheres[g].center), std::end(out.group_spheres[g].center), std::begin(node.center));
    node.radius = out.group_spheres[g].radius;
    node.error = out.group_errors[g];
    node.first = g;
    return node;
  };
  const auto above = [&](const std::vector<format::NodeRecord>& children, std::uint32_t first) {
    format::NodeRecord node{};
    Vec3d center(0.0);
    for (const auto& child : children) center += Vec3d(child.center[0], child.center[1], child.center[2]);
    center /= double(children.size());
    double radius = 0.0;
    for (const auto& child : children) {
      const Vec3d apart = Vec3d(child.center[0], child.center[1], child.center[2]) - center;
      radius = std::max(radius, glm::length(apart) + double(child.radius));
      node.error = std::max(node.error, child.error);
    }
    const builder::Hierarchy::Sphere sphere = to_sphere(center, radius);
    std::copy(std::begin(sphere.center), std::end(sphere.center), std::begin(node.center));
    node.radius = sphere.radius;
    node.first = first;
    node.child_count = static_cast<std::uint32_t>(children.size());
    return node;
  };
  std::vector<format::NodeRecord> top;
  std::vector<format::NodeRecord> bottom;
  for (const std::uint32_t g : coarse) top.push_back(leaf(g));
  for (const std::uint32_t g : fine) bottom.push_back(leaf(g));
  if (!bottom.empty()) top.push_back(above(bottom, static_cast<std::uint32_t>(1 + top.size() + 1)));
  out.nodes.push_back(above(top, 1));
  out.nodes.insert(out.nodes.end(), top.begin(), top.end());
  out.nodes.insert(out.nodes.end(), bottom.begin(), bottom.end());
}

/// The triangles of one face, moved by (di, dj), that `keep` wants; the material by the side of x = `seam`.
TriangleList on_face(const std::vector<Triangle2>& triangles, int face, int di, int dj, int seam,
                     const std::function<bool(const Triangle2&)>& keep) {
  TriangleList out;
  for (const Triangle2& triangle : triangles) {
    if (!keep(triangle)) continue;
    const int sum = triangle[0].first + triangle[1].first + triangle[2].first + 3 * di;
    const int side = sum > 3 * seam ? 1 : 0;
    MaterialTriangle placed;
    placed.material = static_cast<std::uint32_t>(side);
    for (std::size_t k = 0; k < 3; ++k) {
      placed.corners[k] = {face, triangle[k].first + di, triangle[k].second + dj, side};
    }
    out.push_back(placed);
  }
  return out;
}

std::function<bool(const Triangle2&)> west_of(int middle, bool is_west) {
  return
      [middle, is_west](const Triangle2& t) { return (t[0].first + t[1].first + t[2].first < 3 * middle) == is_west; };
}

bool keep_all(const Triangle2&) {
  return true;
}

void append(TriangleList& to, const TriangleList& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

SampleMesh sample_patch() {
  SampleMesh out;
  out.mesh.name = "patch";
  out.mesh.origin = {100.0, -20.0, 3.0};
  out.mesh.grid.log2 = -6;
  out.mesh.level0_deviation = 0.0;
  out.mesh.layout.has_normal = true;
  out.mesh.layout.uv_set_count = 1;
  const auto height = [](int i, int j) { return (i * (16 - i) * j * (16 - j)) / 32 + (i * 7 + j * 13) % 5; };
  Shape shape;
  shape.position = [height](const Corner& c) { return Vec3i(64 * c.i - 512, 64 * c.j - 512, height(c.i, c.j)); };
  shape.attributes = [height](const Corner& c) {
    const double dx = height(c.i + 1, c.j) - height(c.i - 1, c.j);
    const double dy = height(c.i, c.j + 1) - height(c.i, c.j - 1);
    const double length = std::sqrt(dx * dx + dy * dy + 128.0 * 128.0);
    const double u = c.i / 16.0 + (c.side == 1 ? 0.25 : 0.0);  // the seam: two wedges along x = 8
    return std::vector<float>{static_cast<float>(-dx / length), static_cast<float>(-dy / length),
                              static_cast<float>(128.0 / length), static_cast<float>(u),
                              static_cast<float>(c.j / 16.0)};
  };

  DagMaker maker(out, shape);
  const std::vector<Triangle2> coarse = thinned_square(16, 4, 4);
  const std::vector<Triangle2> medium = thinned_square(8, 2, 2);
  const GroupId terminal = maker.add_group(2, kInfinity);
  const GroupId middle{terminal.value + 1};
  for (const bool is_west : {true, false}) {
    maker.add_cluster(2, middle, on_face(coarse, 0, 0, 0, 8, west_of(8, is_west)));
  }
  maker.add_group(1, 0.25);
  for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
    const int di = quarter % 2 == 0 ? 0 : 8;
    const int dj = quarter < 2 ? 0 : 8;
    for (const bool is_west : {true, false}) {
      maker.add_cluster(1, GroupId{middle.value + 1 + quarter}, on_face(medium, 0, di, dj, 8, west_of(4, is_west)));
    }
  }
  TriangleList all;
  for (int quarter = 0; quarter < 4; ++quarter) {
    maker.add_group(0, 0.0625 * (1.0 + quarter / 8.0));
    for (int part = 0; part < 4; ++part) {
      const int i0 = (quarter % 2) * 8 + (part % 2) * 4;
      const int j0 = (quarter / 2) * 8 + (part / 2) * 4;
      const TriangleList triangles = on_face(grid_triangles(i0, i0 + 4, j0, j0 + 4, 1), 0, 0, 0, 8, keep_all);
      maker.add_cluster(0, GroupId{}, triangles);
      append(all, triangles);
    }
  }
  maker.set_source(all);
  fill_hierarchy(out);
  return out;
}

SampleMesh sample_sphere() {
  SampleMesh out;
  out.mesh.name = "sphere";
  out.mesh.grid.log2 = -10;
  out.mesh.layout.has_normal = true;
  out.mesh.layout.has_color = true;
  // Face f spans the axes (f, f + 1, f + 2) mod 3, mirrored so that all six are counter-clockwise from outside.
  const auto on_cube = [](const Corner& c) {
    const int axis = c.face % 3;
    Vec3i p;
    p[axis] = c.face < 3 ? 4 : -4;
    p[(axis + 1) % 3] = c.face < 3 ? c.i - 4 : c.j - 4;
    p[(axis + 2) % 3] = c.face < 3 ? c.j - 4 : c.i - 4;
    return p;
  };
  Shape shape;
  shape.position = [on_cube](const Corner& c) {
    const Vec3d p(on_cube(c));
    const Vec3d on_sphere = p / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) * 1000.0;
    return Vec3i(static_cast<int>(std::floor(on_sphere.x + 0.5)), static_cast<int>(std::floor(on_sphere.y + 0.5)),
                 static_cast<int>(std::floor(on_sphere.z + 0.5)));
  };
  shape.attributes = [on_cube](const Corner& c) {
    const Vec3d p(on_cube(c));
    const Vec3d normal = p / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    return std::vector<float>{static_cast<float>(normal.x),
                              static_cast<float>(normal.y),
                              static_cast<float>(normal.z),
                              static_cast<float>((p.x + 4.0) / 8.0),
                              static_cast<float>((p.y + 4.0) / 8.0),
                              static_cast<float>((p.z + 4.0) / 8.0),
                              1.0F};
  };

  DagMaker maker(out, shape);
  const GroupId terminal = maker.add_group(2, kInfinity);
  const GroupId middle{terminal.value + 1};
  const int no_seam = 1000;
  TriangleList cube;
  for (int face = 0; face < 6; ++face)
    append(cube, on_face(grid_triangles(0, 8, 0, 8, 8), face, 0, 0, no_seam, keep_all));
  // The parametrisation names a point of an edge once for each face; a cluster wants it once.
  std::map<std::array<int, 3>, Corner> unique;
  for (MaterialTriangle& triangle : cube) {
    for (Corner& corner : triangle.corners) {
      const Vec3i p = on_cube(corner);
      corner = unique.emplace(std::array{p.x, p.y, p.z}, corner).first->second;
    }
  }
  maker.add_cluster(2, middle, cube);
  maker.add_group(1, 0.375);
  const std::vector<Triangle2> medium = thinned_square(8, 2, 2);
  for (int face = 0; face < 6; ++face) {
    for (const bool is_west : {true, false}) {
      maker.add_cluster(1, GroupId{middle.value + 1 + static_cast<std::uint32_t>(face)},
                        on_face(medium, face, 0, 0, no_seam, west_of(4, is_west)));
    }
  }
  TriangleList all;
  for (int face = 0; face < 6; ++face) {
    maker.add_group(0, 0.03125 * (1.0 + face / 8.0));
    for (int part = 0; part < 4; ++part) {
      const int i0 = (part % 2) * 4;
      const int j0 = (part / 2) * 4;
      const TriangleList triangles = on_face(grid_triangles(i0, i0 + 4, j0, j0 + 4, 1), face, 0, 0, no_seam, keep_all);
      maker.add_cluster(0, GroupId{}, triangles);
      append(all, triangles);
    }
  }
  maker.set_source(all);
  fill_hierarchy(out);
  return out;
}

SampleMesh sample_tetrahedron() {
  SampleMesh out;
  out.mesh.name = "tetrahedron";
  out.mesh.origin = {1e6, 1e6, 1e6};
  out.mesh.grid.log2 = -12;
  out.mesh.grid.mantissa = 3;
  out.mesh.layout.flat_normal = true;
  Shape shape;
  shape.position = [](const Corner& c) { return Vec3i((c.i & 1) * 8, (c.i >> 1 & 1) * 8, (c.i >> 2 & 1) * 8); };
  shape.attributes = [](const Corner&) { return std::vector<float>{}; };
  DagMaker maker(out, shape);
  TriangleList triangles;
  const std::array<std::array<int, 3>, 4> faces{{{0, 2, 1}, {0, 1, 4}, {0, 4, 2}, {1, 2, 4}}};
  for (const auto& face : faces) {
    MaterialTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) triangle.corners[k] = {0, face[k], 0, 0};
    triangles.push_back(triangle);
  }
  maker.add_group(0, kInfinity);
  maker.add_cluster(0, GroupId{}, triangles);
  maker.set_source(triangles);
  fill_hierarchy(out);
  return out;
}

}  // namespace meshlode::test
