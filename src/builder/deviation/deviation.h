// SPDX-License-Identifier: GPL-3.0-or-later
// Deviation: how far a simplified group is from the source, both ways. What the `measured` and `certified` tiers store.
//
// measured: points of the source are carried up the DAG with the clusters that stand for them and projected onto each
// simplified group; points of the group's triangles are measured against a tree over the whole source. Both are refined
// where the maximum may lie; nothing is spent where a bound says that it does not.
// certified: what is proven of the triangles of a group is handed on to the triangles that replace them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/unset_vector.h"
#include "base/vec.h"
#include "builder/deviation/tree_slot.h"

namespace meshlode::builder {

/// Of a source of at most so many triangles the tree's leaves are held, 36 bytes a triangle; of a larger one, and where
/// memory is short, they are made whenever they are looked at. The same numbers.
inline constexpr std::size_t kMostHeldTriangles = 1048576;

/// The source's surface before the grid, relative to the mesh's origin, in object units. Built once per mesh; queries
/// are const and may run side by side. Deterministic: same bits for any thread count, compiler and processor (I10).
class SourceTree {
 public:
  /// What the spans show must outlive the tree.
  SourceTree(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles,
             std::size_t most_held = kMostHeldTriangles);
  ~SourceTree();
  SourceTree(SourceTree&&) noexcept;
  SourceTree& operator=(SourceTree&&) noexcept;

  struct Impl;
  [[nodiscard]] const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// A point of the source on its way up the DAG.
struct CarriedSample {
  Vec3d point;                   ///< on the source, relative to the origin, object units
  std::uint32_t triangle = 0;    ///< of the surface that carries it: the one its nearest point lies on
  float distance = 0.0F;         ///< to that surface, for thinning
  TreeSlot place{0U};            ///< of the SourceTree: where a search for the source near this point may begin
  std::uint32_t vertex = kNoId;  ///< of the source's positions, where it is known that the point is one of them
};

/// A simplified group. Triangle ids are indices into `triangles`.
struct GroupSurface {
  std::span<const Vec3d> positions;  ///< relative to the origin, object units (grid point times step)
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

struct DeviationTierOptions {
  /// Object units: the largest error of what the group replaces, the grid's included. The source was within it of
  /// `finer`.
  double floor = 0.0;
  /// Object units: a maximum below this is of no use. What the samples say of it is still told, but no more are taken.
  double least = 0.0;
  double margin = 1.0;  ///< the group's error will be so many times what is found: in between nothing is looked for
  std::uint32_t samples_per_triangle = 2;  ///< carried samples are thinned to so many per triangle, the farthest first
  /// Triangles of the group that may be divided in search of the maximum, on top of a share of all. Groups of large
  /// triangles need many: a narrow peak lies between the points of several that promise more.
  std::uint32_t extra_effort = 0;
  /// What the group replaces: its members' triangles. With `floor`, it says which points of the source the group stands
  /// for: those that were within `floor` of it. Without it only the carried samples are looked at.
  GroupSurface finer;
  /// Per position of `finer`: another group has it too, so it stays where it is. A point whose nearest place is on such
  /// a border is no nearer to this group than to the other, and gets no farther away. Empty: all of the border is taken
  /// so.
  std::span<const std::uint8_t> finer_is_shared;
  bool is_whole = false;  ///< the group is all of its mesh: every point of the source is its own
};

struct GroupDeviation {
  double deviation = 0.0;              ///< object units: the largest distance that was found, of whichever direction
  UnsetVector<CarriedSample> carried;  ///< thinned, triangle = index into the group's triangles
  std::vector<TreeSlot> places;  ///< of the SourceTree, by triangle of the group: near what is nearest to its middle
};

/// Level 0: the samples that each source triangle starts with (its corners and more), carried by itself. `triangle` of
/// a sample is the index of the source triangle.
[[nodiscard]] UnsetVector<CarriedSample> initial_samples(const SourceTree& source);

/// Measures one simplified group. `samples` are those of all its members. Errors cannot happen: degenerate triangles
/// are points or segments. An empty surface with samples has an infinite deviation.
[[nodiscard]] GroupDeviation measure_group(const SourceTree& source, const GroupSurface& group,
                                           std::span<const CarriedSample> samples, const DeviationTierOptions& options);

/// What is proven of one triangle of a level. Object units.
struct TriangleBound {
  double from_source = 0.0;  ///< every source point that was handed to it is so near
  double to_source = 0.0;    ///< every point of it is so near to the source
};

using TriangleCorners3 = std::array<Vec3d, 3>;

/// Level 0: a triangle of the source and what the grid made of it, corner by corner.
[[nodiscard]] TriangleBound initial_bound(const TriangleCorners3& exact, const TriangleCorners3& on_grid);

struct CertifiedGroup {
  double deviation = 0.0;             ///< the largest of all its bounds
  std::vector<TriangleBound> bounds;  ///< per coarser triangle
};

/// The `certified` tier: from what is proven of the triangles of a group to what is proven of what replaces them. Needs
/// no samples and no source: the source's part was taken into account at level 0.
[[nodiscard]] CertifiedGroup certify_group(const GroupSurface& finer, std::span<const TriangleBound> finer_bounds,
                                           const GroupSurface& coarser);

}  // namespace meshlode::builder
