// SPDX-License-Identifier: GPL-3.0-or-later
// An asset written anew around its pages: by another codec, or with other tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "run/read/asset.h"
#include "run/unpack/content_hash.h"

namespace meshlode::app {

struct Rewrite {
  format::Codec codec = format::Codec::kNone;
  std::string meta_json;
  run::OtherBytes other = {};  ///< as long as the asset's own
};

/// The whole file; `codec` decides how pages are stored. Errors: kInvalid where the content is not that of the asset's
/// hash; those of unpacking; kUnsupported where it decodes to more than the asset may. Threads: those of the caller's
/// arena.
[[nodiscard]] Result<std::vector<std::uint8_t>> rewrite_asset(const run::Asset& asset, const Rewrite& rewrite);

}  // namespace meshlode::app
