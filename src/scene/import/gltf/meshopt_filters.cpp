// SPDX-License-Identifier: GPL-3.0-or-later
// The filters of EXT_meshopt_compression, as the formulas of its specification. The library's own are not used: for
// octahedral vectors of 8 bits it takes the processor's estimate of 1 / sqrt, which differs between makers of
// processors, and with it the asset's bytes would (I10). Only operations that IEEE 754 defines exactly are used here.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "scene/import/gltf/meshopt_decode.h"

namespace meshlode::scene {

namespace {

/// To the nearest, halves away from zero. \pre |value| < 2^31
template <class T>
T rounded(float value) {
  return static_cast<T>(static_cast<std::int32_t>(value + (value >= 0.0F ? 0.5F : -0.5F)));
}

/// x, y on the octahedron and the length 1 in the same unit → x, y, z of a unit vector in all bits of T. The fourth
/// component stays as it is.
template <class T>
void undo_octahedral(std::uint8_t* element, float one) {
  T v[4];
  std::memcpy(v, element, sizeof v);
  auto x = static_cast<float>(v[0]);
  auto y = static_cast<float>(v[1]);
  const float z = static_cast<float>(v[2]) - std::fabs(x) - std::fabs(y);
  const float fold = std::min(z, 0.0F);  // of the lower half
  x += x >= 0.0F ? fold : -fold;
  y += y >= 0.0F ? fold : -fold;
  const float length = std::sqrt(x * x + y * y + z * z);
  if (length > 0.0F) {
    const float s = one / length;
    v[0] = rounded<T>(x * s);
    v[1] = rounded<T>(y * s);
    v[2] = rounded<T>(z * s);
  } else {
    v[2] = 0;  // a vector of no length; x and y are zero then
  }
  std::memcpy(element, v, sizeof v);
}

/// Three components of a unit quaternion, the largest left out; the fourth value says which, and what stands for
/// 1 / sqrt(2).
void undo_quaternion(std::uint8_t* element) {
  std::int16_t v[4];
  std::memcpy(v, element, sizeof v);
  const float one = 1.0F / std::sqrt(2.0F);
  const float unit = one / static_cast<float>(v[3] | 3);
  const float x = static_cast<float>(v[0]) * unit;
  const float y = static_cast<float>(v[1]) * unit;
  const float z = static_cast<float>(v[2]) * unit;
  const float w = std::sqrt(std::max(1.0F - x * x - y * y - z * z, 0.0F));
  const unsigned largest = static_cast<unsigned>(v[3]) & 3U;
  constexpr float kMax = 32767.0F;
  v[(largest + 1) & 3U] = rounded<std::int16_t>(x * kMax);
  v[(largest + 2) & 3U] = rounded<std::int16_t>(y * kMax);
  v[(largest + 3) & 3U] = rounded<std::int16_t>(z * kMax);
  v[largest] = rounded<std::int16_t>(w * kMax);
  std::memcpy(element, v, sizeof v);
}

/// 8 bits of exponent and 24 of mantissa, both signed → a float. Exponents that no float has give infinities, which
/// are refused where they are used.
void undo_exponential(std::uint8_t* element) {
  std::uint32_t word;
  std::memcpy(&word, element, sizeof word);
  const auto mantissa = static_cast<std::int32_t>(word << 8U) >> 8;
  const std::int32_t exponent = static_cast<std::int32_t>(word) >> 24;
  const std::uint32_t power_bits = static_cast<std::uint32_t>(exponent + 127) << 23U;
  float power;
  std::memcpy(&power, &power_bits, sizeof power);
  const float value = power * static_cast<float>(mantissa);
  std::memcpy(element, &value, sizeof value);
}

}  // namespace

void undo_meshopt_filter(const MeshoptLayout& layout, std::span<std::uint8_t> elements) {
  if (layout.filter == MeshoptFilter::kNone) return;
  const std::size_t step = layout.filter == MeshoptFilter::kExponential ? 4 : layout.stride;
  for (std::size_t at = 0; at + step <= elements.size(); at += step) {
    std::uint8_t* element = elements.data() + at;
    if (layout.filter == MeshoptFilter::kExponential) {
      undo_exponential(element);
    } else if (layout.filter == MeshoptFilter::kQuaternion) {
      undo_quaternion(element);
    } else if (layout.stride == 4) {
      undo_octahedral<std::int8_t>(element, 127.0F);
    } else {
      undo_octahedral<std::int16_t>(element, 32767.0F);
    }
  }
}

}  // namespace meshlode::scene
