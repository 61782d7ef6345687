// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/shaders.h"

#include <algorithm>
#include <cassert>

namespace meshlode::draw {

#include "shaders.inc"  // kShaders: name and words of each

std::span<const Shader> all_shaders() {
  return kShaders;
}

std::span<const std::uint32_t> find_shader(std::string_view name) {
  const Shader* found =
      std::find_if(std::begin(kShaders), std::end(kShaders), [&](const Shader& s) { return s.name == name; });
  assert(found != std::end(kShaders));
  return found->words;
}

}  // namespace meshlode::draw
