// SPDX-License-Identifier: GPL-3.0-or-later
// Verify: the asset against its source. Shares no code with what built the asset.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "judge/pictures/id_judge.h"
#include "judge/validate/validate.h"
#include "judge/verify/deviations.h"
#include "judge/verify/resident_cuts.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// Places that V211 looks from, each at the whole and closer: two pictures of three cuts.
constexpr std::uint32_t kIdCameras = 6;

struct VerifyOptions {
  /// Structure, border proof, what surrounds the geometry, and one measured cut of each mesh, in the middle of its
  /// errors. Triangles are not looked for, no other cut and no camera is looked at, and the counts below are not asked.
  bool is_quick = false;
  std::uint32_t uniform_cuts = 300;  ///< cuts per mesh that cross-check I6
  std::uint32_t cameras = 100;       ///< cameras that cross-check I5, I6 and I8; up to kIdCameras draw for V211
  /// Uniform cuts per mesh that are measured for I7, where the tier promises it; kAllCuts (deviations.h): each.
  std::uint32_t deviation_cuts = 12;
  /// Splits for each triangle of the source and of such a cut, in all, after which what is open is called undecided.
  std::uint32_t deviation_budget = kDeviationBudget;
  /// Area-uniform samples each way of such a cut, beside all vertices, for what is promised besides positions.
  std::uint64_t deviation_samples = 200000;
  /// Random residencies of pages that selection is tried with (V212); 0: none.
  std::uint32_t residencies = 0;
  std::uint64_t seed = 1;
  /// The source's file as it lies there, for what its size says of it. Empty: that is not looked at.
  std::span<const std::uint8_t> source_bytes = {};
};

struct VerifyReport {
  std::vector<Finding> findings;
  std::uint64_t finding_count = 0;
  struct Check {
    std::string invariant;    ///< "I1"
    std::string what;         ///< one line: what was checked
    std::uint64_t items = 0;  ///< how many groups, cuts, triangles …
    std::uint64_t failures = 0;
    bool skipped = false;  ///< with the reason in `what`: I7 in the qem tier, I1 in a quick look
  };
  std::vector<Check> checks;
  /// Edges of more than two triangles, by docs/reference/rules.md; nothing where no cut was looked at.
  struct CrowdedEdges {
    std::uint64_t cuts = 0;       ///< looked at
    std::uint64_t level0 = 0;     ///< summed over meshes
    std::uint64_t most = 0;       ///< of each mesh's cut that has most, summed
    bool keeps_topology = false;  ///< as the asset says: no cut may have more than level 0 then (V207)
  };
  std::optional<CrowdedEdges> crowded_edges;
  std::vector<CutBracket> brackets;  ///< V206
  std::optional<IdTotals> surfaces;  ///< V211, by the CPU; nothing where no picture was drawn
  struct Streaming {
    ResidentTotals residencies;
    ShownErrors errors;
  };
  std::optional<Streaming> streaming;  ///< V212; nothing where no residency was tried
  /// What is promised besides positions, measured (V209); one for each promise that the asset has.
  struct PromisedCuts {
    std::string promise;         ///< "texels"
    std::uint64_t cuts = 0;      ///< measured
    std::uint64_t exceeded = 0;  ///< farther from the source than they store, by however little
    double median = 0.0;         ///< of true over stored
    double largest = 0.0;        ///< of true over stored; infinite where a cut stores 0 and is not there
  };
  std::vector<PromisedCuts> promises;
};

[[nodiscard]] VerifyReport verify_asset(const run::Asset& asset, const scene::Scene& source,
                                        const VerifyOptions& options);
/// Structure and V212, which need no source.
[[nodiscard]] VerifyReport verify_streaming(const run::Asset& asset, const VerifyOptions& options);

}  // namespace meshlode::judge
