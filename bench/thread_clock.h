// SPDX-License-Identifier: GPL-3.0-or-later
// The clock of single-threaded benchmarks.
#pragma once

#include <ctime>

namespace meshlode::bench {

/// CPU seconds of the calling thread: other programs' work does not count.
inline double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace meshlode::bench
