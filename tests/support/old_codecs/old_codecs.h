// SPDX-License-Identifier: GPL-3.0-or-later
// Pages as lz4, zstd and draco stored them (docs/reference/codecs.md): codecs that are read where their readers are
// built in, and that nothing writes any more. Tests of those readers make their files here.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "builder/pack/pack.h"
#include "run/read/asset.h"

namespace meshlode::test {

/// builder::store_page() of every codec but none. Levels are fixed: equal pages give equal bytes.
[[nodiscard]] Result<std::vector<std::uint8_t>> store_page(const format::MeshRecord& mesh,
                                                           std::span<const std::uint8_t> page, format::Codec codec);

/// builder::pack_page() of every codec.
[[nodiscard]] Result<builder::PackedPage> pack_page(const format::MeshRecord& mesh, std::span<const std::uint8_t> page,
                                                    format::Codec codec);

/// An asset with its pages by another codec and another META, as `repack` gave it while the codec was written.
[[nodiscard]] Result<std::vector<std::uint8_t>> stored_by(const run::Asset& asset, format::Codec codec,
                                                          std::string meta_json);

}  // namespace meshlode::test
