// SPDX-License-Identifier: MIT
// The wrappers of the decompression libraries, one file each.
#pragma once

#include <cstdint>
#include <span>

#include "unpack/strip_values.h"

namespace meshlode {

enum class UnpackOutcome : std::uint8_t { kOk, kBroken, kNotBuiltIn };

/// Fills `out` exactly; anything longer, shorter or malformed is kBroken. Never reads or writes outside the spans.
[[nodiscard]] UnpackOutcome unpack_lz4(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out);
[[nodiscard]] UnpackOutcome unpack_zstd(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out);
[[nodiscard]] UnpackOutcome unpack_draco_bytes(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out);

/// All streams through Draco's symbol coder. False where they are broken, or where it is not built in.
[[nodiscard]] bool read_draco_streams(const format::MeshRecord& mesh, const StreamBytes& streams,
                                      const StreamCounts& counts, StripValues& out);

}  // namespace meshlode
