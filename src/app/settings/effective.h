// SPDX-License-Identifier: GPL-3.0-or-later
// What files and the command line together made of the settings of one scene, for manifests: typed as in meshlode.json
// (docs/schemas/settings.schema.json), with who said it.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "app/settings/settings.h"
#include "base/json_writer.h"
#include "scene/import/json.h"

namespace meshlode::app {

struct EffectiveSettings {
  std::array<SettledWord, kSettingCount> words;
  struct MeshRule {
    std::string from, glob;  ///< who said it, of which meshes
    SettingWords words;
  };
  std::vector<MeshRule> mesh_rules;  ///< in the order of the layers: a later one wins
};

/// A tier that the preset chooses is named.
[[nodiscard]] EffectiveSettings effective_settings(const Settled& settled, std::span<const SettingLayer> layers);

/// An object: `values`, all of them; `from`, of those that are not defaults; `mesh_rules`.
void write_effective(JsonWriter& json, const EffectiveSettings& settings);
/// The same read again. Error: kInvalid, `where` the place below the object.
[[nodiscard]] Result<EffectiveSettings> read_effective(const scene::Json& json);

}  // namespace meshlode::app
