// SPDX-License-Identifier: GPL-3.0-or-later
// Which meshes are aggregates: many small loose pieces that are seen together, not one by one.
#pragma once

#include <string>

#include <meshlode/build.h>

#include "base/enum_names.h"
#include "scene/scene.h"

namespace meshlode::build {

inline constexpr std::array<EnumName<AggregateChoice>, 3> kAggregateChoiceNames{
    {{AggregateChoice::kNever, "never"}, {AggregateChoice::kAuto, "auto"}, {AggregateChoice::kAlways, "always"}}};
constexpr const char* name_of(AggregateChoice choice) {
  return name_in(kAggregateChoiceNames, choice);
}

struct AggregateDecision {
  bool is_aggregate = false;
  std::string reason;  ///< "8,000 pieces of 2 triangles"; empty where nobody asked
};

/// kAuto: at least 256 pieces, nearly all triangles in pieces of at most 32, and pieces small beside the mesh. A piece
/// of more than 512 triangles is never one of many cards, and where topology is kept each piece stays. O(n log n).
[[nodiscard]] AggregateDecision decide_aggregate(const scene::SourceMesh& mesh, AggregateChoice choice,
                                                 bool keep_topology = false);

}  // namespace meshlode::build
