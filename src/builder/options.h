// SPDX-License-Identifier: GPL-3.0-or-later
// The options of a build, of all its stages: structs alone. What they mean to each stage: stage_options.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/build.h>
#include <meshlode/format.h>

#include "builder/textures/texture_choice.h"

namespace meshlode::builder {

class ImageConverter;
class LookReader;
class MeshStore;
struct BuildHooks;

/// What may be set for each mesh by itself.
struct MeshOptions {
  format::ErrorTier error_tier = format::ErrorTier::kMeasured;  ///< as asked for, or the preset's (builder/preset.h)
  AttributeChoice attributes = AttributeChoice::kAuto;
  std::uint32_t keep = 0, drop = 0;  ///< attributes by name (plan/attributes.h); none is in both
  double grid_step = 0.0;            ///< 0: chosen from the budget; else this step in mesh units
  double position_error = 0.0;       ///< mesh units, the largest distance a vertex moves; 0: chosen, invisible
  double normal_error = 0.1;         ///< degrees, the largest angle between a stored normal and the source's
  double uv_error = 0.125;           ///< the largest move of a texture coordinate, in the unit below
  bool uv_error_is_texels = true;    ///< of the material's largest texture; else UV units
  bool uv_error_is_default = true;   ///< no texture counts as smaller than 2,048 texels then
  AggregateChoice aggregate = AggregateChoice::kMasked;
  std::string aggregate_names;  ///< of AggregateChoice::kNamed: globs of meshes and materials, comma by comma
  bool lock_borders = false;    ///< open borders keep every vertex in every cut (builder/prepare/open_border.h)

  bool operator==(const MeshOptions&) const = default;
};

constexpr std::uint32_t kUsualPageKib = 128, kFewestRootBytes = 16384;
constexpr std::uint32_t kUsualGroupClusters = 20, kFewestGroupClusters = 4, kMostGroupClusters = 32;

/// What is said once for all meshes.
struct SceneOptions {
  Preset preset = Preset::kDefault;
  format::Codec codec = format::Codec::kStrips;
  StripEffort strip_effort = StripEffort::kOfPreset;
  std::uint32_t partition_seed = 1;  ///< of METIS; benchmarks vary it, to tell a change from luck
  bool repair = false;               ///< the scene was imported with repair: recorded, because it changes the bytes
  bool linear_colors = false;        ///< the same of ImportOptions::linear_colors
  format::Promise promise = format::Promise::kPosition;  ///< what errors there are (src/builder/promise)
  bool keep_topology = false;                 ///< every cut of a manifold is one (builder/simplify/kept_topology.h)
  bool keep_layers = true;                    ///< gaps between layers are found and kept (builder/layers)
  std::uint32_t max_cluster_triangles = 128;  ///< I2; at most format::kMaxClusterTriangles
  std::uint32_t max_cluster_vertices = 256;   ///< I2; at most format::kMaxClusterVertices
  std::uint32_t group_clusters = kUsualGroupClusters;  ///< what groups aim at, kFewestGroupClusters to 32
  std::uint32_t page_kib = kUsualPageKib;              ///< largest page: 16, 32, 64 or 128
  PageOrder page_order = PageOrder::kLevel;
  std::uint32_t root_bytes = 0;     ///< limit of a mesh's first page, kFewestRootBytes to kMaxPageBytes; 0: as others
  bool page_hints = false;          ///< section PHNT is written
  std::uint64_t max_memory = 0;     ///< bytes that the process may take (builder/needs.h); 0: what the machine has
  MeshStore* mesh_store = nullptr;  ///< meshes that were built before (builder/store/mesh_store.h); the same bytes
  /// Images of materials, for aggregates (builder/aggregate/material_looks.h). None: textured meshes are no aggregates.
  const LookReader* looks = nullptr;
  TextureChoice textures;                  ///< what becomes of images
  const ImageConverter* images = nullptr;  ///< which does it (builder/textures/image_converter.h)
  const BuildHooks* hooks = nullptr;       ///< of a study (builder/hooks.h)
  /// One for each mesh of the scene, in the place of the whole's; empty: all as the whole.
  std::vector<MeshOptions> mesh_options;
};

constexpr bool is_page_size(std::uint32_t kib) {
  return kib == 16 || kib == 32 || kib == 64 || kib == 128;
}
constexpr bool is_root_size(std::uint32_t bytes) {
  return bytes == 0 || (bytes >= kFewestRootBytes && bytes <= format::kMaxPageBytes);
}

struct PipelineOptions : MeshOptions, SceneOptions {
  [[nodiscard]] const MeshOptions& of_mesh(std::size_t mesh) const {
    return mesh_options.empty() ? *this : mesh_options[mesh];
  }
};

}  // namespace meshlode::builder
