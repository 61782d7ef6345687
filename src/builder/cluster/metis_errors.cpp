// SPDX-License-Identifier: GPL-3.0-or-later
// Where METIS has no memory, its gk_errexit() prints and raises SIGABRT, for which METIS_PartGraphRecursive() has put a
// handler that jumps back into it. Handlers are the process's: with several threads in METIS one takes away another
// one's, and what is freed after the jump is not always METIS's own any more. So the program ends there, as it does
// wherever memory runs out and nothing may be thrown: by std::terminate() with std::bad_alloc.
#include <csignal>
#include <exception>
#include <new>

extern "C" {

void gk_errexit(int signum, char* /*format*/, ...) {
  if (signum == SIGABRT) {
    try {
      throw std::bad_alloc();
    } catch (...) {
      std::terminate();  // its handler sees what is being handled
    }
  }
  static_cast<void>(raise(signum));
}
}
