// SPDX-License-Identifier: MIT
// Giving memory back before the owner ends.
#pragma once

namespace meshlode {

/// Empties vectors and frees what they hold. `values = {}` does not: an empty list is assigned, the capacity stays.
template <class... Vectors>
void release(Vectors&... values) {
  (Vectors().swap(values), ...);
}

}  // namespace meshlode
