// SPDX-License-Identifier: GPL-3.0-or-later
// Where the program's large arrays lie. No byte depends on it.
#pragma once

namespace meshlode::cli {

/// Arrays of 2 MiB and more go back to the system as soon as they are freed. Left to itself, glibc takes the first one
/// that is freed as a sign to keep all up to its size for later, in gaps between what is still in use: a sixth of a
/// build's peak.
void give_back_large_arrays();

}  // namespace meshlode::cli
