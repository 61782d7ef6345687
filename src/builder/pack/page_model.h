// SPDX-License-Identifier: GPL-3.0-or-later
// A decoded page as small numbers: the inside of the stored form before any code (docs/reference/format.md, Stored
// pages).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "format/page_streams.h"

namespace meshlode::builder {

struct PageModel {
  /// Heads and range words of all clusters, by kind.
  std::vector<std::array<std::uint32_t, format::kHeadWords + format::kNormalHeadWords>> heads;
  std::array<std::vector<std::uint32_t>, format::kRangeWordKinds> range_words;
  /// The bit streams of all clusters as they are, one after another.
  std::vector<std::uint32_t> stream_words;
  /// What the bit streams hold: symbols of the first two streams, else folded numbers.
  std::array<std::vector<std::uint32_t>, format::kMaxStreams> streams;
};

/// Null where the page is not what a writer of this format makes (padding, gaps, unsorted restarts): such bytes have no
/// model from which they would come back.
[[nodiscard]] std::optional<PageModel> model_page(const format::MeshRecord& mesh, std::span<const std::uint32_t> page);

}  // namespace meshlode::builder
