// SPDX-License-Identifier: GPL-3.0-or-later
// How many samples are covered, by view: what factors of cards are found by.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/pictures.h"
#include "builder/aggregate/views.h"

namespace meshlode::builder {

/// Samples by view.
using Covered = std::vector<std::uint64_t>;

/// Samples that runs of so many leaves cover at a spacing in each view, each run alone: a list for each length.
/// \pre lengths are powers of two, rising, and none is above the number of leaves
[[nodiscard]] std::vector<std::vector<Covered>> covered_samples(const SourceSurface& source, const MeshFrame& frame,
                                                                const ByPiece& leaf_triangles, double spacing,
                                                                std::span<const View> views,
                                                                std::span<const std::uint32_t> run_lengths);
/// The same of other triangles together.
[[nodiscard]] Covered covered_samples(const MeshFrame& frame, std::span<const Corners> triangles, double spacing,
                                      std::span<const View> views);

}  // namespace meshlode::builder
