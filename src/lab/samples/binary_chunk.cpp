// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/samples/binary_chunk.h"

#include <algorithm>
#include <cmath>

#include "base/box.h"

namespace meshlode::lab {

using namespace scene;

namespace {

std::int32_t round_to(double value, double scale) {
  return static_cast<std::int32_t>(std::floor(value * scale + 0.5));
}

}  // namespace

void widen(Accessor& accessor, const double* values, int count) {
  if (accessor.low.empty()) {
    accessor.low.assign(values, values + count);
    accessor.high = accessor.low;
  }
  for (int k = 0; k < count; ++k) {
    accessor.low[k] = std::min(accessor.low[k], values[k]);
    accessor.high[k] = std::max(accessor.high[k], values[k]);
  }
}

Dequantization dequantization_of(const GlbMesh& mesh) {
  Dequantization out;
  if (!mesh.quantize) return out;
  Box3d box;
  for (const Primitive& primitive : mesh.primitives) {
    for (const Vec3d& p : primitive.positions) box.add(p);
  }
  out.center = 0.5 * (box.low + box.high);
  const Vec3d half = 0.5 * box.size();
  out.scale = std::max({half.x, half.y, half.z, 1e-30});
  return out;
}

std::uint32_t write_positions(BinaryChunk& chunk, const Primitive& primitive, bool quantize, const Dequantization& dq) {
  Accessor accessor{0, quantize ? kShort : kFloat, primitive.positions.size(), "VEC3", quantize, {}, {}};
  chunk.begin_view(quantize ? 8 : 12, kArrayBuffer);
  for (const Vec3d& p : primitive.positions) {
    double stored[3];
    for (int k = 0; k < 3; ++k) {
      if (quantize) {
        const std::int32_t q = round_to((p[k] - dq.center[k]) / dq.scale, 32767.0);
        chunk.put(static_cast<std::int16_t>(q));
        stored[k] = q;
      } else {
        const auto f = static_cast<float>(p[k]);
        chunk.put(f);
        stored[k] = static_cast<double>(f);
      }
    }
    if (quantize) chunk.put(std::int16_t{0});
    widen(accessor, stored, 3);
  }
  accessor.view = chunk.end_view();
  return chunk.add_accessor(std::move(accessor));
}

std::uint32_t write_normals(BinaryChunk& chunk, const Primitive& primitive, bool quantize) {
  chunk.begin_view(quantize ? 4 : 12, kArrayBuffer);
  for (const Vec3f& n : primitive.normals) {
    for (int k = 0; k < 3; ++k) {
      if (quantize) {
        chunk.put(static_cast<std::int8_t>(round_to(static_cast<double>(n[k]), 127.0)));
      } else {
        chunk.put(n[k]);
      }
    }
    if (quantize) chunk.put(std::int8_t{0});
  }
  return chunk.add_accessor(
      {chunk.end_view(), quantize ? kByte : kFloat, primitive.normals.size(), "VEC3", quantize, {}, {}});
}

std::uint32_t write_uvs(BinaryChunk& chunk, const Primitive& primitive, bool quantize) {
  chunk.begin_view(quantize ? 4 : 8, kArrayBuffer);
  for (const Vec2f& uv : primitive.uvs[0]) {
    for (int k = 0; k < 2; ++k) {
      if (quantize) {
        chunk.put(static_cast<std::uint16_t>(round_to(static_cast<double>(uv[k]), 65535.0)));
      } else {
        chunk.put(uv[k]);
      }
    }
  }
  const std::size_t count = primitive.uvs[0].size();
  return chunk.add_accessor({chunk.end_view(), quantize ? kUnsignedShort : kFloat, count, "VEC2", quantize, {}, {}});
}

std::uint32_t write_indices(BinaryChunk& chunk, const Primitive& primitive) {
  const bool is_short = primitive.positions.size() <= 65535;  // 65535 itself would be the restart value
  chunk.begin_view(0, kElementArrayBuffer);
  for (const std::uint32_t index : primitive.indices) {
    if (is_short) {
      chunk.put(static_cast<std::uint16_t>(index));
    } else {
      chunk.put(index);
    }
  }
  const std::uint32_t component = is_short ? kUnsignedShort : kUnsignedInt;
  return chunk.add_accessor({chunk.end_view(), component, primitive.indices.size(), "SCALAR", false, {}, {}});
}

}  // namespace meshlode::lab
