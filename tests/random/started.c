/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Preloaded into a program: its main() runs once an order (started.h), each time in a fork. What a sanitized program
 * does before main() and what it is to load takes more time than most scenes, and is the same each time. */
#define _GNU_SOURCE
#include "started.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <unistd.h>

#include "child.h"

typedef int (*Main)(int, char**, char**);
typedef int (*Start)(Main, int, char**, void (*)(void), void (*)(void), void (*)(void), void*);

static Main program_main;

/* Of the order that is followed; here, where a program that looks for leaks as it ends sees that they are held. */
static char* order_text;
static char** order_argv;

static const char* next(const char* text) {
  while (*text != 0) ++text;
  return text + 1;
}

static int follow(const struct StartedOrder* order, char** environment) {
  const char* out = order_text;
  const char* err = next(out);
  order_argv = calloc((size_t)order->count + 1, sizeof *order_argv);
  if (order_argv == NULL) _exit(127);
  const char* word = next(err);
  for (uint32_t i = 0; i < order->count; ++i, word = next(word)) order_argv[i] = (char*)word;
  close(kStartedOrders);
  close(kStartedResults);
  prepare_child(out, err, order->cpu_seconds);
  return program_main((int)order->count, order_argv, environment);
}

static int serve(int argc, char** argv, char** environment) {
  (void)argc;
  (void)argv;
  unsetenv("LD_PRELOAD");
  for (;;) {
    struct StartedOrder order;
    if (!read_all(kStartedOrders, &order, sizeof order)) _exit(0); /* nobody gives orders any more */
    order_text = malloc(order.size);
    if (order_text == NULL || !read_all(kStartedOrders, order_text, order.size)) _exit(127);
    const pid_t child = fork();
    if (child < 0) _exit(127);
    if (child == 0) return follow(&order, environment);
    free(order_text);
    const struct ChildEnd end = wait_for_child(child, order.cpu_seconds);
    if (!write_all(kStartedResults, &end, sizeof end)) _exit(127);
  }
}

__attribute__((visibility("default"))) int __libc_start_main(Main main, int argc, char** argv, void (*init)(void),
                                                             void (*fini)(void), void (*rtld_fini)(void),
                                                             void* stack_end);

int __libc_start_main(Main main, int argc, char** argv, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
                      void* stack_end) {
  program_main = main;
  Start start;
  *(void**)&start = dlsym(RTLD_NEXT, "__libc_start_main");
  return start(serve, argc, argv, init, fini, rtld_fini, stack_end);
}
