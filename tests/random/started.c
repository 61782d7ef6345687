/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Preloaded into a program: its main() runs once an order (started.h), each time in a fork. What a sanitized program
 * does before main() and what it is to load takes more time than most scenes, and is the same each time. */
#define _GNU_SOURCE
#include "started.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

typedef int (*Main)(int, char**, char**);
typedef int (*Start)(Main, int, char**, void (*)(void), void (*)(void), void (*)(void), void*);

static Main program_main;

/* Of the order that is followed; here, where a program that looks for leaks as it ends sees that they are held. */
static char* order_text;
static char** order_argv;

static int read_all(void* bytes, size_t size) {
  size_t done = 0;
  while (done < size) {
    const ssize_t more = read(kStartedOrders, (char*)bytes + done, size - done);
    if (more <= 0) return 0;
    done += (size_t)more;
  }
  return 1;
}

static void redirect(const char* path, int descriptor) {
  const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || dup2(file, descriptor) < 0) _exit(127);
  close(file);
}

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
  redirect(out, STDOUT_FILENO);
  redirect(err, STDERR_FILENO);
  const rlim_t seconds = (rlim_t)ceil(order->cpu_seconds);
  const struct rlimit cpu = {seconds, seconds + 1}, no_core = {0, 0};
  setrlimit(RLIMIT_CPU, &cpu);
  setrlimit(RLIMIT_CORE, &no_core);
  return program_main((int)order->count, order_argv, environment);
}

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* 1 where it had to be killed. */
static int wait_or_kill(pid_t child, double seconds, int* status, struct rusage* usage) {
  const double deadline = now() + seconds;
  struct timespec pause = {0, 1000000};
  while (now() < deadline) {
    if (wait4(child, status, WNOHANG, usage) == child) return 0;
    nanosleep(&pause, NULL);
    if (pause.tv_nsec < 20000000) pause.tv_nsec *= 2;
  }
  kill(child, SIGKILL);
  wait4(child, status, 0, usage);
  return 1;
}

static double seconds_of(struct timeval time) {
  return (double)time.tv_sec + 1e-6 * (double)time.tv_usec;
}

static int serve(int argc, char** argv, char** environment) {
  (void)argc;
  (void)argv;
  unsetenv("LD_PRELOAD");
  for (;;) {
    struct StartedOrder order;
    if (!read_all(&order, sizeof order)) _exit(0); /* nobody gives orders any more */
    order_text = malloc(order.size);
    if (order_text == NULL || !read_all(order_text, order.size)) _exit(127);
    const pid_t child = fork();
    if (child < 0) _exit(127);
    if (child == 0) return follow(&order, environment);
    free(order_text);
    int status = 0;
    struct rusage usage = {0};
    struct StartedResult result;
    result.timed_out = wait_or_kill(child, 4.0 * order.cpu_seconds, &status, &usage);
    result.status = status;
    result.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
    if (write(kStartedResults, &result, sizeof result) != (ssize_t)sizeof result) _exit(127);
  }
}

int __libc_start_main(Main main, int argc, char** argv, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
                      void* stack_end);

int __libc_start_main(Main main, int argc, char** argv, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
                      void* stack_end) {
  program_main = main;
  Start start;
  *(void**)&start = dlsym(RTLD_NEXT, "__libc_start_main");
  return start(serve, argc, argv, init, fini, rtld_fini, stack_end);
}
