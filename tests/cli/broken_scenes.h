// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that are sound but for one fault each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace meshlode::test {

struct BrokenScene {
  std::string id;  ///< of the fault
  scene::Scene scene;
};

/// A sphere with smooth normals: nothing is wrong with it.
[[nodiscard]] scene::Scene sound_scene();

/// That scene, or one like it, broken in as many ways as a source can have faults: one scene for each id.
[[nodiscard]] std::vector<BrokenScene> broken_scenes();

/// A file of it: meshes, instances, images, and materials that sample the first image where they sample anything.
[[nodiscard]] std::vector<std::uint8_t> as_glb(const scene::Scene& scene);

}  // namespace meshlode::test
