// SPDX-License-Identifier: GPL-3.0-or-later
// What the alpha test of one triangle reads (alpha_test.h).
#pragma once

#include <array>
#include <cstdint>

namespace meshlode::draw {
struct AlphaImage;
struct AlphaMask;
}  // namespace meshlode::draw

namespace meshlode::draw {

struct MaskedTriangle {
  std::array<double, 3> x{}, y{}, w{};  ///< clip coordinates of the corners, in the order of the cluster
  std::array<std::int32_t, 3> u{}, v{};
  std::array<std::uint8_t, 3> alpha{255, 255, 255};  ///< of the vertex colours
  std::int32_t uv_log2 = 0;
  const AlphaMask* mask = nullptr;
  const AlphaImage* image = nullptr;  ///< null: every texel is opaque
};

}  // namespace meshlode::draw
