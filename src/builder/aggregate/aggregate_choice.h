// SPDX-License-Identifier: GPL-3.0-or-later
// Which meshes, or which parts of them, are aggregates: many small loose pieces that are seen together, not one by one.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/build.h>

#include "base/enum_names.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// What a setting may say but for names.
inline constexpr std::array<EnumName<AggregateChoice>, 4> kAggregateChoiceNames{{{AggregateChoice::kMasked, "masked"},
                                                                                 {AggregateChoice::kNever, "never"},
                                                                                 {AggregateChoice::kAuto, "auto"},
                                                                                 {AggregateChoice::kAlways, "always"}}};

/// The setting's word: "auto", or the names.
template <class Options>
[[nodiscard]] std::string aggregate_word(const Options& options) {
  return options.aggregate == AggregateChoice::kNamed ? options.aggregate_names
                                                      : name_in(kAggregateChoiceNames, options.aggregate);
}

struct AggregateQuestion {
  AggregateChoice choice = AggregateChoice::kNever;
  std::string_view names = {};  ///< kNamed: globs of meshes and materials, comma by comma
  bool keep_topology = false;
  bool lock_borders = false;
  std::span<const scene::SceneMaterial> materials = {};  ///< of the scene; none where nobody asks for them
};

struct AggregateDecision {
  bool is_aggregate = false;  ///< all of it, or a part
  std::string reason;         ///< "8,000 pieces of 2 triangles"; empty where nobody asked
  /// By material of the scene, as far as the mesh has any: how many triangles a piece of it has at most that is thinned
  /// out, 0 where none is. Empty where all of the mesh is an aggregate, or nothing.
  std::vector<std::uint32_t> most_triangles;
};

/// kAuto: at least 256 pieces, nearly all triangles in pieces of at most 32, and pieces small beside the mesh. Where
/// that does not hold for the mesh it may for a part of it: all pieces of a material (of several where a piece has
/// several), or those of at most 32 triangles, if they are at least half of these. kMasked: the same of the materials
/// with an alpha mask, where no piece has another one too; nothing is said of a mesh without such a material. kAlways:
/// all pieces of at most 512 triangles: a larger one is never one of many cards. kNamed: the same where the mesh has
/// one of the names, else its pieces of the materials that have. Where topology is kept or borders are locked each
/// piece stays, and one with a mask in a mesh whose texture coordinates are so large that no float of them, and nothing
/// that is stored, is a texel any more. O(n log n).
[[nodiscard]] AggregateDecision decide_aggregate(const scene::SourceMesh& mesh, const AggregateQuestion& question);

/// Pieces of these materials (`is_out`, by the scene's id) stay as they are: what is left of a decision, or the reason
/// why nothing is.
void leave_out(const scene::SourceMesh& mesh, std::span<const std::uint8_t> is_out, const std::string& reason,
               AggregateDecision& decision);

/// Which materials an aggregate's pieces may have, by the scene's id, into `is_used`. Nothing of one that is none.
void add_materials(const scene::SourceMesh& mesh, const AggregateDecision& decision,
                   std::vector<std::uint8_t>& is_used);

/// Of names, comma by comma, those that no mesh and no material of the scene has.
[[nodiscard]] std::vector<std::string> find_unknown_names(const scene::Scene& scene, std::string_view names);

}  // namespace meshlode::builder
