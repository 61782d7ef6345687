// SPDX-License-Identifier: GPL-3.0-or-later
// The true deviation of uniform cuts of one mesh, for many cuts of it: what two cuts share is measured once.
// Cut to source, the figures of a cluster do not depend on the cut that it is in, and are kept. Source to cut, the
// farthest points of earlier cuts are asked first, so that a cut that is too far off is mostly refused by a few points.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "judge/metrics/area_samples.h"
#include "judge/metrics/metrics.h"
#include "judge/metrics/triangle_tree.h"
#include "run/decode/decode.h"
#include "run/select/select.h"

namespace meshlode::judge {

/// Object units. RMS over area-uniform samples; maxima over samples and all vertices.
struct CutFigures {
  std::uint64_t triangles = 0;
  double max_to_cut = 0.0, max_to_source = 0.0;
  double rms_to_cut = 0.0, rms_to_source = 0.0;
  [[nodiscard]] double max() const { return max_to_cut > max_to_source ? max_to_cut : max_to_source; }
  [[nodiscard]] double rms() const { return rms_to_cut > rms_to_source ? rms_to_cut : rms_to_source; }
};

/// A source made ready to be measured from, for as many assets as there are.
struct CutSource {
  /// At least `samples` area-uniform samples each way for cuts that have three quarters of the source's area or more.
  CutSource(const Surface& source, std::uint64_t samples);

  std::uint64_t samples = 0;
  TriangleTree tree;
  std::vector<Vec3d> points;  ///< samples, then vertices
  std::size_t sample_count = 0;
  double density = 0.0;  ///< samples per unit of area, on cuts
};

class CutJudge {
 public:
  /// \pre the arguments outlive this
  CutJudge(std::shared_ptr<const CutSource> source, const run::Asset& asset,
           std::span<const run::DecodedCluster> decoded, MeshId mesh);
  /// Of a source that nothing else is measured from.
  CutJudge(const Surface& source, const run::Asset& asset, std::span<const run::DecodedCluster> decoded, MeshId mesh,
           std::uint64_t samples);

  [[nodiscard]] CutFigures measure(std::span<const ClusterId> clusters) { return *measure_within(clusters, {}); }
  struct Limit {
    double max = 1e150, rms = 1e150;  ///< object units
  };
  /// Nothing where the maximum or the RMS is above its limit.
  [[nodiscard]] std::optional<CutFigures> measure_within(std::span<const ClusterId> clusters, const Limit& limit);
  /// The same for a surface that is no cut (nothing is kept).
  [[nodiscard]] CutFigures measure(const Surface& surface) const;

 private:
  struct ClusterFigures {
    bool is_known = false;
    double area = 0.0, mean2 = 0.0, max2 = 0.0;
  };
  struct Forward {
    double sum2 = 0.0, max2 = 0.0;
    bool is_within = true;
  };
  [[nodiscard]] ClusterFigures measure_cluster(ClusterId cluster) const;
  [[nodiscard]] Forward measure_to_cut(const TriangleTree& cut, const Limit& limit,
                                       std::vector<std::uint32_t>* worst) const;

  std::shared_ptr<const CutSource> source_;
  const run::Asset& asset_;
  std::span<const run::DecodedCluster> decoded_;
  MeshId mesh_;
  std::vector<ClusterFigures> clusters_;
  std::vector<std::uint32_t> suspects_;  ///< points that were far from some cut, latest last
};

}  // namespace meshlode::judge
