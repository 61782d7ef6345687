// SPDX-License-Identifier: MIT
// What to load of an asset, for no camera: the order of all pages, and what the first picture needs.
#pragma once

#include <cstdint>
#include <vector>

#include "run/read/asset.h"

namespace meshlode::run {

/// Each page behind those that it depends on, those with the largest errors first, over all meshes.
[[nodiscard]] std::vector<std::uint32_t> streaming_order(const Asset& asset);

struct FileRange {
  std::uint64_t offset = 0, bytes = 0;
};
/// Where the pages lie without which nothing is drawn: those with a terminal group of a mesh that is drawn. Ascending.
/// Pages with no more than `max_gap` bytes between them share a range, and neighbours always do.
[[nodiscard]] std::vector<FileRange> first_ranges(const Asset& asset, std::uint64_t max_gap);

}  // namespace meshlode::run
