// SPDX-License-Identifier: GPL-3.0-or-later
// All that the bytes of an asset depend on, as text: its hash is the key of the cache, and two of them say what
// changed.
#pragma once

#include <span>
#include <string>

#include "app/batch/depend/dependencies.h"
#include "app/settings/settings.h"
#include "base/hash.h"
#include "builder/options.h"
#include "scene/import/import.h"

namespace meshlode::app {

/// The settings that change bytes, a line each. One that only refuses (memory, decoded bytes) is not among them.
[[nodiscard]] std::string settings_text(const builder::PipelineOptions& options, const scene::ImportOptions& import);

/// What the layers say of meshes by name, and, since a later layer wins, what they say of all; empty where no layer has
/// such a rule.
[[nodiscard]] std::string mesh_rules_text(std::span<const app::SettingLayer> layers);

/// `program`: find_program_id(). No path but the names that the scene itself has: a scene that moved, or lies on
/// another machine, has the same ingredients. \pre `files` are find_dependencies() of the scene
[[nodiscard]] std::string ingredients_text(const Hash128& program, const std::string& settings,
                                           std::span<const Dependency> files);

[[nodiscard]] Hash128 key_of(const std::string& ingredients);

/// What is different, in words: "codec is zstd, was none; image a.png changed". Empty where nothing is.
[[nodiscard]] std::string explain_change(const std::string& before, const std::string& now);

}  // namespace meshlode::app
