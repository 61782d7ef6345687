// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that the export tests build, and what the asset itself says about a cut.
#pragma once

#include <vector>

#include "glb_reader.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "scene/scene.h"

namespace meshlode::test {

/// Builds a scene, or fails the test and returns an empty asset's bytes.
[[nodiscard]] std::vector<std::uint8_t> build_bytes(const scene::Scene& scene, double grid_step = 0.0);
/// A rock with normals, UV seams and three materials (the last the default one), in a scene with a document.
[[nodiscard]] scene::Scene make_rock_scene(std::uint32_t n = 20);
/// The triangles of a cut in exact grid positions, origin included, as triangles_of gives them.
[[nodiscard]] std::vector<PlacedTriangle> expected_triangles(const run::Asset& asset, MeshId mesh,
                                                             const std::vector<ClusterId>& cut);
/// The finest cut of each mesh.
[[nodiscard]] std::vector<std::vector<ClusterId>> finest_cuts(const run::Asset& asset);

}  // namespace meshlode::test
