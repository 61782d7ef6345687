// SPDX-License-Identifier: GPL-3.0-or-later
// What `meshlode extract` takes out of an asset: per mesh one cut, or the levels of a discrete LOD chain.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/ids.h"
#include "bounds_options.h"
#include "camera_options.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::cli {

struct CutRequest {
  // Exactly one of these, or a camera.
  std::optional<double> error;
  std::optional<std::uint32_t> level;
  std::optional<std::uint64_t> triangles;  ///< budget of all chosen meshes together
  std::optional<std::uint32_t> lods;       ///< a chain of this many levels, each half of the one before
  std::optional<std::string> lod_errors;   ///< a chain by errors, rising
  std::optional<std::string> lod_ratios;   ///< a chain by shares of each mesh's finest cut, falling
  bool is_relative = false;
  bool is_world = false;
  std::string by = name_in(run::kCutErrorNames, run::CutError::kSelection);
  BoundsOptions bounds;  ///< beside --error, --lod-errors or a camera
  CameraOptions camera;  ///< its size and pixel error serve the coverage values of a chain too
  [[nodiscard]] bool has_camera() const { return camera.camera || camera.ortho_height; }
  [[nodiscard]] bool has_way() const { return error || level || triangles || is_chain() || has_camera(); }
  [[nodiscard]] bool is_chain() const { return lods || lod_errors || lod_ratios; }
};

struct CutLevel {
  run::UniformCut cut;
  std::optional<double> asked;  ///< error in mesh units; nothing where none was asked for
  std::uint64_t triangles = 0;
  double screen_coverage = 0.0;  ///< of a chain: the level is meant down to this share of the picture's height
};

struct MeshCuts {
  MeshId mesh;
  std::vector<CutLevel> levels;  ///< the finest first; none for a mesh that is not chosen
};

/// Whether the options fit together. Errors: kUsage.
[[nodiscard]] Status check_request(const CutRequest& request);

/// One entry per mesh of the asset. Errors: kUsage for a camera or list that makes no sense; kCheckFailed where even
/// the coarsest cuts have more triangles than the budget.
[[nodiscard]] Result<std::vector<MeshCuts>> choose_cuts(const CutRequest& request, const run::Asset& asset,
                                                        const std::vector<bool>& chosen);

}  // namespace meshlode::cli
