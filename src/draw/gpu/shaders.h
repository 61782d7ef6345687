// SPDX-License-Identifier: GPL-3.0-or-later
// The SPIR-V that was built from shaders/, by the names that src/draw/CMakeLists.txt gives it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace meshlode::draw {

struct Shader {
  std::string_view name;  ///< "raster.comp"; "raster_mask.comp" with the alpha test of masked materials
  std::span<const std::uint32_t> words;
};
[[nodiscard]] std::span<const Shader> all_shaders();
/// \pre it is one of all_shaders()
[[nodiscard]] std::span<const std::uint32_t> find_shader(std::string_view name);

}  // namespace meshlode::draw
