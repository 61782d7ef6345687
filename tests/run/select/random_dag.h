// SPDX-License-Identifier: GPL-3.0-or-later
// Random LOD DAGs, transforms and cameras, so that selection is tested without the stages that build real DAGs.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "builder/hierarchy/hierarchy.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"
#include "run/select/select.h"
#include "support/random.h"

namespace meshlode::test {

struct RandomDagOptions {
  std::uint32_t leaf_clusters = 200;
  int grid_log2 = -20;  ///< coordinates span about 2^20 grid steps: -20 gives a mesh of size 1
  double stuck_chance = 0.03;
  double zero_error_chance = 0.1;
  double defer_chance = 0.1;  ///< a cluster waits for the next round, so that groups mix levels
};

struct RandomDag {
  builder::LodDag dag;
  builder::PreparedMesh mesh;
};

/// A DAG whose errors do not nest and whose coarser clusters leave the finer ones' bounds: the hierarchy has to mend
/// both.
inline RandomDag make_random_dag(RandomSource& random, const RandomDagOptions& options) {
  struct Cluster {
    std::uint32_t level = 0, own_group = kNoId;
    std::vector<Vec3i> points;
    Vec3d middle{0.0};
  };
  struct Group {
    std::uint32_t level = 0;
    std::vector<std::uint32_t> members;
    bool is_terminal = false;
    double error = 0.0;
  };
  std::vector<Cluster> clusters;
  std::vector<Group> groups;
  const auto add_cluster = [&](std::uint32_t level, std::uint32_t own, const Vec3d& middle, double size) {
    Cluster c;
    c.level = level;
    c.own_group = own;
    c.middle = middle;
    const std::uint32_t count = 3 + random.below(6);
    for (std::uint32_t i = 0; i < count; ++i) c.points.push_back(Vec3i(middle + random.in_cube(size)));
    clusters.push_back(c);
    return static_cast<std::uint32_t>(clusters.size() - 1);
  };
  const double span = 400000.0;
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < options.leaf_clusters; ++i) {
    const Vec3d middle = random.in_cube(span);  // drawn before the size: the order of arguments is the compiler's
    open.push_back(add_cluster(0, kNoId, middle, random.log_between(10.0, 20000.0)));
  }
  const double step = std::ldexp(1.0, options.grid_log2);
  while (!open.empty()) {
    std::sort(open.begin(), open.end(), [&](std::uint32_t a, std::uint32_t b) {
      return clusters[a].middle.x != clusters[b].middle.x ? clusters[a].middle.x < clusters[b].middle.x : a < b;
    });
    std::vector<std::uint32_t> later;
    for (std::size_t i = 0; i < open.size();) {
      Group group;
      const std::size_t size = std::min<std::size_t>(open.size() - i, 2 + random.below(5));
      for (std::size_t j = 0; j < size; ++j, ++i) {
        if (open.size() > 12 && random.chance(options.defer_chance)) {
          later.push_back(open[i]);
        } else {
          group.members.push_back(open[i]);
        }
      }
      if (group.members.empty()) continue;
      for (const std::uint32_t m : group.members) group.level = std::max(group.level, clusters[m].level);
      group.is_terminal = open.size() <= 2 || random.chance(options.stuck_chance);
      group.error = group.is_terminal ? HUGE_VAL
                    : random.chance(options.zero_error_chance)
                        ? 0.0
                        : step * random.log_between(0.1, 10.0) * std::ldexp(8.0, 2 * static_cast<int>(group.level));
      const std::uint32_t id = static_cast<std::uint32_t>(groups.size());
      groups.push_back(group);
      if (group.is_terminal) continue;
      for (std::size_t j = 0; j < (group.members.size() + 1) / 2; ++j) {
        const Cluster& from = clusters[group.members[j]];
        later.push_back(add_cluster(group.level + 1, id, from.middle, random.log_between(100.0, 80000.0)));
      }
    }
    open = later;
  }

  // Groups coarse to fine, clusters by group.
  std::vector<std::uint32_t> order(groups.size()), new_id(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) order[g] = static_cast<std::uint32_t>(g);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return groups[a].level > groups[b].level; });
  for (std::size_t g = 0; g < groups.size(); ++g) new_id[order[g]] = static_cast<std::uint32_t>(g);
  RandomDag out;
  out.mesh.grid.log2 = options.grid_log2;
  for (const std::uint32_t g : order) {
    builder::DagGroup group;
    group.level = groups[g].level;
    group.first_cluster = static_cast<std::uint32_t>(out.dag.clusters.size());
    group.cluster_count = static_cast<std::uint32_t>(groups[g].members.size());
    group.is_terminal = groups[g].is_terminal;
    group.error = group.quadric_error = groups[g].error;
    group.deviation = HUGE_VAL;
    for (const std::uint32_t m : groups[g].members) {
      builder::DagCluster c;
      c.level = clusters[m].level;
      if (clusters[m].own_group != kNoId) c.own_group = GroupId(new_id[clusters[m].own_group]);
      c.coarser_group = GroupId(new_id[g]);
      c.first_vertex = static_cast<std::uint32_t>(out.dag.vertex_position.size());
      c.vertex_count = static_cast<std::uint32_t>(clusters[m].points.size());
      c.first_triangle = static_cast<std::uint32_t>(out.dag.triangles.size());
      c.triangle_count = c.vertex_count - 2;
      for (const Vec3i& p : clusters[m].points) out.dag.vertex_position.push_back(p);
      for (std::uint32_t t = 0; t < c.triangle_count; ++t) {
        out.dag.triangles.push_back({0, static_cast<std::uint8_t>(t + 1), static_cast<std::uint8_t>(t + 2)});
        out.dag.triangle_material.push_back(0);
      }
      out.dag.level_count = std::max(out.dag.level_count, c.level + 1);
      out.dag.clusters.push_back(c);
    }
    out.dag.groups.push_back(group);
  }
  return out;
}

/// Largest singular value of the rows of a 3×4 transform, rounded up a little. (Jacobi on AᵀA.)
inline double largest_singular_value(const double* m) {
  long double a[3][3] = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) a[i][j] += static_cast<long double>(m[4 * k + i]) * m[4 * k + j];
    }
  }
  for (int sweep = 0; sweep < 9; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0.0L) continue;
        const long double theta = (a[q][q] - a[p][p]) / (2.0L * a[p][q]);
        const long double t = (theta >= 0.0L ? 1.0L : -1.0L) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0L));
        const long double c = 1.0L / std::sqrt(t * t + 1.0L), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const long double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < 3; ++k) {
          const long double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
        }
      }
    }
  }
  const long double largest = std::max(a[0][0], std::max(a[1][1], a[2][2]));
  return static_cast<double>(std::sqrt(largest)) * (1.0 + 1e-12);
}

enum class TransformKind { kIdentity, kRigid, kMirrored, kNonUniform, kSheared };

inline format::InstanceRecord make_random_instance(RandomSource& random, TransformKind kind, double offset) {
  format::InstanceRecord record{};
  Mat3d m(1.0);
  if (kind != TransformKind::kIdentity) {
    const Vec3d x = random.direction();
    const Vec3d y = glm::normalize(glm::cross(x, random.direction()));
    m = Mat3d(x, y, glm::cross(x, y));
    if (kind == TransformKind::kMirrored) m[0] *= -1.0;
    if (kind == TransformKind::kNonUniform) {
      for (int i = 0; i < 3; ++i) m[i] *= random.log_between(1e-3, 1e3);
    }
    if (kind == TransformKind::kSheared) {
      for (int i = 0; i < 3; ++i) m[i] += random.between(-3.0, 3.0) * m[(i + 1) % 3];
    }
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) record.transform[4 * row + column] = m[column][row];
    record.transform[4 * row + 3] = random.between(-offset, offset);
  }
  if (glm::determinant(m) < 0.0) record.flags |= format::kInstanceMirrored;
  record.scale = largest_singular_value(record.transform);
  return record;
}

/// Owns what SelectTables views.
struct TestTables {
  std::vector<format::MeshRecord> meshes;
  std::vector<format::InstanceRecord> instances;
  std::vector<format::GroupRecord> groups;
  std::vector<format::ClusterRecord> clusters;
  std::vector<format::NodeRecord> nodes;
  [[nodiscard]] run::SelectTables view() const { return {meshes, instances, groups, clusters, nodes}; }

  void add_mesh(const builder::LodDag& dag, const builder::Hierarchy& hierarchy, const Vec3d& origin) {
    format::MeshRecord mesh{};
    for (int i = 0; i < 3; ++i) mesh.origin[i] = origin[i];
    mesh.first_group = static_cast<std::uint32_t>(groups.size());
    mesh.group_count = static_cast<std::uint32_t>(dag.groups.size());
    mesh.first_cluster = static_cast<std::uint32_t>(clusters.size());
    mesh.cluster_count = static_cast<std::uint32_t>(dag.clusters.size());
    mesh.first_node = static_cast<std::uint32_t>(nodes.size());
    mesh.node_count = static_cast<std::uint32_t>(hierarchy.nodes.size());
    mesh.level_count = dag.level_count;
    for (std::size_t g = 0; g < dag.groups.size(); ++g) {
      format::GroupRecord r{};
      const builder::Hierarchy::Sphere& s = hierarchy.group_spheres[g];
      std::copy(s.center, s.center + 3, r.center);
      r.radius = s.radius;
      r.error = hierarchy.group_errors[g];
      r.quadric_error = r.error >= format::kInfiniteError ? r.error : 0.5F * r.error;
      r.first_cluster = mesh.first_cluster + dag.groups[g].first_cluster;
      r.cluster_count = static_cast<std::uint16_t>(dag.groups[g].cluster_count);
      r.mesh = static_cast<std::uint32_t>(meshes.size());
      r.level = static_cast<std::uint16_t>(dag.groups[g].level);
      r.normal_deviation = r.uv_deviation = format::kInfiniteError;
      r.flags = dag.groups[g].is_terminal ? format::kGroupTerminal : std::uint16_t{0};
      groups.push_back(r);
    }
    mesh.sphere_log2 = hierarchy.sphere_log2;
    for (std::size_t i = 0; i < dag.clusters.size(); ++i) {
      const builder::DagCluster& c = dag.clusters[i];
      const builder::Hierarchy::Sphere& sphere = hierarchy.cluster_spheres[i];
      format::ClusterRecord r{};
      for (int axis = 0; axis < 3; ++axis) {
        r.center[axis] = static_cast<std::int16_t>(std::ldexp(sphere.center[axis], -mesh.sphere_log2));
      }
      r.radius = static_cast<std::uint16_t>(std::ldexp(sphere.radius, -mesh.sphere_log2));
      r.own_group = c.own_group.is_valid() ? mesh.first_group + c.own_group.value : format::kNone;
      r.coarser_group = mesh.first_group + c.coarser_group.value;
      r.level = static_cast<std::uint16_t>(c.level);
      clusters.push_back(r);
    }
    for (format::NodeRecord n : hierarchy.nodes) {
      n.first += n.child_count == 0 ? mesh.first_group : mesh.first_node;
      nodes.push_back(n);
    }
    meshes.push_back(mesh);
  }
};

/// A camera somewhere telling: inside, beside, far from, or just at the border of a stored sphere of the instance.
inline run::Camera make_random_camera(RandomSource& random, const run::SelectTables& tables,
                                      const format::InstanceRecord& instance) {
  const format::MeshRecord& mesh = tables.meshes[instance.mesh];
  const format::GroupRecord& g = tables.groups[mesh.first_group + random.below(mesh.group_count)];
  const auto to_world = [&](const Vec3d& p) {
    const double* m = instance.transform;
    Vec3d w;
    for (int i = 0; i < 3; ++i) w[i] = m[4 * i] * p.x + m[4 * i + 1] * p.y + m[4 * i + 2] * p.z + m[4 * i + 3];
    return w;
  };
  const Vec3d center =
      to_world(Vec3d(g.center[0], g.center[1], g.center[2]) + Vec3d(mesh.origin[0], mesh.origin[1], mesh.origin[2]));
  const double radius = g.radius * instance.scale;
  const double reach = run::mesh_reach(tables, mesh) * instance.scale;
  run::Camera camera;
  camera.near_distance = reach * random.log_between(1e-9, 1e-1);
  double distance = 0.0;
  switch (random.below(6)) {
    case 0: distance = radius * random.unit(); break;
    case 1: distance = radius; break;
    case 2: distance = radius + camera.near_distance; break;
    case 3: distance = reach * random.log_between(1e-3, 10.0); break;
    case 4: distance = reach * random.log_between(10.0, 1e6); break;
    default: distance = radius * random.log_between(1.0, 100.0); break;
  }
  camera.eye = center + random.direction() * distance;
  camera.target = center;
  camera.fovy = random.chance(0.2) ? random.log_between(1e-7, 1e-2) : random.between(0.1, 2.5);
  camera.is_orthographic = random.chance(0.2);
  camera.ortho_height = reach * random.log_between(1e-4, 1e4);
  camera.height = 1 + random.below(4000);
  return camera;
}

}  // namespace meshlode::test
