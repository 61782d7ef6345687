// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/try.h"
#include "format/grid.h"
#include "judge/validate/borders.h"
#include "judge/validate/exact.h"
#include "judge/validate/surface.h"
#include "run/decode/decode.h"

namespace meshlode::judge {

namespace {

__extension__ using Int128 = __int128;

struct Int64Vec3 {
  std::int64_t x, y, z;
};

/// Cross product of two edges, exact: coordinates below 2^24 give components below 2^51.
Int64Vec3 area_vector(const Vec3i& a, const Vec3i& b, const Vec3i& c) {
  const Int64Vec3 u{std::int64_t{b.x} - a.x, std::int64_t{b.y} - a.y, std::int64_t{b.z} - a.z};
  const Int64Vec3 v{std::int64_t{c.x} - a.x, std::int64_t{c.y} - a.y, std::int64_t{c.z} - a.z};
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

bool is_zero(const Int64Vec3& v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

/// Whether a cone holds a normal: every unit view direction v with v·axis >= cutoff has v·n >= 0. With axis A and
/// cutoff C in 1/127 that is, for C < 127 and |A| >= C: A·n > 0 and (A·n)² >= (|A|² - C²)·|n|². Integers below 2^127.
bool cone_holds(const format::ClusterRecord& cluster, const Int64Vec3& n) {
  const std::int64_t cutoff = cluster.cone_cutoff;  // NOLINT(bugprone-signed-char-misuse): a number, no character
  if (cutoff == 127) return true;
  const std::int64_t a[3] = {cluster.cone_axis[0], cluster.cone_axis[1], cluster.cone_axis[2]};
  const std::int64_t axis2 = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
  if (cutoff > 0 && axis2 < cutoff * cutoff) return true;  // no unit vector reaches the cutoff: never culled
  if (cutoff < 0) return false;
  const Int128 dot =
      static_cast<Int128>(a[0]) * n.x + static_cast<Int128>(a[1]) * n.y + static_cast<Int128>(a[2]) * n.z;
  const Int128 n2 = static_cast<Int128>(n.x) * n.x + static_cast<Int128>(n.y) * n.y + static_cast<Int128>(n.z) * n.z;
  return dot > 0 && dot * dot >= static_cast<Int128>(axis2 - cutoff * cutoff) * n2;
}

class MeshGeometry {
 public:
  MeshGeometry(const run::Asset& asset, std::size_t mesh, RuleLog& log)
      : asset_(asset),
        m_(mesh),
        mesh_(asset.meshes()[mesh]),
        log_(log),
        step_(format::exp2_exact(mesh_.grid.log2) * mesh_.grid.mantissa) {}

  [[nodiscard]] Status run() {
    SurfaceBuilder builder(asset_, MeshId(static_cast<std::uint32_t>(m_)));
    run::DecodedCluster decoded;
    std::optional<run::PageBytes> page;
    std::uint32_t page_id = format::kNone;
    first_material_.assign(1, 0);
    for (std::uint32_t c = mesh_.first_cluster; c < mesh_.first_cluster + mesh_.cluster_count; ++c) {
      const std::uint32_t id = asset_.groups()[asset_.clusters()[c].coarser_group].page;
      if (id != page_id) {
        TRY_LET(loaded, run::load_page(asset_, PageId(id)));
        page = std::move(*loaded);
        page_id = id;
      }
      run::decode_cluster(asset_, *page, ClusterId(c), decoded);
      check_cluster(c, decoded);
      add_materials(decoded);
      builder.add(decoded);
    }
    check_mesh_counts();
    const MeshSurface surface = builder.finish();
    const BorderProof proof = prove_borders(asset_, surface);
    report(Rule::kL507, proof.violations);
    check_materials(surface);
    report(Rule::kL506, check_shared_attributes(asset_, surface, proof.border));
    return Ok{};
  }

 private:
  void report(Rule rule, const std::vector<BorderViolation>& violations) {
    for (const BorderViolation& v : violations) log_.add(rule, place("mesh", m_, "group", v.group), v.detail);
  }

  void add_materials(const run::DecodedCluster& cluster) {
    const std::set<std::uint32_t> distinct(cluster.triangle_material.begin(), cluster.triangle_material.end());
    materials_.insert(materials_.end(), distinct.begin(), distinct.end());
    first_material_.push_back(static_cast<std::uint32_t>(materials_.size()));
  }

  /// Of a cluster of the mesh.
  [[nodiscard]] std::set<std::uint32_t> materials_of(std::uint32_t cluster) const {
    return {materials_.begin() + first_material_[cluster], materials_.begin() + first_material_[cluster + 1]};
  }

  void check_materials(const MeshSurface& surface) {
    for (std::uint32_t k = 0; k < surface.group_count; ++k) {
      const format::GroupRecord& group = asset_.groups()[surface.first_group + k];
      if (surface.made[k].empty()) continue;
      std::set<std::uint32_t> finer;
      for (std::uint32_t i = 0; i < group.cluster_count; ++i)
        finer.merge(materials_of(group.first_cluster - surface.first_cluster + i));
      for (const std::uint32_t c : surface.made[k]) {
        const std::set<std::uint32_t> coarser = materials_of(c);
        const bool is_aggregate = (group.flags & format::kGroupAggregate) != 0;
        const auto is_known = [&](std::uint32_t material) { return finer.contains(material); };
        // What stands for pieces is in a colour of its own, whole, and seen from both sides.
        const auto may_stand = [&](std::uint32_t id) {
          const format::MaterialRecord& material = asset_.materials()[id];
          return material.alpha_mode == format::AlphaMode::kOpaque && material.double_sided != 0 &&
                 material.base_color_texture == format::kNone;
        };
        log_.expect(
            is_aggregate ? std::all_of(coarser.begin(), coarser.end(), may_stand)
                         : std::all_of(coarser.begin(), coarser.end(), is_known),
            Rule::kL509, [&] { return place("mesh", m_, "cluster", surface.first_cluster + c); },
            [&] {
              return std::string(is_aggregate ? "stands for an aggregate and has a material that is not whole"
                                              : "has a material that its finer set has not");
            });
      }
    }
  }

  void check_cluster(std::uint32_t c, const run::DecodedCluster& cluster) {
    const format::ClusterRecord& record = asset_.clusters()[c];
    const auto at = [&] { return place("mesh", m_, "cluster", c); };
    const format::CullSphere sphere = format::cull_sphere(mesh_, record);
    const ExactBall ball{{sphere.center[0], sphere.center[1], sphere.center[2]}, sphere.radius};
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      const Vec3d p = Vec3d(cluster.position(v)) * step_;  // exact: below 2^47 times a power of two
      if (!log_.expect(contains_point(ball, p), Rule::kL502, at,
                       [&] { return "vertex " + std::to_string(v) + " is outside"; }))
        break;
    }
    bool cone_broken = false;
    for (std::size_t t = 0; t < cluster.triangles.size(); ++t) {
      const auto& triangle = cluster.triangles[t];
      const Vec3i a = cluster.position(triangle[0]);
      const Vec3i b = cluster.position(triangle[1]);
      const Vec3i d = cluster.position(triangle[2]);
      const Int64Vec3 n = area_vector(a, b, d);
      if (record.own_group == format::kNone) {
        collapsed_ += is_zero(n) ? 1 : 0;
      } else {
        log_.expect(a != b && b != d && d != a, Rule::kL508, at,
                    [&] { return "triangle " + std::to_string(t) + " has two corners in one place"; });
      }
      if (!is_zero(n) && !cone_broken) {
        cone_broken = !log_.expect(cone_holds(record, n), Rule::kL503, at,
                                   [&] { return "triangle " + std::to_string(t) + " is outside the cone"; });
      }
    }
    if (record.own_group != format::kNone) return;
    level0_triangles_ += cluster.triangle_count;
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      const Vec3i p = cluster.position(v);
      lowest_ = has_vertex_ ? glm::min(lowest_, p) : p;
      highest_ = has_vertex_ ? glm::max(highest_, p) : p;
      has_vertex_ = true;
    }
  }

  void check_mesh_counts() {
    const auto at = [&] { return place("mesh", m_); };
    if (has_vertex_) {
      bool same = true;
      for (int axis = 0; axis < 3; ++axis) {
        same &= mesh_.bounds_min[axis] == lowest_[axis] && mesh_.bounds_max[axis] == highest_[axis];
      }
      log_.expect(same, Rule::kL504, at, [] { return std::string("bounds are not those of level 0's vertices"); });
    }
    log_.expect(mesh_.grid_collapsed == collapsed_, Rule::kL505, at, [&] {
      return differs("grid_collapsed", mesh_.grid_collapsed, "triangles of level 0 without area", collapsed_);
    });
    const std::uint64_t dropped = mesh_.dropped_degenerate + mesh_.dropped_duplicate + mesh_.dropped_repaired;
    log_.expect(mesh_.source_triangles == level0_triangles_ + dropped, Rule::kL116, at, [&] {
      return differs("source_triangles", mesh_.source_triangles, "level 0 and dropped", level0_triangles_ + dropped);
    });
  }

  const run::Asset& asset_;
  std::size_t m_;
  const format::MeshRecord& mesh_;
  RuleLog& log_;
  double step_;
  std::vector<std::uint32_t> first_material_;  ///< per cluster of the mesh, one more at the end
  std::vector<std::uint32_t> materials_;       ///< distinct within a cluster, ascending
  std::uint64_t collapsed_ = 0, level0_triangles_ = 0;
  Vec3i lowest_{0}, highest_{0};
  bool has_vertex_ = false;
};

}  // namespace

Status check_geometry(const run::Asset& asset, RuleLog& log) {
  for (const Rule rule : {Rule::kL116, Rule::kL501, Rule::kL502, Rule::kL503, Rule::kL504, Rule::kL505, Rule::kL506,
                          Rule::kL507, Rule::kL508, Rule::kL509})
    log.check(rule);
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    if (Status status = MeshGeometry(asset, m, log).run(); !status) return status;
  }
  return Ok{};
}

}  // namespace meshlode::judge
