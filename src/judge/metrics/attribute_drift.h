// SPDX-License-Identifier: GPL-3.0-or-later
// How far shading normals and UVs of two surfaces are apart, both ways: each sample's values against the values at its
// counterpart on the other surface.
//
// The nearest point need not be the counterpart: values jump at seams and creases, which simplification moves sideways,
// and the two sides of a thin sheet, or two layers, lie nearer to each other than quantization is fine. Candidates are
// the nearest point, all points equally near (within `tie`), the nearest point of each other layer within `side_reach`
// (layers.h), and of each other side of a seam within `seam_reach`. The counterpart is the candidate that agrees best
// in normals and all UV sets together: so a point is held against its own side and its own chart, and damage to one
// attribute is not hidden by another side that happens to agree in that one alone.
//
// Of a layer its nearest point alone counts. Sides of a seam are told apart by value: a candidate that differs from a
// nearer one by no more than a slide along the surface explains is the same side, and does not count. So smooth drift
// is never hidden by sliding.
#pragma once

#include <memory>

#include "judge/metrics/shaded_surface.h"

namespace meshlode::judge {

struct DriftOptions {
  std::uint64_t samples = 200000;  ///< area-uniform samples each way; used vertices count for the maximum on top
  std::uint64_t seed = 1;
  double tie = 0.0;         ///< object units; distances that differ by no more than this are equal
  double side_reach = 0.0;  ///< object units; how much farther than the nearest point another layer may lie
  double seam_reach = 0.0;  ///< the same for the other side of a seam
};

/// Over the samples of one surface; `max` over its vertices too. 0 where nothing could be compared (`points` is 0).
struct OneWayDrift {
  double rms = 0.0, p99 = 0.0, max = 0.0;
  std::uint64_t points = 0;
};

struct DriftReport {
  OneWayDrift normal_a_to_b, normal_b_to_a;  ///< degrees
  OneWayDrift uv_a_to_b, uv_b_to_a;          ///< UV units, the largest over the sets that both have
  [[nodiscard]] bool has_normals() const { return normal_a_to_b.points + normal_b_to_a.points > 0; }
  [[nodiscard]] bool has_uvs() const { return uv_a_to_b.points + uv_b_to_a.points > 0; }
};

/// A surface made ready to be compared, as often as wanted.
class DriftSurface {
 public:
  explicit DriftSurface(ShadedSurface surface);
  ~DriftSurface();
  DriftSurface(DriftSurface&&) noexcept;
  struct Parts;
  [[nodiscard]] const Parts& parts() const { return *parts_; }

 private:
  std::unique_ptr<Parts> parts_;
};

/// Attributes that only one of the two has are left out.
[[nodiscard]] DriftReport measure_drift(const DriftSurface& a, const DriftSurface& b, const DriftOptions& options);

}  // namespace meshlode::judge
