// SPDX-License-Identifier: GPL-3.0-or-later
// The simplifier with care left out, for studies of what care costs (docs/numerics.md).
#pragma once

#include "builder/simplify/simplify_once.h"

namespace meshlode::builder {

/// \pre options.experiment.care leaves out double quadrics or the fallback
[[nodiscard]] SimplifyAttempt simplify_carelessly(const SimplifyInput& input, const SimplifyOptions& options);

}  // namespace meshlode::builder
