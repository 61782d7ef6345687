/* SPDX-License-Identifier: GPL-3.0-or-later
 * Preloaded: denormal results become zero and denormal operands count as zero, as where a host (an audio plug-in, a
 * game) or a library built with -ffast-math has set the processor so. Threads begin with what the thread that makes
 * them has. */
#include <xmmintrin.h>

__attribute__((constructor)) static void flush_denormals(void) {
  const unsigned flush_to_zero = 0x8000U, denormals_are_zero = 0x0040U;
  _mm_setcsr(_mm_getcsr() | flush_to_zero | denormals_are_zero);
}
