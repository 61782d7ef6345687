// SPDX-License-Identifier: GPL-3.0-or-later
// Four floats side by side, as GCC and Clang offer them on every processor. No intrinsics: the bits are those of four
// scalar operations (I10). So they are in a function's clone for AVX2, whose instructions need fewer moves; FMA is not
// among them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

// The loader chooses the clone. Not under sanitizers, which are not ready when it does.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define MESHLODE_CLONED_FOR_AVX2 __attribute__((target_clones("avx2", "default")))
#else
#define MESHLODE_CLONED_FOR_AVX2
#endif

namespace meshlode::builder {

using Lanes = float __attribute__((vector_size(16)));
using LaneMask = std::int32_t __attribute__((vector_size(16)));

[[nodiscard]] inline Lanes lanes(float x) {
  return Lanes{x, x, x, x};
}

[[nodiscard]] inline Lanes load_lanes(const float* from) {
  Lanes value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

[[nodiscard]] inline LaneMask mask_lanes(std::int32_t x) {
  return LaneMask{x, x, x, x};
}
[[nodiscard]] inline LaneMask load_mask(const std::int32_t* from) {
  LaneMask value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

inline void store_lanes(Lanes value, float* to) {
  std::memcpy(to, &value, sizeof(value));
}

/// Lane by lane: a where the mask is set, else b.
[[nodiscard]] inline Lanes choose(LaneMask mask, Lanes a, Lanes b) {
  LaneMask bits_a, bits_b;
  std::memcpy(&bits_a, &a, sizeof(a));
  std::memcpy(&bits_b, &b, sizeof(b));
  const LaneMask bits = (mask & bits_a) | (~mask & bits_b);
  Lanes result;
  std::memcpy(&result, &bits, sizeof(bits));
  return result;
}

// Written as the processor's own instructions have it, the second where neither is less; GCC finds them in no other
// form.
[[nodiscard]] inline Lanes min_lanes(Lanes a, Lanes b) {
  return a < b ? a : b;
}
[[nodiscard]] inline Lanes max_lanes(Lanes a, Lanes b) {
  return a > b ? a : b;
}
[[nodiscard]] inline bool any_lane(LaneMask mask) {
  std::uint64_t halves[2];
  std::memcpy(halves, &mask, sizeof(mask));
  return (halves[0] | halves[1]) != 0;
}

/// How many of the lanes are set.
[[nodiscard]] inline std::size_t count_lanes(LaneMask mask) {
  std::uint64_t halves[2];
  std::memcpy(halves, &mask, sizeof(mask));
  return (halves[0] & 1U) + (halves[0] >> 63U) + (halves[1] & 1U) + (halves[1] >> 63U);
}
/// The first lane that is set. \pre one is
[[nodiscard]] inline std::uint32_t first_lane(LaneMask mask) {
  std::uint64_t halves[2];
  std::memcpy(halves, &mask, sizeof(mask));
  const std::uint64_t bits = (halves[0] & 1U) | (halves[0] >> 63U) << 1U | (halves[1] & 1U) << 2U | 8U;
  return static_cast<std::uint32_t>(std::countr_zero(bits));
}
/// The lanes one, two or three places on.
template <int Places, class Vector>
[[nodiscard]] inline Vector rotate_lanes(Vector vector) {
  return __builtin_shufflevector(vector, vector, Places, (Places + 1) % 4, (Places + 2) % 4, (Places + 3) % 4);
}
/// The least of all, in every lane.
[[nodiscard]] inline Lanes least_lane(Lanes a) {
  const Lanes two = min_lanes(a, rotate_lanes<1>(a));
  return min_lanes(two, rotate_lanes<2>(two));
}

}  // namespace meshlode::builder
