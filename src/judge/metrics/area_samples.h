// SPDX-License-Identifier: GPL-3.0-or-later
// Samples that are uniform in area and stratified: the i-th of n lies in the i-th n-th of the area, so that no region
// is missed by chance. A pure function of surface, seed and index: the same for any thread count.
#pragma once

#include <cstdint>
#include <vector>

#include "judge/metrics/metrics.h"

namespace meshlode::judge {

struct SurfacePoint {
  std::uint32_t triangle = 0;
  double u = 0.0, v = 0.0;  ///< weights of the second and third corner; the first has 1 - u - v
};

class AreaSamples {
 public:
  /// \pre `surface` outlives this
  AreaSamples(const Surface& surface, std::uint64_t count, std::uint64_t seed);

  [[nodiscard]] double area() const { return cumulative_.empty() ? 0.0 : cumulative_.back(); }
  /// The count asked for, or 0 for a surface without area.
  [[nodiscard]] std::uint64_t count() const { return area() > 0.0 ? count_ : 0; }
  /// \pre i < count()
  [[nodiscard]] SurfacePoint sample(std::uint64_t i) const;
  [[nodiscard]] Vec3d position(const SurfacePoint& point) const;

 private:
  const Surface& surface_;
  std::uint64_t count_, seed_;
  std::vector<double> cumulative_;  ///< area of the triangles up to and including each one
};

/// The vertices that triangles use, ascending.
[[nodiscard]] std::vector<std::uint32_t> used_vertices(const Surface& surface);
/// Of the first triangles alone.
[[nodiscard]] std::vector<std::uint32_t> used_vertices(const Surface& surface, std::size_t triangle_count);

}  // namespace meshlode::judge
