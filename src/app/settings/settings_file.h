// SPDX-License-Identifier: GPL-3.0-or-later
// meshlode.json: settings that lie beside a scene, or in a folder above it (docs/reference/settings.md). Its text is
// hostile.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/settings/settings.h"
#include "base/file.h"
#include "scene/import/json.h"

namespace meshlode::app {

inline constexpr const char* kSettingsFileName = "meshlode.json";

/// The word that a value stands for; nothing where it is of another type.
[[nodiscard]] std::optional<std::string> word_of_value(Setting setting, const scene::Json& value);

/// An object: settings under the names of build's long options, and "meshes", an object of globs with what these have
/// for themselves. `from` names the file. Errors: kInvalid with the path inside the document, for a key with the
/// nearest that there is.
[[nodiscard]] Result<SettingLayer> parse_settings(std::string_view text, const std::string& from);

/// The files of the folders from `root` down to the scene's own, outermost first; where `root` is no folder above the
/// scene, the one beside the scene alone. Folders without one are passed over. Each file that was opened is added to
/// `files_read`. Errors: kIo for one that is there and cannot be read; those of parse_settings().
[[nodiscard]] Result<std::vector<SettingLayer>> read_settings_files(const std::filesystem::path& scene,
                                                                    const std::filesystem::path& root,
                                                                    std::vector<FileId>& files_read);

}  // namespace meshlode::app
