// SPDX-License-Identifier: MIT
// Select: which clusters are drawn. The rule itself is select/metric.h (C++ and GLSL); this is its use on the CPU.
#pragma once

#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "read/asset.h"

namespace meshlode {

/// A camera as the command line gives it (design, section 4). Right-handed, y up unless looking along y.
struct Camera {
  Vec3d eye{0.0, 0.0, 1.0};
  Vec3d target{0.0};
  bool is_orthographic = false;
  double fovy = 0.78539816339744831;  ///< radians, perspective only
  double ortho_height = 1.0;          ///< world units that the picture's height spans, orthographic only
  double near_distance = 1e-3;        ///< world units
  std::uint32_t width = 1280, height = 720;
};

struct ClusterInstance {
  InstanceId instance;
  ClusterId cluster;
  constexpr auto operator<=>(const ClusterInstance&) const = default;
};

/// Every drawn (instance, cluster) for the camera at `pixel_error`, ascending. No culling. Singular instances have none.
[[nodiscard]] std::vector<ClusterInstance> select_flat(const Asset& asset, const Camera& camera, double pixel_error);
/// The same set through the BVH (I8).
[[nodiscard]] std::vector<ClusterInstance> select_bvh(const Asset& asset, const Camera& camera, double pixel_error);

enum class CutError : std::uint8_t { kSelection, kQuadric };  ///< which stored number decides a uniform cut

struct UniformCut {
  std::vector<ClusterId> clusters;  ///< ascending
  double stored_error = 0.0;        ///< max(largest selected own error, level-0 deviation), object units
};
/// The cut of one mesh where a group passes iff its error <= `error` (object units). No camera.
[[nodiscard]] UniformCut select_uniform(const Asset& asset, MeshId mesh, double error,
                                        CutError by = CutError::kSelection);

}  // namespace meshlode
