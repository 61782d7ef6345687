// SPDX-License-Identifier: GPL-3.0-or-later
// Encode: a mesh's DAG becomes quantized channels, bit-packed clusters and GPU-ready pages (docs/reference/format.md,
// Pages).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "builder/hierarchy/hierarchy.h"
#include "builder/lod_dag.h"
#include "builder/order/deal_groups.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Accuracy budgets; the bits follow from them.
struct EncodeOptions {
  double normal_error = 0.1;  ///< degrees, largest; above 0, at least 0.01 (kMaxNormalScale)
  /// UV units, largest, for each stored set; 0: invisible, see default_uv_error
  std::array<double, scene::kMaxUvSets> uv_error{};
  /// Coordinates so large that 24 bits cannot keep the error are kept as finely as floats hold the largest of them;
  /// false: refused.
  bool uv_error_may_fall_short = true;
  std::uint32_t strip_trials = 8;  ///< see StripOptions
  /// Of a cluster of several materials: strips are short where these meet, and more is to be had by trying.
  std::uint32_t mixed_strip_trials = 128;
  std::uint32_t page_bytes = format::kMaxPageBytes;        ///< a page is full there; a larger group has one of its own
  std::uint32_t first_page_bytes = format::kMaxPageBytes;  ///< the same of the mesh's first page
};

/// The M of the normals that keeps EncodeOptions::normal_error, at most format::kMaxNormalScale.
[[nodiscard]] std::int32_t normal_scale_of(const EncodeOptions& options);

/// One mesh, ready to be written: records with per-mesh ids (first_group = 0 and so on), pages not packed yet.
struct EncodedMesh {
  struct Page {
    std::uint32_t first_group = 0, group_count = 0;      ///< per mesh
    std::uint32_t first_cluster = 0, cluster_count = 0;  ///< per mesh
    std::vector<std::uint8_t> bytes;          ///< PageHeader and on; PageHeader::first_cluster is patched by write
    std::vector<std::uint32_t> dependencies;  ///< pages of this mesh that hold the coarser clusters, ascending
  };
  format::MeshRecord record{};
  std::vector<format::GroupRecord> groups;
  std::vector<format::ClusterRecord> clusters;
  std::vector<format::NodeRecord> nodes;
  std::vector<Page> pages;
  format::PromiseMeshRecord promise{};                     ///< where there are errors below, or no groups at all
  std::vector<format::PromiseGroupRecord> promise_errors;  ///< one a group, or none: positions alone are promised
};

/// What a group's errors are stored as; `error` is the nested one (Hierarchy::group_errors).
void put_errors(const DagGroup& group, float error, format::GroupRecord& record);

/// Whether something of them is drawn instead of an aggregate's pieces. A mesh that ended at level 0 has none.
[[nodiscard]] bool has_aggregates(std::span<const format::GroupRecord> groups);

/// Upper bound of the bytes that one cluster adds to a page, whatever its coordinates: a group fits a page where
/// kPageFrameBytes + the sum over its members is at most format::kMaxPageBytes. `material_count` is how many
/// materials the cluster holds at most.
[[nodiscard]] std::uint32_t max_cluster_bytes(const AttributeLayout& layout, const EncodeOptions& options,
                                              std::uint32_t vertex_count = format::kMaxClusterVertices,
                                              std::uint32_t triangle_count = format::kMaxClusterTriangles,
                                              std::uint32_t material_count = 4);

/// Attributes that are not finite become 0 (a normal: +z). `needs`: see deal_groups(). Errors: kUnsupported where a
/// group does not fit a page, naming mesh and group, or where the grid leaves the range of floats; kBuildFailed where
/// the DAG breaks the format's limits.
[[nodiscard]] Result<EncodedMesh> encode_mesh(const PreparedMesh& mesh, const LodDag& dag, const Hierarchy& hierarchy,
                                              const EncodeOptions& options, std::span<const ViewBits> needs = {});

}  // namespace meshlode::builder
