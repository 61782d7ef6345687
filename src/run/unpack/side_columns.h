// SPDX-License-Identifier: MIT
// Side information of the codec strips, which needs no library: each of its columns is stored like one of a section.
#pragma once

#include <cstdint>
#include <span>

#include <meshlode/format.h>

namespace meshlode::run {

/// Fills `out` exactly: code lengths, counts of range words, planes of heads, planes of range words. False where the
/// stored bytes do not say that.
[[nodiscard]] bool unpack_side_columns(const format::MeshRecord& mesh, std::uint32_t cluster_count,
                                       std::span<const std::uint8_t> stored, std::span<std::uint8_t> out);

}  // namespace meshlode::run
