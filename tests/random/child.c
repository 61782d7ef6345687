/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "child.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static void redirect(const char* path, int descriptor) {
  const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0 || dup2(file, descriptor) < 0) _exit(127);
  close(file);
}

void prepare_child(const char* out, const char* err, double cpu_seconds) {
  redirect(out, STDOUT_FILENO);
  redirect(err, STDERR_FILENO);
  const rlim_t seconds = (rlim_t)ceil(cpu_seconds);
  const struct rlimit cpu = {seconds, seconds + 1}, no_core = {0, 0};
  setrlimit(RLIMIT_CPU, &cpu);
  setrlimit(RLIMIT_CORE, &no_core);
}

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static double seconds_of(struct timeval time) {
  return (double)time.tv_sec + 1e-6 * (double)time.tv_usec;
}

struct ChildEnd wait_for_child(pid_t child, double cpu_seconds) {
  struct ChildEnd end;
  memset(&end, 0, sizeof end);
  struct rusage usage;
  memset(&usage, 0, sizeof usage);
  const double deadline = now() + 4.0 * cpu_seconds;
  struct timespec pause = {0, 1000000};
  while (wait4(child, &end.status, WNOHANG, &usage) != child) {
    if (now() < deadline) {
      nanosleep(&pause, NULL);
      if (pause.tv_nsec < 16000000) pause.tv_nsec *= 2;
      continue;
    }
    end.was_killed = 1;
    kill(child, SIGKILL);
    wait4(child, &end.status, 0, &usage);
    break;
  }
  end.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  return end;
}

int read_all(int file, void* bytes, size_t size) {
  for (size_t done = 0; done < size;) {
    const ssize_t more = read(file, (char*)bytes + done, size - done);
    if (more <= 0) return 0;
    done += (size_t)more;
  }
  return 1;
}

int write_all(int file, const void* bytes, size_t size) {
  for (size_t done = 0; done < size;) {
    const ssize_t more = write(file, (const char*)bytes + done, size - done);
    if (more <= 0) return 0;
    done += (size_t)more;
  }
  return 1;
}
