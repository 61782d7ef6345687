// SPDX-License-Identifier: GPL-3.0-or-later
// Cross-checks by cuts (V2…): what the group proofs promise is looked at once more on whole cuts. Internal to the
// judge.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/ids.h"
#include "judge/validate/borders.h"
#include "judge/validate/rules.h"
#include "judge/validate/surface.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// What is judged, so that a test may put something wrong in its place.
struct Selectors {
  std::function<std::vector<run::ClusterInstance>(const run::Asset&, const run::Camera&, double)> flat =
      [](const run::Asset& asset, const run::Camera& camera, double pixel_error) {
        return run::select_flat(asset, camera, pixel_error);
      };
  std::function<std::vector<run::ClusterInstance>(const run::Asset&, const run::Camera&, double)> bvh =
      [](const run::Asset& asset, const run::Camera& camera, double pixel_error) {
        return run::select_bvh(asset, camera, pixel_error);
      };
  std::function<run::UniformCut(const run::Asset&, MeshId, double)> uniform =
      [](const run::Asset& asset, MeshId mesh, double error) { return run::select_uniform(asset, mesh, error); };
};

/// Everything about one mesh that cuts are judged by.
struct MeshJudge {
  MeshSurface surface;
  BorderSet border;
  std::vector<std::uint32_t> group_order;  ///< groups of the mesh from fine to coarse (indices within the mesh)
};

[[nodiscard]] MeshJudge make_mesh_judge(const run::Asset& asset, MeshId mesh,
                                        std::span<const run::DecodedCluster> clusters);

/// The first fault of one cut of one mesh; all empty if there is none.
struct CutFaults {
  std::string coverage;  ///< V201
  std::string border;    ///< V202
  std::string rule;      ///< V204
  std::string error;     ///< V205
};

/// `drawn` has one entry per cluster of the mesh.
/// Coverage: on every path from a level-0 cluster to a root exactly one cluster is drawn. With `least` and `most` the
/// fewest and most drawn on any path up to a cluster, both must be 1 at every root.
[[nodiscard]] std::string find_coverage_fault(const run::Asset& asset, const MeshJudge& judge,
                                              std::span<const std::uint8_t> drawn);
/// Border: the chain of the cut has only edges that the source's border allows.
[[nodiscard]] std::string find_border_fault(const MeshJudge& judge, std::span<const std::uint8_t> drawn);

/// The errors of a mesh's groups that are not infinite, rising, each once: where its uniform cuts change.
[[nodiscard]] std::vector<float> finite_group_errors(const run::Asset& asset, const MeshSurface& surface);

struct CutTotals {
  std::uint64_t cuts = 0;       ///< judged
  std::uint64_t open_cuts = 0;  ///< of meshes whose source is open
};

/// `count` uniform cuts of one mesh: at 0, at exact group errors, just below them, and spread logarithmically.
CutTotals check_uniform_cuts(const run::Asset& asset, const MeshJudge& judge, std::uint32_t count, RuleLog& log,
                             const Selectors& selectors = {});

struct CameraTotals {
  std::uint64_t cameras = 0;
  std::uint64_t cuts = 0;       ///< of instances
  std::uint64_t decisions = 0;  ///< of groups, repeated in double precision
  std::uint64_t too_close = 0;  ///< within rounding of the threshold: either answer is right
};

/// `count` random cameras: inside, near, far and orthographic. `judges` has one entry per mesh.
CameraTotals check_cameras(const run::Asset& asset, std::span<const MeshJudge> judges, std::uint32_t count,
                           std::uint64_t seed, RuleLog& log, const Selectors& selectors = {});

struct CrowdedTotals {
  std::uint64_t cuts = 0;       ///< counted, level 0 among them
  std::uint64_t of_source = 0;  ///< edges of more than two triangles at level 0, summed over meshes
  std::uint64_t of_cuts = 0;    ///< the same of each mesh's cut that has most
};

/// Adds the edges of more than two triangles of level 0 and of `count` uniform cuts of one mesh, evenly by the rank of
/// their errors. They are told, and nothing is wrong with them (docs/reference/rules.md) unless the mesh
/// `keeps_topology`: a cut that has more than level 0 fails then (V207).
void count_crowded_cuts(const run::Asset& asset, const MeshSurface& surface, std::uint32_t count, bool keeps_topology,
                        CrowdedTotals& totals, RuleLog& log);

}  // namespace meshlode::judge
