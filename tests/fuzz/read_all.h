// SPDX-License-Identifier: GPL-3.0-or-later
// Touches all that an asset has, as a program that trusts what Asset and load_page let through would.
#pragma once

#include "read/asset.h"

namespace meshlode::fuzz {

void read_all(const Asset& asset);

}  // namespace meshlode::fuzz
