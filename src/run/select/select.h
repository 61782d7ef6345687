// SPDX-License-Identifier: MIT
// Select: which clusters are drawn. The rule itself is run/select/metric.h (C++ and GLSL); this is its use on the CPU.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "base/enum_names.h"
#include "base/ids.h"
#include "base/vec.h"
#include "run/read/asset.h"
#include "run/select/attribute_bounds.h"
#include "run/select/frustum.h"
#include "run/select/metric.h"

namespace meshlode::run {

/// A camera as the command line gives it (`--camera`, `--ortho`). Right-handed, y up unless looking along y.
struct Camera {
  Vec3d eye{0.0, 0.0, 1.0};
  Vec3d target{0.0};
  bool is_orthographic = false;
  double fovy = 0.78539816339744831;  ///< radians, perspective only
  double ortho_height = 1.0;          ///< world units that the picture's height spans, orthographic only
  double near_distance = 1e-3;        ///< world units
  std::uint32_t width = 1280, height = 720;
};

/// The records that selection reads: those of an asset, or of a test.
struct SelectTables {
  std::span<const format::MeshRecord> meshes;
  std::span<const format::InstanceRecord> instances;
  std::span<const format::GroupRecord> groups;
  std::span<const format::ClusterRecord> clusters;
  std::span<const format::NodeRecord> nodes;
};
[[nodiscard]] SelectTables tables_of(const Asset& asset);

/// The camera and one instance, rounded once to the floats that the rule sees (metric.h); what a GPU is given too.
/// `reach` bounds |center| + radius of every stored sphere of the mesh: see mesh_reach. A pixel error that is not above
/// 0 lets only errors of 0 pass.
[[nodiscard]] MetricView make_metric_view(const Camera& camera, double pixel_error,
                                          const format::InstanceRecord& instance, const format::MeshRecord& mesh,
                                          double reach);
/// From the root of the mesh's BVH, object units; 0 for a mesh without groups.
[[nodiscard]] double mesh_reach(const SelectTables& tables, const format::MeshRecord& mesh);

struct ClusterInstance {
  InstanceId instance;
  ClusterId cluster;
  constexpr auto operator<=>(const ClusterInstance&) const = default;
};

/// Every drawn (instance, cluster) for the camera at `pixel_error`, ascending. No culling. Singular instances have
/// none. With bounds, a group passes only where its attribute deviations are within them too.
[[nodiscard]] std::vector<ClusterInstance> select_flat(const Asset& asset, const Camera& camera, double pixel_error,
                                                       const AttributeBounds& bounds = {});
/// The same set through the BVH (I8). With a frustum, less what has its culling sphere outside.
[[nodiscard]] std::vector<ClusterInstance> select_bvh(const Asset& asset, const Camera& camera, double pixel_error,
                                                      const AttributeBounds& bounds = {},
                                                      const Frustum* frustum = nullptr);

[[nodiscard]] std::vector<ClusterInstance> select_flat(const SelectTables& tables, const Camera& camera,
                                                       double pixel_error, const AttributeBounds& bounds = {});
/// How much work a traversal was; for tests and benchmarks.
struct TraversalCount {
  std::uint64_t nodes = 0;     ///< BVH nodes tested
  std::uint64_t clusters = 0;  ///< clusters tested
};
[[nodiscard]] std::vector<ClusterInstance> select_bvh(const SelectTables& tables, const Camera& camera,
                                                      double pixel_error, TraversalCount* count = nullptr,
                                                      const AttributeBounds& bounds = {},
                                                      const Frustum* frustum = nullptr);
/// The same, or nothing where it has more than `max_clusters` entries: instances times clusters are a product that a
/// small file may choose. It stops there.
[[nodiscard]] std::optional<std::vector<ClusterInstance>> select_bvh_within(const SelectTables& tables,
                                                                            const Camera& camera, double pixel_error,
                                                                            std::size_t max_clusters,
                                                                            const AttributeBounds& bounds = {});

enum class CutError : std::uint8_t { kSelection, kQuadric };  ///< which stored number decides a uniform cut
inline constexpr std::array<EnumName<CutError>, 2> kCutErrorNames{
    {{CutError::kSelection, "selection"}, {CutError::kQuadric, "quadric"}}};

struct UniformCut {
  std::vector<ClusterId> clusters;  ///< ascending
  double stored_error = 0.0;        ///< max(largest selected own error, level-0 deviation), object units
};
/// The cut of one mesh where a group passes iff its error <= `error` (object units) and its attribute deviations are
/// within the bounds. No camera.
[[nodiscard]] UniformCut select_uniform(const Asset& asset, MeshId mesh, double error,
                                        CutError by = CutError::kSelection, const AttributeBounds& bounds = {});
[[nodiscard]] UniformCut select_uniform(const SelectTables& tables, MeshId mesh, double error,
                                        CutError by = CutError::kSelection, const AttributeBounds& bounds = {});

}  // namespace meshlode::run
