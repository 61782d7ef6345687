// SPDX-License-Identifier: GPL-3.0-or-later
// The simplifier with care left out, for studies of what care costs (docs/log/numerics.md).
#pragma once

#include "builder/simplify/simplify.h"
#include "lab/experiment/experiment.h"

namespace meshlode::lab {

/// simplify_group() where `care` leaves out double quadrics or the fallback.
[[nodiscard]] builder::SimplifyGroup simplify_carelessly(const Care& care);

}  // namespace meshlode::lab
