// SPDX-License-Identifier: GPL-3.0-or-later
// Vertex data in fewer bytes: KHR_mesh_quantization (small integers) and EXT_meshopt_compression (what a reader decodes
// before it gives it to a GPU). Without either, streams are the floats that any reader knows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "app/export/cut_geometry.h"
#include "base/box.h"
#include "base/vec.h"

namespace meshlode::app {

struct Packing {
  bool quantize = false;
  bool meshopt = false;
};

/// Types of a component (glTF 2.0, 3.6.2.2).
constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;

/// The elements of an accessor as they lie in a view.
struct VertexStream {
  int component = kFloat;
  bool is_normalized = false;
  std::size_t stride = 0;           ///< a multiple of 4, as vertices want
  std::vector<std::uint8_t> bytes;  ///< where there is a filter: what it decodes
  const char* filter = nullptr;     ///< of EXT_meshopt_compression
};

/// Where quantized positions stand: origin + step * integer.
struct QuantizedFrame {
  Vec3d origin{0.0};
  double step = 0.0;  ///< 0: positions are floats
};

/// Collects positions, in mesh space. frame() is the asset's own grid where the positions span no more than 16 bits of
/// it, so that nothing is lost; else one coarser by a power of two, with an origin at a multiple of its step.
class FrameOfPositions {
 public:
  void add(const format::MeshRecord& record, std::span<const CutPrimitive> primitives);
  /// `least_step`: what another mesh of the same grid has; its step is at least that.
  [[nodiscard]] QuantizedFrame frame(double least_step) const;
  [[nodiscard]] double grid_step() const { return step_; }

 private:
  Box3d box_;
  double step_ = 0.0;  ///< the finest of the meshes' grids
};

struct QuantizedPositions {
  VertexStream stream;
  std::array<int, 3> low{}, high{};
};
/// `moved`: the mesh's origin relative to the frame's. \pre the frame is of these vertices
[[nodiscard]] QuantizedPositions quantize_positions(const format::MeshRecord& record,
                                                    const run::DecodedCluster& vertices, const Vec3d& moved,
                                                    double step);

/// Floats. With meshopt as whole multiples of 2^log2, which are the same floats, where all of them are that.
[[nodiscard]] VertexStream pack_floats(std::span<const float> values, std::size_t per_element, int log2,
                                       Packing packing);

/// Unit vectors. Quantized they have as many bits as the asset's own (`scale`: MeshRecord::normal_scale), 8 to 16.
[[nodiscard]] VertexStream pack_normals(std::span<const Vec3f> normals, std::uint32_t scale, Packing packing);

/// Quantized to normalized 16 bits where all lie within 0 and 1; elsewhere floats, whose values no material has to
/// scale.
[[nodiscard]] VertexStream pack_uvs(std::span<const Vec2f> uvs, int log2, Packing packing);

}  // namespace meshlode::app
