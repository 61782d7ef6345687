// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/ids.h"

namespace meshlode::builder {

/// A place in the order of a SurfaceTree, which holds one triangle. Places near each other are near in space. Where a
/// search may begin is such a place, of the source's tree or of a group's: any will do, a near one is quicker.
using TreeSlot = Id<struct TreeSlotTag>;

}  // namespace meshlode::builder
