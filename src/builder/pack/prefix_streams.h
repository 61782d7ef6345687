// SPDX-License-Identifier: GPL-3.0-or-later
// The streams of a page's model in prefix codes.
#pragma once

#include <cstdint>
#include <vector>

#include "builder/pack/page_model.h"

namespace meshlode::builder {

struct PrefixStreams {
  std::vector<std::uint8_t> code_lengths;  ///< of all tables, one byte a symbol
  std::vector<std::vector<std::uint8_t>> streams;
};

[[nodiscard]] PrefixStreams write_prefix_streams(const format::MeshRecord& mesh, const PageModel& model);

}  // namespace meshlode::builder
