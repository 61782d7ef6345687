// SPDX-License-Identifier: GPL-3.0-or-later
// The sample scene as an asset that the judge finds nothing in: the hand-made DAGs with the build's own bounds and a
// whole META text, so that a test may break one thing and know that it is the only one.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/format.h>

#include "scene/scene.h"

namespace meshlode::test {

/// support/sample_asset.h's scene; its META names the scene's source hash. With promises: of texels and appearance,
/// with the groups' own errors; and with page hints.
[[nodiscard]] std::vector<std::uint8_t> judged_sample_bytes(format::Codec codec = format::Codec::kNone,
                                                            bool has_promises = false);

}  // namespace meshlode::test
