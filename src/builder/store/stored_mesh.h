// SPDX-License-Identifier: GPL-3.0-or-later
// A built mesh as bytes, and back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "builder/encode/encode.h"
#include "builder/plan/plan.h"

namespace meshlode::builder {

struct StoredMesh {
  EncodedMesh encoded;
  std::vector<PlanDecision> decisions;  ///< those made after the plan
};

/// `label`: what each decision's `what` begins with; it says where the mesh stood in its scene and is not stored.
[[nodiscard]] std::vector<std::uint8_t> stored_mesh_bytes(const EncodedMesh& mesh,
                                                          std::span<const PlanDecision> decisions,
                                                          const std::string& label);

/// Nothing for bytes that are no stored mesh: every count, id and range is checked, so that what is made of it stays
/// inside its tables. What lies inside a page is not looked at. `label`: of the mesh where it stands now.
[[nodiscard]] std::optional<StoredMesh> read_stored_mesh(std::span<const std::uint8_t> bytes, const std::string& label);

}  // namespace meshlode::builder
