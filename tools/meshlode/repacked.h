// SPDX-License-Identifier: GPL-3.0-or-later
// An asset's pages under another codec, for the verbs that need them so.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "base/hash.h"
#include "run/read/asset.h"

namespace meshlode::cli {

/// The whole file, with the same content hash. Errors: kInvalid where the content is not that of the hash; those of
/// unpacking; kUnsupported where it decodes to more than the asset may. Threads: those of the caller's arena.
[[nodiscard]] Result<std::vector<std::uint8_t>> repacked(const run::Asset& asset, format::Codec codec);

}  // namespace meshlode::cli
