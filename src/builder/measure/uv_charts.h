// SPDX-License-Identifier: GPL-3.0-or-later
// Which chart of the source a vertex of the DAG belongs to. A chart (UV island) is what of the source hangs together
// by corners with one place and the same texture coordinates in all sets: normals do not part it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builder/lod_dag.h"
#include "builder/measure/canonical_form.h"
#include "builder/prepared.h"

namespace meshlode::builder {

class UvCharts {
 public:
  /// Those of level 0. `form` is the DAG's, whose triangles are in its order; what is given must outlive this.
  UvCharts(const PreparedMesh& mesh, const CanonicalForm& form, const LodDag& dag);

  /// Those of a group's coarser clusters, from its members. An asset does not tell which triangle of the finer clusters
  /// one of the coarser comes from, but vertices that were not moved are the same in both, on the group's border all of
  /// them: what hangs together with one has its chart. What was moved altogether has that of the member's vertex
  /// nearest in place and texture coordinates. Groups of a level side by side.
  void label(const DagGroup& group, std::span<const std::uint32_t> made);

  /// Per vertex of the DAG; kNoId: not known.
  [[nodiscard]] std::span<const std::uint32_t> of_vertex() const { return chart_; }

 private:
  class Keys;
  template <class Visit>
  void for_each_vertex(std::uint32_t cluster, const Visit& visit) const;
  template <class Visit>
  void for_each_triangle(std::uint32_t cluster, const Visit& visit) const;
  [[nodiscard]] const float* uvs(std::uint32_t vertex) const {
    return dag_.vertex_attributes.data() + vertex * mesh_.layout.stride() + mesh_.layout.uv_offset();
  }
  [[nodiscard]] double uv_scale2(std::span<const std::uint32_t> made) const;

  const PreparedMesh& mesh_;
  const CanonicalForm& form_;
  const LodDag& dag_;
  std::vector<std::uint32_t> chart_;
};

}  // namespace meshlode::builder
