// SPDX-License-Identifier: GPL-3.0-or-later
// The two directions of a group's deviation, each with the maximum so far: whoever cannot raise it is dismissed early.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/unset_vector.h"
#include "builder/deviation/deviation.h"
#include "builder/deviation/group_edges.h"
#include "builder/deviation/patch.h"
#include "builder/deviation/source_tree.h"
#include "builder/deviation/surface_tree.h"

namespace meshlode::builder {

/// The largest distance of a group, as far as it is known.
struct Farthest {
  double found = 0.0;  ///< of all points that were measured exactly
  double least = 0.0;  ///< less is of no use
  [[nodiscard]] double to_beat() const { return found > least ? found : least; }
  void take(double value) { found = value > found ? value : found; }
};

/// Source to group. Sets each sample's triangle and distance, of samples that are near against the others one near
/// enough; returns the largest distance.
[[nodiscard]] double project_samples(const SurfaceTree& group_tree, std::vector<CarriedSample>& samples);

/// What goes on to the next level: for each triangle of the group the farthest samples, some spread, and whatever is
/// near the group's maximum. Ordered by triangle.
[[nodiscard]] UnsetVector<CarriedSample> thin_samples(std::span<const CarriedSample> samples,
                                                      std::size_t triangle_count, std::uint32_t samples_per_triangle,
                                                      double maximum);

/// With less effort on top (DeviationTierOptions::extra_effort) nothing is spared: the groups are many, and small
/// against the mesh.
constexpr std::uint32_t kLeastExtra = 150;

/// Triangles and their parts that may be divided.
struct Effort {
  std::size_t promising = 0;
  std::size_t spare = 0;  ///< where nothing is promised, but a bound leaves room
  Rise rise;              ///< what a patch promises
};

/// Group to source, by adaptive subdivision near the maximum. `places` has for each triangle of the group where its
/// search may begin, and gets where its middle was found. `high` gets points of the group near the maximum; their
/// places are those of their nearest triangles of the source.
[[nodiscard]] Farthest measure_to_source(const SurfaceTree& source, const GroupSurface& group, const GroupEdges& edges,
                                         std::vector<TreeSlot>& places, Farthest farthest, Effort budget,
                                         std::vector<CarriedSample>& high);

/// Group to source once more, by bounds: what is farther than `margin` times what is known. Where it ends within its
/// effort, nothing is by more than BoundedSearch leaves. Little is looked at where that would take much. `places`: as
/// measure_to_source() leaves them.
[[nodiscard]] Farthest search_by_bounds(const SurfaceTree& source, const GroupSurface& group,
                                        std::span<const TreeSlot> places, double margin, Farthest farthest);

/// Group to source beyond the borders of `finer`, with `edges`, that the group may have closed. Those between two
/// positions of `is_shared` are the group's own border and stay; empty: all are taken so.
[[nodiscard]] Farthest measure_closed_borders(const SurfaceTree& source, const SurfaceTree& group_tree,
                                              const GroupSurface& finer, const GroupEdges& edges,
                                              std::span<const std::uint8_t> is_shared, Farthest farthest);

/// Which points of the source a group stands for: those that were near enough to what it replaces, on the same side and
/// not beyond the border that it shares with other groups. Beyond the source's own border there is nobody else.
class OwnerTest {
 public:
  /// `edges` are those of `finer` and outlive this.
  OwnerTest(const GroupSurface& finer, const GroupEdges& edges, std::span<const std::uint8_t> is_shared, double reach,
            bool is_whole)
      : finer_(finer), edges_(edges), is_shared_(is_shared), reach_(reach), is_whole_(is_whole) {}
  [[nodiscard]] const GroupSurface& finer() const { return finer_; }
  [[nodiscard]] bool is_whole() const { return is_whole_; }
  [[nodiscard]] bool is_known() const { return !finer_.triangles.empty(); }
  /// `facing` is the direction of the source's surface there, of any length.
  [[nodiscard]] bool is_ours(const Vec3d& point, const Vec3d& facing);

 private:
  [[nodiscard]] bool is_shared(std::uint32_t position) const { return is_shared_.empty() || is_shared_[position] != 0; }

  GroupSurface finer_;
  const GroupEdges& edges_;
  std::span<const std::uint8_t> is_shared_;
  double reach_;
  bool is_whole_;     ///< there is nobody else
  SurfaceTree tree_;  ///< over what is replaced, built when first asked
  TreeSlot place_{0U};
};

/// Source to group around the farthest samples, around `high` and behind what the group replaces where that is folded
/// (find_folded()). Points that raised the maximum are appended to the samples.
[[nodiscard]] Farthest search_source(const SourceTree::Impl& source, const GroupSurface& group,
                                     const SurfaceTree& group_tree, OwnerTest& owner,
                                     std::span<const std::uint8_t> is_folded, Farthest farthest,
                                     std::span<const CarriedSample> high, std::size_t budget,
                                     std::vector<CarriedSample>& samples);

}  // namespace meshlode::builder
