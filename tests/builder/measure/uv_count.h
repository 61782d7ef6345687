// SPDX-License-Identifier: GPL-3.0-or-later
// UV deviations counted once more: charts, which of them a triangle of the DAG is of, what is nearest and which source
// a group stands for are all found without the builder's measuring code.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "builder/lod_dag.h"
#include "builder/plan/attributes.h"
#include "builder/prepared.h"
#include "scene/scene.h"

namespace meshlode::builder::test {

/// A mesh and its DAG, measured, and what of the source each triangle comes from: it rode through the simplifier.
struct ChartedDag {
  PreparedMesh mesh;
  LodDag dag;
  std::vector<std::uint32_t> source_chart;    ///< per source triangle
  std::vector<std::uint32_t> triangle_chart;  ///< per triangle of the DAG; kNoId: two claim to be it
  std::uint32_t chart_count = 0;
};
[[nodiscard]] ChartedDag build_charted(const scene::SourceMesh& source,
                                       const std::vector<scene::SceneMaterial>& materials);

/// What 2,048 points call 95% has half a percent of standard deviation: the truth is asked for so much less and more,
/// too.
constexpr std::array<double, 3> kShares{0.945, 0.95, 0.955};

/// Of one group.
struct CountedUvs {
  std::array<double, 3> both{};  ///< what is to be stored, for each of kShares: running maxima along the DAG
  double of_group = 0.0;         ///< of 95% of its own points
  double nearest = 0.0;          ///< the same, held against the nearest point of whatever chart
  std::size_t vanished = 0;      ///< points of the source whose chart the group does not have
};
/// Per group.
[[nodiscard]] std::vector<CountedUvs> count_uvs(const ChartedDag& charted);

}  // namespace meshlode::builder::test
