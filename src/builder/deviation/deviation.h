// SPDX-License-Identifier: GPL-3.0-or-later
// Deviation: the source that groups are held against, and the tier `certified` of one group: what is proven of its
// triangles is handed on to the triangles that replace them.
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

/// The source's surface before the grid, relative to the mesh's origin, in object units. Built once per mesh; queries
/// are const and may run side by side. Deterministic: same bits for any thread count, compiler and processor (I10).
class SourceTree {
 public:
  /// What the spans show must outlive the tree.
  SourceTree(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles);
  ~SourceTree();
  SourceTree(SourceTree&&) noexcept;
  SourceTree& operator=(SourceTree&&) noexcept;

  struct Impl;
  [[nodiscard]] const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// A simplified group. Triangle ids are indices into `triangles`.
struct GroupSurface {
  std::span<const Vec3d> positions;  ///< relative to the origin, object units (grid point times step)
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

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
