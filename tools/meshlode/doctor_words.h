// SPDX-License-Identifier: GPL-3.0-or-later
// The faults of a source in words: what each is called, what was counted and what to do about it.
#pragma once

#include <string>
#include <vector>

#include "app/doctor/diagnosis.h"
#include "scene/detect/fault.h"
#include "scene/scene.h"

namespace meshlode::cli {

/// Ids of all that diagnose_scene() may find, in one order.
[[nodiscard]] std::vector<std::string> source_fault_ids();

/// The case of docs/reference/hard-cases.md that tries a fault along a parameter; empty: there is none.
[[nodiscard]] const char* hard_case_of(scene::FaultKind kind);

/// What scene::examine_scene finds and what the import left out, ranked: a share of a mesh counts as much as the mesh
/// has triangles.
[[nodiscard]] std::vector<app::Diagnosis> diagnose_scene(const scene::Scene& scene);

/// A report without its file: diagnose_scene() and how large the scene is.
[[nodiscard]] app::DoctorReport report_on_scene(const scene::Scene& scene);

}  // namespace meshlode::cli
