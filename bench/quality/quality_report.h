// SPDX-License-Identifier: GPL-3.0-or-later
// What bench_quality found, as a text table and as JSON. Deviations here are shares of the mesh's diagonal.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "judge/metrics/attribute_drift.h"
#include "judge/metrics/cut_judge.h"

namespace meshlode::bench {

/// A cut with what it deviates by.
struct MeasuredCut {
  double threshold = 0.0;     ///< share of the diagonal
  double stored = 0.0;        ///< the cut's stored error, share of the diagonal
  judge::CutFigures figures;  ///< object units
  std::optional<judge::DriftReport> drift;
};

/// The fewest triangles at one deviation.
struct EqualDeviation {
  std::string method;  ///< "cuts", or the name of the reference simplifier
  std::string figure;  ///< "max" or "rms"
  double x = 0.0;      ///< share of the diagonal
  std::optional<MeasuredCut> cut;
  std::size_t cuts_measured = 0, cuts_of_mesh = 0;
  double seconds = 0.0;
};

struct MeshQuality {
  std::string name;
  double diagonal = 0.0;
  std::uint64_t source_triangles = 0;
  std::string tier;
  std::vector<MeasuredCut> cuts;
  std::vector<EqualDeviation> equal;
  std::vector<std::string> notes;
};

[[nodiscard]] std::string quality_text(const MeshQuality& mesh);
[[nodiscard]] std::string quality_json(const std::string& scene, const std::string& asset,
                                       const std::vector<MeshQuality>& meshes);

}  // namespace meshlode::bench
