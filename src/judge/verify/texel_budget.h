// SPDX-License-Identifier: GPL-3.0-or-later
// UV budgets in texels, held against the images of the source. Which images a material samples is what import recorded;
// how large they are and what a unit of coordinates crosses is found out anew. Internal to the judge.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "judge/validate/rules.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// Width and height that an image states. Nothing where its kind is not known. Safe on any bytes.
[[nodiscard]] std::optional<std::pair<std::uint32_t, std::uint32_t>> stated_image_size(
    std::span<const std::uint8_t> bytes);

/// The same of KTX2 and WebP alone, which stb_image does not know.
[[nodiscard]] std::optional<std::pair<std::uint32_t, std::uint32_t>> stated_container_size(
    std::span<const std::uint8_t> bytes);

/// For each TEXCOORD_n the most texels that one unit of it crosses in any texture that a material names; 0 where none
/// has a known size. One entry for each of Scene::materials.
[[nodiscard]] std::vector<std::array<double, scene::kMaxUvSets>> most_texels_of_materials(const scene::Scene& scene);
/// The same for the materials of a mesh together.
[[nodiscard]] std::array<double, scene::kMaxUvSets> most_texels(
    std::span<const std::array<double, scene::kMaxUvSets>> of_materials, const scene::SourceMesh& mesh);

/// For each stored UV set of the mesh: is one of its coordinates so large that a step half as wide could not hold it in
/// 24 bits? Then no step keeps a smaller budget. \pre `clusters` is decode_all of the asset
[[nodiscard]] std::array<bool, scene::kMaxUvSets> has_finest_step(const run::Asset& asset, MeshId mesh,
                                                                  std::span<const run::DecodedCluster> clusters);

/// V113 for UVs: half a step of each stored set is at most so many texels, or as fine as 24 bits hold the coordinates.
/// `texels_of_mesh`: one for each mesh of the asset; nothing where its budget is not in texels.
void check_texel_budget(const run::Asset& asset, const scene::Scene& source,
                        std::span<const std::optional<double>> texels_of_mesh,
                        std::span<const run::DecodedCluster> clusters, RuleLog& log);

}  // namespace meshlode::judge
