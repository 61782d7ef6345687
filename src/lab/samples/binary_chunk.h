// SPDX-License-Identifier: GPL-3.0-or-later
// The BIN chunk of a GLB in the making, and a primitive's data in it: as floats, or quantized (KHR_mesh_quantization).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "lab/samples/write_glb.h"

namespace meshlode::lab {

constexpr std::uint32_t kByte = 5120, kUnsignedShort = 5123, kShort = 5122, kUnsignedInt = 5125, kFloat = 5126;
constexpr std::uint32_t kArrayBuffer = 34962, kElementArrayBuffer = 34963;

struct BufferView {
  std::size_t offset = 0, bytes = 0;
  std::uint32_t stride = 0, target = 0;  ///< 0: not written
};

struct Accessor {
  std::uint32_t view = 0, component = kFloat;
  std::size_t count = 0;
  const char* type = "SCALAR";
  bool normalized = false;
  std::vector<double> low, high;  ///< empty: not written
};

/// How a quantized mesh is scaled back: position = center + scale · stored.
struct Dequantization {
  Vec3d center{0.0};
  double scale = 1.0;
};

class BinaryChunk {
 public:
  std::vector<BufferView> views;
  std::vector<Accessor> accessors;
  std::vector<std::uint8_t> bytes;

  template <class T>
  void put(T value) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(&bytes[at], &value, sizeof value);
  }

  /// Starts a view at a multiple of 4; end_view() closes it.
  void begin_view(std::uint32_t stride, std::uint32_t target) {
    pad(4);
    views.push_back({bytes.size(), 0, stride, target});
  }
  std::uint32_t end_view() {
    views.back().bytes = bytes.size() - views.back().offset;
    return static_cast<std::uint32_t>(views.size() - 1);
  }
  std::uint32_t add_accessor(Accessor accessor) {
    accessors.push_back(std::move(accessor));
    return static_cast<std::uint32_t>(accessors.size() - 1);
  }
  void pad(std::size_t multiple) {
    while (bytes.size() % multiple != 0) bytes.push_back(0);
  }
};

/// Of an accessor's bounds: so that they hold an element of `count` numbers.
void widen(Accessor& accessor, const double* values, int count);

/// What it takes to store a mesh's positions as 16-bit integers; nothing to do where it is not quantized.
/// \pre each of its primitives has a vertex
[[nodiscard]] Dequantization dequantization_of(const GlbMesh& mesh);

/// Each adds a view and an accessor, and returns the accessor's index.
std::uint32_t write_positions(BinaryChunk& chunk, const scene::Primitive& primitive, bool quantize,
                              const Dequantization& dq);
std::uint32_t write_normals(BinaryChunk& chunk, const scene::Primitive& primitive, bool quantize);
std::uint32_t write_uvs(BinaryChunk& chunk, const scene::Primitive& primitive, bool quantize);  ///< of the first set
std::uint32_t write_indices(BinaryChunk& chunk, const scene::Primitive& primitive);

}  // namespace meshlode::lab
