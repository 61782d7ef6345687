// SPDX-License-Identifier: GPL-3.0-or-later
// A plan in words: the lines that `plan` and every `--explain` print, and the same as JSON.
#pragma once

#include <string>

#include "app/preview/scene_plan.h"
#include "base/json_writer.h"

namespace meshlode::app {

/// Attributes mesh by mesh, then features; of very many meshes the first, and how many more there are.
[[nodiscard]] std::string describe_plan(const ScenePlan& plan);

/// The members "meshes" and "features" of the object that is open.
void write_plan(JsonWriter& json, const ScenePlan& plan);

}  // namespace meshlode::app
