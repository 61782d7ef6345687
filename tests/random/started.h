/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What random_scenes (step.cpp) and the program that it started (started.c) say to each other, by two pipes. */
#pragma once

#include <stdint.h>

/* Descriptors in the started program. */
enum { kStartedOrders = 198, kStartedResults = 199 };

/* Followed by `size` bytes: a file for stdout, a file for stderr and `count` arguments, each ended by a zero. The
 * answer is a struct ChildEnd (child.h). */
struct StartedOrder {
  double cpu_seconds; /* that it may take */
  uint32_t size, count;
};
