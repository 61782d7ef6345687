// SPDX-License-Identifier: GPL-3.0-or-later
// What the pixels of materials show, as whoever asks for a build sees them: the build itself decodes no image.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/vec.h"
#include "builder/aggregate/alpha_test.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Of one material.
struct MaterialLook {
  AlphaTest covers;
  std::uint32_t uv_set = 0;  ///< TEXCOORD_n that it is asked with
  Vec3f color{1.0F};         ///< linear, the mean of what is drawn
};

class LookReader {
 public:
  virtual ~LookReader() = default;
  /// One for each of the scene's materials; nothing for those that are not `wanted`, and for those whose image cannot
  /// be read. Safe from one thread at a time.
  [[nodiscard]] virtual std::vector<std::optional<MaterialLook>> read(const scene::Scene& scene,
                                                                      std::span<const std::uint8_t> wanted) const = 0;
};

}  // namespace meshlode::builder
