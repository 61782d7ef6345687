// SPDX-License-Identifier: GPL-3.0-or-later
#include "laws/same_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "run/decode/decode.h"

namespace meshlode::test::hard {

namespace {

class Comparer {
 public:
  Comparer(const run::Asset& a, MeshId mesh_a, const run::Asset& b, MeshId mesh_b, const Change& change)
      : a_(a), b_(b), mesh_a_(a.meshes()[mesh_a.value]), mesh_b_(b.meshes()[mesh_b.value]), change_(change) {}

  Comparison run() {
    compare_records();
    if (out_.difference.empty()) compare_groups();
    if (out_.difference.empty()) compare_clusters();
    if (out_.difference.empty()) compare_nodes();
    if (out_.difference.empty()) compare_contents();
    return out_;
  }

 private:
  template <class T>
  void same(const char* what, std::size_t index, const T& x, const T& y) {
    if (x == y || !out_.difference.empty()) return;
    char text[160];
    std::snprintf(text, sizeof text, "%s %zu: %.9g and %.9g", what, index, static_cast<double>(x),
                  static_cast<double>(y));
    out_.difference = text;
  }

  /// A length in object units. What is stored as "infinite" stays it.
  void length(const char* what, std::size_t index, double x, double y) {
    if (x >= double{format::kInfiniteError} || y >= double{format::kInfiniteError}) return same(what, index, x, y);
    const double expected = std::ldexp(change_.factor > 0.0 ? x * change_.factor : x, change_.log2);
    if (!(change_.factor > 0.0)) return same(what, index, expected, y);
    const double allowed = change_.tolerance * std::abs(expected) + change_.absolute;
    const double off = std::abs(y - expected);
    if (off > 0.0) out_.share = std::max(out_.share, allowed > 0.0 ? off / allowed : HUGE_VAL);
    if (off > allowed) same(what, index, expected, y);
  }

  void compare_records() {
    const format::MeshRecord &x = mesh_a_, &y = mesh_b_;
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      const double origin =
          std::ldexp(change_.factor > 0.0 ? x.origin[axis] * change_.factor : x.origin[axis], change_.log2);
      same("origin", i, origin + change_.shift[axis], y.origin[axis]);
      same("bounds_min", i, x.bounds_min[axis], y.bounds_min[axis]);
      same("bounds_max", i, x.bounds_max[axis], y.bounds_max[axis]);
    }
    length("grid step", 0, std::ldexp(x.grid.mantissa, x.grid.log2), std::ldexp(y.grid.mantissa, y.grid.log2));
    length("diagonal", 0, x.diagonal, y.diagonal);
    length("level0_deviation", 0, double{x.level0_deviation}, double{y.level0_deviation});
    if (!(change_.factor > 0.0)) same("sphere_log2", 0, x.sphere_log2 + change_.log2, y.sphere_log2);
    same("normal_scale", 0, x.normal_scale, y.normal_scale);
    same("uv_set_count", 0, x.uv_set_count, y.uv_set_count);
    for (std::size_t set = 0; set < format::kMaxUvSets; ++set) same("uv_log2", set, x.uv_log2[set], y.uv_log2[set]);
    same("has_color", 0, x.has_color, y.has_color);
    same("level_count", 0, x.level_count, y.level_count);
    same("source_triangles", 0, x.source_triangles, y.source_triangles);
    same("source_vertices", 0, x.source_vertices + change_.unused_vertices, y.source_vertices);
    same("dropped_degenerate", 0, x.dropped_degenerate, y.dropped_degenerate);
    same("dropped_duplicate", 0, x.dropped_duplicate, y.dropped_duplicate);
    same("grid_collapsed", 0, x.grid_collapsed, y.grid_collapsed);
    same("group_count", 0, x.group_count, y.group_count);
    same("cluster_count", 0, x.cluster_count, y.cluster_count);
    same("node_count", 0, x.node_count, y.node_count);
  }

  void compare_groups() {
    for (std::uint32_t g = 0; g < mesh_a_.group_count; ++g) {
      const format::GroupRecord& x = a_.groups()[mesh_a_.first_group + g];
      const format::GroupRecord& y = b_.groups()[mesh_b_.first_group + g];
      if (!(change_.factor > 0.0)) {
        for (int axis = 0; axis < 3; ++axis) length("group center", g, double{x.center[axis]}, double{y.center[axis]});
        length("group radius", g, double{x.radius}, double{y.radius});
      }
      length("group error", g, double{x.error}, double{y.error});
      length("group quadric_error", g, double{x.quadric_error}, double{y.quadric_error});
      length("group deviation", g, double{x.deviation}, double{y.deviation});
      if (!(change_.factor > 0.0)) {
        same("group normal_deviation", g, x.normal_deviation, y.normal_deviation);
        same("group uv_deviation", g, x.uv_deviation, y.uv_deviation);
      }
      same("group first_cluster", g, x.first_cluster - mesh_a_.first_cluster, y.first_cluster - mesh_b_.first_cluster);
      same("group cluster_count", g, x.cluster_count, y.cluster_count);
      same("group level", g, x.level, y.level);
      same("group flags", g, x.flags, y.flags);
      same("group stuck_reason", g, static_cast<int>(x.stuck_reason), static_cast<int>(y.stuck_reason));
    }
  }

  static std::uint32_t within(std::uint32_t id, std::uint32_t first) { return id == format::kNone ? id : id - first; }

  void compare_clusters() {
    for (std::uint32_t c = 0; c < mesh_a_.cluster_count; ++c) {
      const format::ClusterRecord& x = a_.clusters()[mesh_a_.first_cluster + c];
      const format::ClusterRecord& y = b_.clusters()[mesh_b_.first_cluster + c];
      if (!(change_.factor > 0.0)) {
        for (int axis = 0; axis < 3; ++axis) same("cluster center", c, x.center[axis], y.center[axis]);
        same("cluster radius", c, x.radius, y.radius);
      }
      for (int axis = 0; axis < 3; ++axis) same("cluster cone_axis", c, x.cone_axis[axis], y.cone_axis[axis]);
      same("cluster cone_cutoff", c, x.cone_cutoff, y.cone_cutoff);
      same("cluster own_group", c, within(x.own_group, mesh_a_.first_group), within(y.own_group, mesh_b_.first_group));
      same("cluster coarser_group", c, x.coarser_group - mesh_a_.first_group, y.coarser_group - mesh_b_.first_group);
      same("cluster vertices", c, x.vertex_count(), y.vertex_count());
      same("cluster triangles", c, x.triangle_count(), y.triangle_count());
      same("cluster level", c, x.level, y.level);
    }
  }

  void compare_nodes() {
    if (change_.factor > 0.0) return;  // made from spheres whose last bits differ
    for (std::uint32_t n = 0; n < mesh_a_.node_count; ++n) {
      const format::NodeRecord& x = a_.nodes()[mesh_a_.first_node + n];
      const format::NodeRecord& y = b_.nodes()[mesh_b_.first_node + n];
      for (int axis = 0; axis < 3; ++axis) length("node center", n, double{x.center[axis]}, double{y.center[axis]});
      length("node radius", n, double{x.radius}, double{y.radius});
      length("node error", n, double{x.error}, double{y.error});
      same("node child_count", n, x.child_count, y.child_count);
      const bool is_leaf = x.child_count == 0;
      same("node first", n, x.first - (is_leaf ? mesh_a_.first_group : mesh_a_.first_node),
           y.first - (is_leaf ? mesh_b_.first_group : mesh_b_.first_node));
    }
  }

  void compare_contents() {
    const auto x = run::decode_all(a_), y = run::decode_all(b_);
    if (!x || !y) {
      out_.difference = (x ? y : x).error().message();
      return;
    }
    for (std::uint32_t c = 0; c < mesh_a_.cluster_count && out_.difference.empty(); ++c) {
      const run::DecodedCluster& p = (*x)[mesh_a_.first_cluster + c];
      const run::DecodedCluster& q = (*y)[mesh_b_.first_cluster + c];
      if (p.channels != q.channels) out_.difference = "cluster " + std::to_string(c) + ": other vertices";
      if (p.triangles != q.triangles) out_.difference = "cluster " + std::to_string(c) + ": other triangles";
    }
  }

  const run::Asset &a_, &b_;
  const format::MeshRecord &mesh_a_, &mesh_b_;
  const Change& change_;
  Comparison out_;
};

}  // namespace

Comparison compare_meshes(const run::Asset& a, MeshId mesh_a, const run::Asset& b, MeshId mesh_b,
                          const Change& change) {
  return Comparer(a, mesh_a, b, mesh_b, change).run();
}

}  // namespace meshlode::test::hard
