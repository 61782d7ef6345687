// SPDX-License-Identifier: GPL-3.0-or-later
// Presets: one word for a point on the curve of build time against triangles at equal deviation against bytes. All that
// a preset sets stands in this table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <meshlode/build.h>
#include <meshlode/format.h>

#include "base/enum_names.h"

namespace meshlode::builder {

inline constexpr std::array<EnumName<Preset>, 3> kPresetNames{
    {{Preset::kFast, "fast"}, {Preset::kDefault, "default"}, {Preset::kBest, "best"}}};
constexpr const char* name_of(Preset preset) {
  return name_in(kPresetNames, preset);
}

inline constexpr std::array<EnumName<StripEffort>, 4> kStripEffortNames{{{StripEffort::kOfPreset, "auto"},
                                                                         {StripEffort::kFast, "fast"},
                                                                         {StripEffort::kDefault, "default"},
                                                                         {StripEffort::kBest, "best"}}};
constexpr const char* name_of(StripEffort effort) {
  return name_in(kStripEffortNames, effort);
}

inline constexpr std::array<EnumName<PageOrder>, 2> kPageOrderNames{
    {{PageOrder::kLevel, "level"}, {PageOrder::kCovisible, "covisible"}}};
constexpr const char* name_of(PageOrder order) {
  return name_in(kPageOrderNames, order);
}

struct PresetSettings {
  format::ErrorTier error_tier;      ///< where the caller asks for none
  std::uint32_t strip_trials;        ///< EncodeOptions::strip_trials: fewer bytes for time
  std::uint32_t mixed_strip_trials;  ///< EncodeOptions::mixed_strip_trials
  /// Of meshes of so many triangles and more METIS cuts quads of triangles (ClusterCaps::merge_triangles): time for a
  /// little of the partition's quality.
  std::uint64_t merged_from;
};

/// Below so many triangles a build is quick anyway, and any other partition moves the coarse cuts of a mesh by some
/// hundredths, up or down: luck that small meshes should not draw anew for speed.
inline constexpr std::uint64_t kLargeMesh = 262144;
inline constexpr std::uint64_t kNoMesh = ~std::uint64_t{0};

/// In the order of Preset.
inline constexpr std::array<PresetSettings, 3> kPresetSettings{{
    {format::ErrorTier::kQem, 1, 4, 0},
    {format::ErrorTier::kMeasured, 8, 128, kLargeMesh},
    {format::ErrorTier::kMeasured, 48, 192, kNoMesh},
}};

/// \pre one of the enumerators
constexpr const PresetSettings& settings_of(Preset preset) {
  return kPresetSettings[static_cast<std::size_t>(preset)];
}

/// Whose trials of strips.
constexpr const PresetSettings& settings_of(StripEffort effort, Preset preset) {
  switch (effort) {
    case StripEffort::kFast: return settings_of(Preset::kFast);
    case StripEffort::kDefault: return settings_of(Preset::kDefault);
    case StripEffort::kBest: return settings_of(Preset::kBest);
    case StripEffort::kOfPreset: break;
  }
  return settings_of(preset);
}

}  // namespace meshlode::builder
