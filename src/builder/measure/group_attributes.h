// SPDX-License-Identifier: GPL-3.0-or-later
// How far shading normals and texture coordinates of a group are from the source's, in any tier that measures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "builder/deviation/attribute_deviation.h"
#include "builder/deviation/deviation.h"
#include "builder/lod_dag.h"
#include "builder/measure/canonical_form.h"
#include "builder/measure/uv_charts.h"
#include "builder/prepared.h"

namespace meshlode::builder {

class GroupAttributes {
 public:
  /// `form` is the DAG's, whose triangles are in its order; its level0_of_source is not needed any more. The others
  /// must outlive this.
  GroupAttributes(const SourceTree& source, const PreparedMesh& mesh, const CanonicalForm& form, LodDag& dag);

  /// Sets normal_deviation and uv_deviation of a group of the DAG, not below those of what it replaces (whose groups
  /// are done). `made`: the clusters made from it. `near`: by their triangles, where the source is near; or nothing.
  /// Groups of a level side by side.
  void measure(DagGroup& group, std::span<const std::uint32_t> made, std::span<const TreeSlot> near);

 private:
  [[nodiscard]] std::vector<SurfacePart> take_parts(const DagGroup& group);
  [[nodiscard]] std::span<const std::uint32_t> chart_of_vertex() const {
    return charts_ ? charts_->of_vertex() : std::span<const std::uint32_t>();
  }

  const SourceTree& source_;
  const PreparedMesh& mesh_;
  const CanonicalForm& form_;
  LodDag& dag_;
  // Where there are texture coordinates:
  std::optional<UvCharts> charts_;
  std::vector<std::uint32_t> first_, triangles_;   ///< per cluster of level 0: its triangles of the source
  std::vector<std::vector<SurfacePart>> carried_;  ///< per other cluster: points of the source that it stands for
};

}  // namespace meshlode::builder
