// SPDX-License-Identifier: MIT
// How much decoded bytes a file may ask for (I11): what its own size justifies, or what the caller allows beyond that.
#pragma once

#include <algorithm>
#include <cstdint>

namespace meshlode::run {

/// Where nobody says otherwise.
constexpr std::uint64_t kDefaultMaxDecoded = std::uint64_t{512} << 20U;

/// Integers of a vertex and corners of a triangle take tens of times the bits that they are stored in; hundreds of
/// times is what a file that was made for it reaches.
constexpr std::uint64_t kJustifiedRatio = 64;

/// The most that a file of this size may decode to.
[[nodiscard]] constexpr std::uint64_t decoded_limit(std::uint64_t file_bytes, std::uint64_t max_decoded) {
  return std::max(max_decoded, file_bytes > UINT64_MAX / kJustifiedRatio ? UINT64_MAX : kJustifiedRatio * file_bytes);
}

}  // namespace meshlode::run
