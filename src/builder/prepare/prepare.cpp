// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/prepare/prepare.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <meshlode/format.h>

#include "base/box.h"
#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/try.h"
#include "base/unset_vector.h"
#include "builder/gap_label.h"
#include "builder/prepare/corners.h"
#include "builder/prepare/median_edge.h"
#include "builder/prepare/open_border.h"
#include "builder/prepare/separate_needles.h"
#include "builder/prepare/weld.h"
#include "builder/prepare/zero_area.h"

namespace meshlode::builder {

namespace {

void count_source(const scene::SourceMesh& source, PreparedMesh& mesh) {
  mesh.dropped_repaired = source.drops.repaired;
  mesh.source_triangles = source.drops.repaired;
  for (const scene::Primitive& primitive : source.primitives) {
    mesh.source_triangles += primitive.indices.size() / 3;
    mesh.source_vertices += primitive.positions.size();
  }
}

/// Calls visit(i) for each of `count`, by chunks; an accumulator of its own for each chunk, in their order.
template <class Sum, class Visit>
std::vector<Sum> sums_of_chunks(std::size_t count, const Sum& first, const Visit& visit) {
  constexpr std::size_t kLength = 4 * kLoopGrain;
  std::vector<Sum> sums(chunk_count(count, kLength), first);
  parallel_for_each_chunk(count, kLength, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    Sum sum = first;
    for (std::size_t i = begin; i < end; ++i) visit(i, sum);
    sums[chunk] = sum;
  });
  return sums;
}

bool are_finite(const Corners& corners) {
  const std::vector<std::uint32_t> wrong =
      sums_of_chunks(corners.triangles.size(), std::uint32_t{0}, [&](std::size_t i, std::uint32_t& sum) {
        const Vec3d& p = corners.positions[corners.triangles[i]];
        sum += std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) ? 0U : 1U;
      });
  return std::all_of(wrong.begin(), wrong.end(), [](std::uint32_t count) { return count == 0; });
}

/// Takes the triangles away that are no part of the source; returns how many.
std::uint64_t drop_undrawn(Corners& corners) {
  const std::vector<std::uint8_t> is_undrawn = find_undrawn(corners.positions, corners.triangles);
  if (std::find(is_undrawn.begin(), is_undrawn.end(), 1) == is_undrawn.end()) return 0;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < is_undrawn.size(); ++t) {
    if (is_undrawn[t] != 0) continue;
    for (std::size_t k = 0; k < 3; ++k) corners.triangles[3 * kept + k] = corners.triangles[3 * t + k];
    corners.materials[kept++] = corners.materials[t];
  }
  corners.triangles.resize(3 * kept);
  corners.materials.resize(kept);
  return is_undrawn.size() - kept;
}

constexpr double kSmallestDiagonal = 0x1p-500;  ///< its square keeps all bits of a double, with room to spare

/// Culling spheres have 16 bits a coordinate, and the largest unit that is; one unit is left for rounding.
constexpr double kLargestHalf = 32766.0 * 0x1p104;
static_assert(format::kMaxSphereLog2 == 104);

/// Of the vertices that triangles use: stray points do not coarsen the grid.
Box3d box_of_corners(const Corners& corners) {
  Box3d all;
  for (const Box3d& box : sums_of_chunks(corners.triangles.size(), Box3d{}, [&](std::size_t i, Box3d&sum) {
         sum.add(corners.positions[corners.triangles[i]]);
       })) {
    all.add(box);
  }
  return all;
}

Status take_frame(const Box3d& box, const GridFrame& frame, PreparedMesh& mesh) {
  mesh.origin = frame.origin;
  mesh.grid = frame.grid;
  const double reach = frame.grid.step() * format::kMaxGridCoordinate;
  for (int k = 0; k < 3; ++k) {
    if (box.low[k] - frame.origin[k] >= -reach && box.high[k] - frame.origin[k] <= reach) continue;
    return Error{ErrorCode::kCheckFailed, {}, "it reaches beyond the grid"};
  }
  return Ok{};
}

/// Grid and origin from the bounds of the source.
Status choose_frame(const Corners& corners, const PrepareOptions& options, PreparedMesh& mesh) {
  const Box3d all = box_of_corners(corners);
  const auto& [low, high] = all;
  const Vec3d half = (high - low) * 0.5;
  mesh.diagonal = 2.0 * std::sqrt(glm::dot(half, half));
  if (!std::isfinite(mesh.diagonal)) {
    return Error{ErrorCode::kUnsupported, {}, "its extent overflows a double when squared"};
  }
  const double largest_half = std::max({half.x, half.y, half.z});
  // Squares of the smallest sizes vanish, and a mesh must not become a point by that.
  if (largest_half > 0.0 && mesh.diagonal < kSmallestDiagonal) {
    return Error{ErrorCode::kUnsupported, {}, "its extent vanishes from a double when squared"};
  }
  if (options.frame) return take_frame(all, *options.frame, mesh);
  TRY_LET(grid, choose_grid(largest_half, mesh.diagonal, median_edge_length(corners), options));
  mesh.grid = *grid;
  // What the format cannot hold is refused here, where it is known, and not when all is built.
  if (grid->log2 < kMinGridLog2 || grid->log2 > kMaxGridLog2) {
    return Error{ErrorCode::kUnsupported, {}, "the grid's step leaves the range of floats"};
  }
  if (largest_half > kLargestHalf) {
    return Error{ErrorCode::kUnsupported, {}, "its extent leaves the range of culling spheres: more than 1.3e36"};
  }
  // The origin lies on the grid through zero, so that meshes built with the same step abut.
  const double step = mesh.grid.step();
  for (int k = 0; k < 3; ++k) mesh.origin[k] = std::floor((low[k] + half[k]) / step + 0.5) * step;
  return Ok{};
}

/// The grid point of each vertex that is used, and level 0's own deviation.
UnsetVector<Vec3i> place_on_grid(const Corners& corners, const std::vector<std::uint8_t>& is_used,
                                 const PrepareOptions& options, PreparedMesh& mesh) {
  UnsetVector<Vec3i> points(corners.positions.size());
  UnsetVector<Vec3d> relative(corners.positions.size());
  parallel_for_each_index(points.size(), kLoopGrain, [&](std::size_t v) {
    relative[v] = is_used[v] != 0 ? corners.positions[v] - mesh.origin : Vec3d(0.0);
    points[v] = is_used[v] != 0 ? mesh.grid.quantize(relative[v]) : Vec3i(0);
  });
  // Meshes that must abut share nothing but the grid: there each vertex goes to its own point and nowhere else.
  if (options.separates_needles && !(options.grid_step > 0.0))
    separate_needles(relative, corners.triangles, mesh.grid, points);
  const std::vector<double> deviations2 = sums_of_chunks(points.size(), 0.0, [&](std::size_t v, double& most) {
    if (is_used[v] == 0) return;
    const Vec3d moved = mesh.grid.decode(points[v]) - relative[v];
    most = std::max(most, glm::dot(moved, moved));
  });
  mesh.level0_deviation = std::sqrt(*std::max_element(deviations2.begin(), deviations2.end()));
  return points;
}

std::uint64_t count_pieces(const PreparedMesh& mesh) {
  DisjointSets pieces(mesh.positions.size());
  std::vector<std::uint8_t> is_used(mesh.positions.size(), 0);
  std::uint64_t count = 0;
  const auto use = [&](std::uint32_t position) {
    count += is_used[position] == 0 ? 1 : 0;
    is_used[position] = 1;
  };
  for (const WedgeTriangle& triangle : mesh.triangles) {
    const std::uint32_t first = mesh.wedge_position[triangle[0]];
    use(first);
    for (const std::uint32_t wedge : {triangle[1], triangle[2]}) {
      use(mesh.wedge_position[wedge]);
      count -= pieces.join(first, mesh.wedge_position[wedge]) ? 1 : 0;
    }
  }
  return count;
}

/// Triangles that no ray started from take the narrowest gap of those around them.
void spread_gaps(PreparedMesh& mesh) {
  std::vector<std::uint8_t> at_position(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t wedge : mesh.triangles[t]) {
      std::uint8_t& at = at_position[mesh.wedge_position[wedge]];
      GapPair narrowest = GapPair::of_byte(at);
      narrowest.narrow(gap_pair_of(mesh.triangle_material[t]));
      at = narrowest.byte();
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::uint32_t& label = mesh.triangle_material[t];
    if (gap_pair_of(label).byte() != 0) continue;
    GapPair narrowest;
    for (const std::uint32_t wedge : mesh.triangles[t]) {
      narrowest.narrow(GapPair::of_byte(at_position[mesh.wedge_position[wedge]]));
    }
    label = with_gaps(label, narrowest);
  }
}

}  // namespace

Result<GridPlan> plan_grid(const scene::SourceMesh& source, const PrepareOptions& options) {
  const std::string where = "mesh '" + source.name + "'";
  Corners corners = gather_corners(source, {});
  if (!are_finite(corners)) return Error{ErrorCode::kInvalid, where, "a position is not finite"};
  drop_undrawn(corners);
  if (corners.triangles.empty()) return GridPlan{};
  PreparedMesh mesh;
  if (const Status frame = choose_frame(corners, options, mesh); !frame) {
    return Error{frame.error().code, where, frame.error().detail};
  }
  const Vec3d sides = box_of_corners(corners).size();
  return GridPlan{mesh.grid, std::max({sides.x, sides.y, sides.z}), median_edge_length(corners)};
}

Result<PreparedMesh> prepare_mesh(const scene::SourceMesh& source, const AttributeLayout& layout,
                                  const PrepareOptions& options) {
  const std::string where = "mesh '" + source.name + "'";
  PreparedMesh mesh;
  mesh.name = source.name;
  mesh.layout = layout;
  mesh.gap_reach = options.gaps.empty() ? 0.0 : options.gap_reach;
  count_source(source, mesh);

  Corners corners = gather_corners(source, layout);
  for (std::size_t t = 0; t < options.gaps.size(); ++t) {
    corners.materials[t] = with_gaps(corners.materials[t], GapPair::of_byte(options.gaps[t]));
  }
  if (!are_finite(corners)) return Error{ErrorCode::kInvalid, where, "a position is not finite"};
  mesh.dropped_degenerate = drop_undrawn(corners);
  if (corners.triangles.empty()) return mesh;

  if (const Status frame = choose_frame(corners, options, mesh); !frame) {
    return Error{frame.error().code, where, frame.error().detail};
  }
  std::vector<std::uint8_t> is_used(corners.positions.size(), 0);
  for (const std::uint32_t vertex : corners.triangles) is_used[vertex] = 1;
  const UnsetVector<Vec3i> points = place_on_grid(corners, is_used, options, mesh);
  weld(corners, points, is_used, options.keeps_flat_normals && layout.flat_normal, mesh);
  if (options.locks_borders) mesh.is_border_locked = find_open_border(corners, is_used, points, mesh.positions);
  mesh.piece_count = count_pieces(mesh);
  if (!options.gaps.empty()) spread_gaps(mesh);
  return mesh;
}

}  // namespace meshlode::builder
