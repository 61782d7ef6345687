// SPDX-License-Identifier: GPL-3.0-or-later
// What doctor advises beside faults: what the defaults decide by the scene, and what weighs most in the file. Nothing
// here has a share, so that it is named last.
#pragma once

#include <string>
#include <vector>

#include "app/doctor/diagnosis.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::cli {

[[nodiscard]] std::vector<std::string> advice_ids();

/// Masked cards and other loose pieces, and images that weigh as much as the geometry of the asset will or more.
void add_advice(const scene::Scene& scene, std::vector<app::Diagnosis>& diagnoses);

/// Masked cards that were built by distance, pages that are stored as they are, and images that are most of the file.
void add_advice(const run::Asset& asset, std::vector<app::Diagnosis>& diagnoses);

}  // namespace meshlode::cli
