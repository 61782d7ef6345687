// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the bytes that a comparison speaks of are those that the asset was written with.
#pragma once

#include <meshlode/result.h>

#include "run/read/asset.h"

namespace meshlode::app {

/// Opening an asset checks all sections but pages and blobs, which may be damaged behind a content hash that still says
/// what they were. Here both are held against their checksums, as stored: a reading of the whole file, and no decoding.
/// Errors: kInvalid naming the first page or blob that does not match.
[[nodiscard]] Status check_stored_bytes(const run::Asset& asset);

}  // namespace meshlode::app
