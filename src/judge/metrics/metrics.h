// SPDX-License-Identifier: GPL-3.0-or-later
// Metrics: how far two surfaces are apart, both ways. Exact nearest points at area-uniform samples and at all vertices;
// so the maximum is one from below, and the tighter the more samples.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// A triangle soup: any triangles, those without area too; every index is below positions.size(), positions finite.
struct Surface {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct DeviationOptions {
  std::uint64_t samples = 200000;  ///< area-uniform samples each way, stratified; all used vertices come on top
  std::uint64_t seed = 1;          ///< the same seed gives the same samples, for any thread count
};

/// From the points of one surface to the nearest points of the other.
struct OneWayDeviation {
  double max = 0.0;          ///< over samples and vertices, in units of the positions
  double rms = 0.0;          ///< over the samples alone: they are uniform in area
  Vec3d worst{0.0};          ///< the point where `max` was found
  std::uint64_t points = 0;  ///< samples and vertices
};

struct DeviationReport {
  OneWayDeviation a_to_b, b_to_a;
  [[nodiscard]] double max() const { return a_to_b.max > b_to_a.max ? a_to_b.max : b_to_a.max; }
  [[nodiscard]] double rms() const { return a_to_b.rms > b_to_a.rms ? a_to_b.rms : b_to_a.rms; }
};

/// A surface a that others are measured against, one after another: what is made of it is made once. Infinite where one
/// surface has no triangle and the other has; 0 where both have none.
class DeviationFrom {
 public:
  /// \pre `a` outlives this
  DeviationFrom(const Surface& a, const DeviationOptions& options);
  ~DeviationFrom();
  DeviationFrom(DeviationFrom&&) noexcept;

  [[nodiscard]] DeviationReport measure(const Surface& b) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Clusters of one mesh as a surface in mesh space (origin included), exactly as decoded. `decoded` has every cluster
/// of the asset, as decode_all gives them.
[[nodiscard]] Surface surface_of_clusters(const run::Asset& asset, std::span<const run::DecodedCluster> decoded,
                                          MeshId mesh, std::span<const ClusterId> clusters);

/// The same, decoded here, page by page. Errors: as run::load_page().
[[nodiscard]] Result<Surface> surface_of_clusters(const run::Asset& asset, MeshId mesh,
                                                  std::span<const ClusterId> clusters);

/// The source: the triangles that have area, exactly (docs/reference/format.md, "The source"), all primitives of the
/// mesh together, as read. `primitives`: of each triangle the primitive that it is of.
[[nodiscard]] Surface surface_of_source(const scene::SourceMesh& mesh,
                                        std::vector<std::uint32_t>* primitives = nullptr);

}  // namespace meshlode::judge
