// SPDX-License-Identifier: GPL-3.0-or-later
// Which points of the source whole cuts are held against: corners, points of edges and points inside, more of them
// where triangles are long or large.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/random.h"
#include "base/vec.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// A point of a triangle of PreparedMesh::exact_triangles.
struct SourcePoint {
  Vec3d at;
  std::uint32_t triangle = 0;
};

/// Points of one source triangle, one after another: [first, first + count).
struct PointRun {
  std::uint32_t triangle = 0, first = 0, count = 0;
};

[[nodiscard]] std::array<Vec3d, 3> source_corners(const PreparedMesh& mesh, std::uint32_t triangle);

/// A random point: of the triangle where `inside`, else of an edge. A needle is nothing but edges.
[[nodiscard]] Vec3d random_point(const std::array<Vec3d, 3>& corners, bool inside, SplitMix64& random);

/// Of triangles spread over the whole source, a few hundred thousand points at most. Those of one triangle may lie in
/// several runs. The same for the same mesh.
[[nodiscard]] std::vector<SourcePoint> choose_source_points(const PreparedMesh& mesh);

[[nodiscard]] std::vector<PointRun> runs_of(std::span<const SourcePoint> points);

}  // namespace meshlode::builder
