// SPDX-License-Identifier: GPL-3.0-or-later
// The settings of a build as words, from several places: which there are, what each may say, and what they mean
// together. A later place wins over an earlier one; the command line is the last.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <meshlode/result.h>

#include "builder/options.h"

namespace meshlode::scene {
struct Scene;
}

namespace meshlode::app {

/// Everything that changes the bytes of an asset. The order is that of the help.
enum class Setting : std::uint8_t {
  kFor,
  kErrorTier,
  kPreset,
  kAttributes,
  kKeep,
  kDrop,
  kGrid,
  kPositionError,
  kNormalError,
  kUvError,
  kCodec,
  kStripEffort,
  kClusterTriangles,
  kGroupClusters,
  kRepair,
  kLinearColors,
  kKeepTopology,
  kLockBorders,
  kAggregate,
  kPromise,
  kKeepLayers,
  kPageSize,
  kPageOrder,
  kRootBytes,
  kPageHints,
  kTextures,
};
constexpr std::size_t kSettingCount = 26;

struct SettingInfo {
  Setting setting;
  const char* name;   ///< of the long option, without its dashes
  const char* value;  ///< " N": what the help calls its value; empty: by its choices, or a flag
  const char* group;  ///< of the help
  const char* help;   ///< meaning, unit, range
  const char* usual;  ///< the default
  bool is_of_mesh;    ///< each mesh may have its own
};
[[nodiscard]] std::span<const SettingInfo, kSettingCount> all_settings();
[[nodiscard]] const SettingInfo& info_of(Setting setting);
/// True or false: on the command line its name alone says true.
[[nodiscard]] bool is_flag(Setting setting);
/// Names between commas.
[[nodiscard]] bool is_list(Setting setting);
[[nodiscard]] std::optional<Setting> setting_of(std::string_view name);
/// Whether a file may say it as a number: where there are no choices, and where these are numbers.
[[nodiscard]] bool takes_number(Setting setting);
/// The words that a setting may be; none where it is a number.
[[nodiscard]] std::vector<std::string> choices_of(Setting setting);

/// Why a word is none of this setting; empty where it is one.
[[nodiscard]] std::string find_fault(Setting setting, std::string_view word);

using SettingWords = std::array<std::optional<std::string>, kSettingCount>;

/// What one place says.
struct SettingLayer {
  std::string from;                    ///< "the command line", or a file
  ErrorCode code = ErrorCode::kUsage;  ///< of what is wrong here
  SettingWords words;
  struct MeshRule {
    std::string glob;    ///< of the names of meshes: base/glob.h
    SettingWords words;  ///< of those that a mesh may have
  };
  std::vector<MeshRule> mesh_rules;  ///< after `words`; a later one wins over an earlier one

  [[nodiscard]] std::optional<std::string>& operator[](Setting setting) {
    return words[static_cast<std::size_t>(setting)];
  }
};

constexpr const char* kDefaultPlace = "default";
/// A setting's word, and who said it.
struct SettledWord {
  std::string word;
  std::string from;  ///< kDefaultPlace, or a layer's
};

struct Settled {
  builder::PipelineOptions options;
  std::array<SettledWord, kSettingCount> words;

  [[nodiscard]] const SettledWord& operator[](Setting setting) const {
    return words[static_cast<std::size_t>(setting)];
  }
};

/// What the setting `for` decided, in a line: "for engine: codec none"; empty where it says `any`.
[[nodiscard]] std::string describe_use(const Settled& settled);

/// All layers together, for the scene as a whole. What the last `for` of the layers means lies below every word that is
/// given. Errors: a layer's code, with its place, for a word that is none and
/// for two that exclude each other in one layer (a grid and a position error, a name kept and dropped); across layers
/// the later one wins. A layer that says `attributes` does away with the names of earlier ones.
[[nodiscard]] Result<Settled> settle(std::span<const SettingLayer> layers);

/// What a mesh has for itself, in the place of the whole's.
struct SettledMesh {
  builder::MeshOptions options;
  std::vector<std::pair<Setting, SettledWord>> own;  ///< the words that differ from the whole's
};

[[nodiscard]] std::vector<std::string> names_of_meshes(const scene::Scene& scene);

/// The same for each mesh by its name: a layer's own words, then its rules that match, then the next layer. Empty where
/// no rule matches any.
[[nodiscard]] Result<std::vector<SettledMesh>> settle_meshes(std::span<const SettingLayer> layers,
                                                             std::span<const std::string> mesh_names);

/// The options of a build of these meshes. Errors: as settle().
[[nodiscard]] Status set_mesh_options(std::span<const SettingLayer> layers, std::span<const std::string> mesh_names,
                                      builder::PipelineOptions& options);

}  // namespace meshlode::app
