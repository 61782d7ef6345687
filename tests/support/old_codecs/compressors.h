// SPDX-License-Identifier: GPL-3.0-or-later
// The wrappers of the compression libraries, one file each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::test {

[[nodiscard]] Result<std::vector<std::uint8_t>> compress_lz4(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<std::vector<std::uint8_t>> compress_zstd(std::span<const std::uint8_t> bytes);
/// Numbers through Draco's symbol coder. Empty for none.
[[nodiscard]] Result<std::vector<std::uint8_t>> compress_draco(const std::vector<std::uint32_t>& values);

}  // namespace meshlode::test
