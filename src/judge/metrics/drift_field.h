// SPDX-License-Identifier: GPL-3.0-or-later
// An attribute over a surface: its values, how fast they change, where they jump. Internal to the room.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "judge/metrics/shaded_surface.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::judge {

/// One attribute of a surface; UVs have z = 0.
struct Field {
  const Surface* surface = nullptr;
  std::vector<Vec3f> values;
  bool is_normal = false;
  std::vector<float> slopes;  ///< of each vertex the steepest of its triangles (slope_of)
  double range = 1.0;         ///< the most that two values can differ
  std::vector<std::uint8_t> seams;
  Surface seam_surface;                      ///< the triangles with a seam
  std::vector<std::uint32_t> seam_triangle;  ///< of seam_surface -> of surface
  std::optional<TriangleTree> seam_tree;
};

constexpr std::size_t kFields = 1 + scene::kMaxUvSets;  ///< normals, then UV sets
using Fields = std::array<std::optional<Field>, kFields>;

/// Those that the surface has. \pre `s` outlives them
[[nodiscard]] Fields make_fields(const ShadedSurface& s);

[[nodiscard]] bool is_known(const Vec3d& value);
/// The value at a point of a triangle; not finite where unknown.
[[nodiscard]] Vec3d value_at(const Field& field, std::uint32_t triangle, double u, double v);
/// Degrees, or UV units.
[[nodiscard]] double difference(const Field& field, const Vec3d& a, const Vec3d& b);
/// How much the value changes at most per unit of length inside a triangle (Frobenius norm of its gradient).
[[nodiscard]] double slope_of(const Field& field, std::uint32_t triangle);

struct ClosestPoint {
  Vec3d point{0.0};
  double u = 0.0, v = 0.0;
  std::uint8_t edges = 0;  ///< bit k: the point lies on the edge from corner k to k + 1
};

/// The closest point of a triangle, with its weights and the edges it lies on.
[[nodiscard]] ClosestPoint closest_on_triangle(const Vec3d& p, const Surface& s, std::uint32_t triangle);

}  // namespace meshlode::judge
