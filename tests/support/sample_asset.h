// SPDX-License-Identifier: GPL-3.0-or-later
// A small scene and its asset: the sample meshes, five instances, two materials and two blobs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/format.h>

#include "builder/encode/encode.h"
#include "builder/write/write.h"
#include "scene/scene.h"
#include "support/reseal.h"
#include "support/sample_mesh.h"

namespace meshlode::test {

/// Meshes 0 patch, 1 sphere, 2 tetrahedron, 3 empty (no triangles). Instances: each once, the sphere once more mirrored
/// and scaled, once more flattened to nothing (singular). Sources of the meshes are filled, so that verify can run.
[[nodiscard]] scene::Scene sample_scene();

/// The asset of sample_scene(). Aborts the test program where it cannot be made.
[[nodiscard]] std::vector<std::uint8_t> sample_asset_bytes(format::Codec codec = format::Codec::kNone);
/// The same for another scene of the same meshes.
[[nodiscard]] std::vector<std::uint8_t> sample_asset_bytes(const scene::Scene& scene, format::Codec codec);
/// The asset of sample_scene() with all sections that are optional: promises of texels and appearance, and page hints.
[[nodiscard]] std::vector<std::uint8_t> promised_asset_bytes(format::Codec codec = format::Codec::kNone);
/// The asset of these, with any codec: of those that are not written any more too. Aborts where it cannot be made.
[[nodiscard]] std::vector<std::uint8_t> write_by(builder::WriteInput input, format::Codec codec);
/// Page hints, and promises of texels and appearance, for what is about to be written: with the groups' own errors,
/// which are sound.
void add_promises(builder::WriteInput& input);

/// An asset with one instance of one mesh; materials are those of sample_scene().
[[nodiscard]] std::vector<std::uint8_t> asset_bytes_of(const SampleMesh& sample,
                                                       format::Codec codec = format::Codec::kNone,
                                                       const builder::EncodeOptions& options = {});

}  // namespace meshlode::test
