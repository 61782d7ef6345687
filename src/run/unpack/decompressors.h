// SPDX-License-Identifier: MIT
// The wrappers of the decompression libraries, one file each: of codecs that nothing writes any more. no_old_codecs.cpp
// stands for all of them where they are not built in.
#pragma once

#include <cstdint>
#include <span>

namespace meshlode::run {

enum class UnpackOutcome : std::uint8_t { kOk, kBroken, kNotBuiltIn };

/// Fills `out` exactly; anything longer, shorter or malformed is kBroken. Never reads or writes outside the spans.
[[nodiscard]] UnpackOutcome unpack_lz4(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out);
[[nodiscard]] UnpackOutcome unpack_zstd(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out);
/// Numbers through Draco's symbol coder.
[[nodiscard]] UnpackOutcome unpack_draco(std::span<const std::uint8_t> stored, std::span<std::uint32_t> out);

}  // namespace meshlode::run
