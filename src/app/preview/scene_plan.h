// SPDX-License-Identifier: GPL-3.0-or-later
// The plan of a whole scene without building it: what `meshlode plan` prints, and what `build --explain` says it does.
// The decisions are plan_mesh()'s, with the precision that the budgets lead to and an estimate of the bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/image_size.h"
#include "builder/options.h"
#include "builder/plan/plan.h"
#include "format/grid.h"
#include "scene/scene.h"

namespace meshlode::app {

struct PlannedAttribute {
  builder::PlanDecision decision;
  std::string precision;  ///< "within 0.1 degrees, at most 11 bits per coordinate"; empty of what is not stored
  /// Of all levels' decoded pages, estimated: what it takes, or what keeping it would add.
  double bytes = 0.0;
};

struct PlannedMesh {
  std::string label;  ///< mesh_label()
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  ///< as the file has them
  bool is_whole = false;       ///< one cluster holds all of it: there is nothing to coarsen
  builder::AttributeLayout layout;
  format::PositionGrid grid;
  std::vector<PlannedAttribute> attributes;  ///< POSITION, what is kept and what is left out
  double bytes = 0.0;                        ///< estimated, of the decoded pages with their topology
};

/// An image of the scene, and what --textures makes of its size: what its head says, for nothing is decoded. A build
/// keeps the size of one that is damaged behind it.
struct PlannedImage {
  std::string name, mime_type;
  std::uint32_t source_index = 0;
  std::uint64_t bytes = 0;
  std::optional<ImageSize> size, stored_size;                ///< nothing: not known
  std::optional<std::uint64_t> gpu_bytes, stored_gpu_bytes;  ///< find_gpu_bytes()
};

struct ScenePlan {
  std::vector<PlannedMesh> meshes;
  std::vector<PlannedImage> images;
  std::vector<builder::PlanDecision>
      features;  ///< list_features(), and which meshes are aggregates where that was asked
};

/// Errors: those of a build that are known before any work: kUnsupported where a grid needs more than 24 bits
/// or an extent is more or less than the format holds, kInvalid where a position is not finite.
[[nodiscard]] Result<ScenePlan> plan_scene(const scene::Scene& scene, const builder::PipelineOptions& options);

}  // namespace meshlode::app
