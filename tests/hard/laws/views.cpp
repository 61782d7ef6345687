// SPDX-License-Identifier: GPL-3.0-or-later
// Views: the hierarchy selects what the flat rule selects; a group that passes in floats passes in real numbers, within
// the bound that docs/explanation/numerics.md derives from the rounding of rows, translation and sums; and a picture
// comes of it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "draw/raster/raster.h"
#include "laws/outcomes.h"
#include "run/select/select.h"

namespace meshlode::test::hard {

namespace {

using Real = long double;  // 64 bits of mantissa on x86-64: its own rounding is 2^-40 of the bound

/// (E + R - d) over 8u (2 |c| sigma + d) of a group that passed, u = 2^-24; at most 1. 0 where the near distance
/// decides, which the rule takes for at least 2^-69 of all lengths (docs/reference/selection.md).
double overstep(const run::Camera& camera, double pixel_error, const format::InstanceRecord& instance,
                const format::MeshRecord& mesh, const format::GroupRecord& group, double reach) {
  const Real sigma = instance.scale;
  const Real pixels = camera.is_orthographic ? Real(camera.height) / camera.ortho_height
                                             : Real(camera.height) / (2.0L * std::tan(0.5L * Real(camera.fovy)));
  const Real e = Real(group.error) * sigma * pixels / Real(pixel_error);
  if (camera.is_orthographic) return static_cast<double>(e);  // passes below the allowed pixels: at most 1
  const double* m = instance.transform;
  const double eye[3] = {camera.eye.x, camera.eye.y, camera.eye.z};
  Real d2 = 0.0L, c2 = 0.0L, t2 = 0.0L;
  for (int row = 0; row < 3; ++row) {
    Real t = Real(m[4 * row + 3]) - eye[row], x = 0.0L;
    for (int k = 0; k < 3; ++k) {
      t += Real(m[4 * row + k]) * mesh.origin[k];
      x += Real(m[4 * row + k]) * group.center[k];
    }
    t2 += t * t;
    d2 += (t + x) * (t + x);
  }
  const Real least_near = 0x1p-69L * std::max(std::sqrt(t2), sigma * Real(reach));
  if (e <= std::max(Real(camera.near_distance), least_near)) return 0.0;
  for (const float c : group.center) c2 += Real(c) * c;
  const Real d = std::sqrt(d2);
  const Real allowed = 8.0L * 0x1p-24L * (2.0L * std::sqrt(c2) * sigma + d);
  const Real over = e + Real(group.radius) * sigma - d;
  return over > 0.0L ? static_cast<double>(over / allowed) : 0.0;
}

/// The whole world in a mirror, or turned so that x is y and y is -x: signs change, and the two squares of a sum that
/// commutes. Not a bit of a distance may change.
enum class World : std::uint8_t { kMirrored, kTurned };

bool is_drawn_alike(const run::Asset& asset, const HardView& view, World world,
                    const std::vector<run::ClusterInstance>& cut) {
  run::SelectTables tables = run::tables_of(asset);
  std::vector<format::InstanceRecord> instances(tables.instances.begin(), tables.instances.end());
  run::Camera camera = view.camera;
  if (world == World::kMirrored) {
    camera.eye.x = -camera.eye.x;
  } else {
    camera.eye = Vec3d(camera.eye.y, -camera.eye.x, camera.eye.z);
  }
  for (format::InstanceRecord& instance : instances) {
    for (int k = 0; k < 4; ++k) {
      double &x = instance.transform[k], &y = instance.transform[4 + k];
      if (world == World::kMirrored) {
        x = -x;
      } else {
        std::swap(x, y);
        y = -y;
      }
    }
  }
  tables.instances = instances;
  return run::select_flat(tables, camera, view.pixel_error) == cut;
}

std::string draw_twice(const run::Asset& asset, const HardView& view, const std::vector<run::ClusterInstance>& cut) {
  const auto picture = draw::draw_cut(asset, cut, view.camera);
  if (!picture) return picture.error().message();
  if (picture->pixel_count() != std::size_t{view.camera.width} * view.camera.height) return "another size";
  const auto again = draw::draw_cut(asset, cut, view.camera);
  if (!again || !(*again == *picture)) return "another picture the second time";
  return {};
}

}  // namespace

LawResult check_views(const Built& base) {
  if (base.sample.views.empty()) return not_asked("no view");
  const run::Asset& asset = *base.asset;
  LawResult result = kept();
  const run::SelectTables tables = run::tables_of(asset);
  for (std::size_t i = 0; i < base.sample.views.size(); ++i) {
    const HardView& view = base.sample.views[i];
    const std::string name = "view " + std::to_string(i) + ": ";
    const auto flat = run::select_flat(asset, view.camera, view.pixel_error);
    if (run::select_bvh(asset, view.camera, view.pixel_error) != flat) return broken(name + "the hierarchy disagrees");
    if (!is_drawn_alike(asset, view, World::kMirrored, flat))
      return broken(name + "a mirrored world is drawn otherwise");
    if (!is_drawn_alike(asset, view, World::kTurned, flat)) return broken(name + "a turned world is drawn otherwise");
    for (const run::ClusterInstance& drawn : flat) {
      const format::ClusterRecord& cluster = asset.clusters()[drawn.cluster.value];
      if (cluster.own_group == format::kNone) continue;
      const format::InstanceRecord& instance = asset.instances()[drawn.instance.value];
      const format::GroupRecord& group = asset.groups()[cluster.own_group];
      if (!(view.pixel_error > 0.0)) {
        if (group.error > 0.0F) return broken(name + "an error above 0 passes where none may");
        continue;
      }
      const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
      const double share =
          overstep(view.camera, view.pixel_error, instance, mesh, group, run::mesh_reach(tables, mesh));
      if (share > result.share) result.share = share;
      if (share > 1.0) {
        char text[120];
        std::snprintf(text, sizeof text, "group %u passes by %.3g times what rounding allows", cluster.own_group,
                      share);
        return broken(name + text);
      }
    }
    if (!base.sample.draws_pictures) continue;
    if (const std::string wrong = draw_twice(asset, view, flat); !wrong.empty()) return broken(name + wrong);
  }
  return result;
}

}  // namespace meshlode::test::hard
