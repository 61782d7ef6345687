// SPDX-License-Identifier: GPL-3.0-or-later
// What attributes are stored as, before they are: the steps that keep the budgets, and the values that readers get.
#pragma once

#include "builder/encode/encode.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Steps for the values of all levels.
[[nodiscard]] AttributeSteps choose_steps(const AttributeLayout& layout, const LodDag& dag,
                                          const EncodeOptions& options);

/// Of 255: a colour's channel.
[[nodiscard]] std::int32_t quantize_color(float value);

/// Attributes become the values that a reader of the asset gets, and LodDag::steps what they are stored as
/// multiples of: encode_mesh() then writes the same bytes as without.
void snap_attributes(const AttributeLayout& layout, const EncodeOptions& options, LodDag& dag);

}  // namespace meshlode::builder
