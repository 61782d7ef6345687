// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/packing.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/export/meshopt_encode.h"
#include "format/grid.h"

namespace meshlode::app {

namespace {

constexpr double kMostShort = 65535.0;

template <class T>
std::vector<std::uint8_t> bytes_of(std::span<const T> values) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
  return {first, first + values.size_bytes()};
}

/// The filter EXPONENTIAL: 8 bits of exponent above 24 of mantissa, both signed. Nothing where a value is no such
/// multiple: the filter would change it.
std::optional<std::vector<std::uint8_t>> encode_multiples(std::span<const float> values, int log2) {
  constexpr int kMostExponent = 100;  // the extension's
  constexpr float kMostMantissa = 8388607.0F;
  if (log2 < -kMostExponent || log2 > kMostExponent) return std::nullopt;
  const auto unit = static_cast<float>(format::exp2_exact(log2));
  std::vector<std::int32_t> words(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float count = values[i] / unit;  // exact: the unit is a power of two
    if (!(std::abs(count) <= kMostMantissa) || count != std::floor(count)) return std::nullopt;
    const auto mantissa = static_cast<std::uint32_t>(static_cast<std::int32_t>(count)) & 0xFFFFFFU;
    words[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(log2) << 24U | mantissa);
  }
  return bytes_of(std::span<const std::int32_t>(words));
}

std::int16_t to_signed(float value, float most) {
  return static_cast<std::int16_t>(std::floor(std::clamp(value, -1.0F, 1.0F) * most + 0.5F));
}

}  // namespace

void FrameOfPositions::add(const format::MeshRecord& record, std::span<const CutPrimitive> primitives) {
  const Vec3d origin(record.origin[0], record.origin[1], record.origin[2]);
  const format::PositionGrid grid{record.grid.log2, record.grid.mantissa};
  for (const CutPrimitive& primitive : primitives) {
    for (std::uint32_t i = 0; i < primitive.vertices.vertex_count; ++i) {
      step_ = box_.is_empty() ? grid.step() : std::min(step_, grid.step());
      box_.add(origin + grid.decode(primitive.vertices.position(i)));
    }
  }
}

QuantizedFrame FrameOfPositions::frame(double least_step) const {
  const Vec3d size = box_.size();
  if (!(step_ > 0.0) || !std::isfinite(std::max({size.x, size.y, size.z}))) return {};
  QuantizedFrame frame{box_.low, step_};
  const auto is_too_fine = [&] {
    const Vec3d reach = (box_.high - frame.origin) / frame.step;
    return frame.step < least_step || std::max({reach.x, reach.y, reach.z}) > kMostShort;
  };
  while (is_too_fine()) {
    frame.step *= 2.0;
    frame.origin = glm::floor(box_.low / frame.step) * frame.step;  // positions that meshes share are rounded alike
  }
  return frame;
}

QuantizedPositions quantize_positions(const format::MeshRecord& record, const run::DecodedCluster& vertices,
                                      const Vec3d& moved, double step) {
  constexpr std::size_t kPadded = 4;  // three shorts, and one that fills the stride
  const format::PositionGrid grid{record.grid.log2, record.grid.mantissa};
  std::vector<std::uint16_t> values(vertices.vertex_count * kPadded);
  QuantizedPositions out;
  for (std::uint32_t i = 0; i < vertices.vertex_count; ++i) {
    const Vec3d p = (moved + grid.decode(vertices.position(i))) / step;
    for (int axis = 0; axis < 3; ++axis) {
      const int value = static_cast<int>(std::clamp(std::floor(p[axis] + 0.5), 0.0, kMostShort));
      values[i * kPadded + static_cast<std::size_t>(axis)] = static_cast<std::uint16_t>(value);
      int& low = out.low[static_cast<std::size_t>(axis)];
      int& high = out.high[static_cast<std::size_t>(axis)];
      low = i == 0 ? value : std::min(low, value);
      high = i == 0 ? value : std::max(high, value);
    }
  }
  out.stream = {kUnsignedShort, false, kPadded * sizeof(std::uint16_t),
                bytes_of(std::span<const std::uint16_t>(values))};
  return out;
}

VertexStream pack_floats(std::span<const float> values, std::size_t per_element, int log2, Packing packing) {
  VertexStream stream{kFloat, false, per_element * sizeof(float), {}};
  if (packing.meshopt) {
    if (auto multiples = encode_multiples(values, log2)) {
      stream.bytes = std::move(*multiples);
      stream.filter = "EXPONENTIAL";
      return stream;
    }
  }
  stream.bytes = bytes_of(values);
  return stream;
}

VertexStream pack_normals(std::span<const Vec3f> normals, std::uint32_t scale, Packing packing) {
  if (!packing.quantize) {
    return {kFloat, false, sizeof(Vec3f), bytes_of(normals)};
  }
  int bits = 8;
  while (bits < 16 && (1U << static_cast<unsigned>(bits - 1)) - 1U < scale) ++bits;
  VertexStream stream{
      bits > 8 ? kShort : kByte, true, bits > 8 ? 4 * sizeof(std::int16_t) : 4 * sizeof(std::int8_t), {}};
  if (packing.meshopt) {
    // Of an octahedron too, but one that no reader turns back to the asset's own: the error is an eighth of its step.
    constexpr int kMoreBits = 3;
    bits = std::min(bits + kMoreBits, 16);
    stream = {kShort, true, 4 * sizeof(std::int16_t), encode_octahedral(normals, bits, 4 * sizeof(std::int16_t))};
    stream.filter = "OCTAHEDRAL";
    return stream;
  }
  std::vector<std::int16_t> values(normals.size() * 4);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      values[i * 4 + static_cast<std::size_t>(axis)] = to_signed(normals[i][axis], bits > 8 ? 32767.0F : 127.0F);
    }
  }
  if (bits > 8) {
    stream.bytes = bytes_of(std::span<const std::int16_t>(values));
  } else {
    const std::vector<std::int8_t> narrow(values.begin(), values.end());
    stream.bytes = bytes_of(std::span<const std::int8_t>(narrow));
  }
  return stream;
}

VertexStream pack_uvs(std::span<const Vec2f> uvs, int log2, Packing packing) {
  const auto is_within = [](const Vec2f& uv) { return uv.x >= 0.0F && uv.x <= 1.0F && uv.y >= 0.0F && uv.y <= 1.0F; };
  if (!packing.quantize || !std::all_of(uvs.begin(), uvs.end(), is_within)) {
    const float* values = uvs.empty() ? nullptr : &uvs.front().x;
    return pack_floats({values, uvs.size() * 2}, 2, log2, packing);
  }
  std::vector<std::uint16_t> values;
  values.reserve(uvs.size() * 2);
  for (const Vec2f& uv : uvs) {
    for (const float value : {uv.x, uv.y}) {
      values.push_back(static_cast<std::uint16_t>(std::floor(static_cast<double>(value) * kMostShort + 0.5)));
    }
  }
  return {kUnsignedShort, true, 2 * sizeof(std::uint16_t), bytes_of(std::span<const std::uint16_t>(values))};
}

}  // namespace meshlode::app
