/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A child that runs one step, whoever forked it: random_scenes itself (step.cpp) or the program that it started
 * (started.c). */
#pragma once

#include <stddef.h>
#include <sys/types.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ChildEnd {
  double cpu_seconds; /* that it took */
  int status;         /* waitpid()'s */
  int was_killed;     /* 1 where it was still there after four times its processor time */
};

/* In the child: what it prints goes to these files, written over, and it is ended after so much processor time. Only
 * what is safe between fork and exec. Ends it with 127 where a file cannot be opened. */
void prepare_child(const char* out, const char* err, double cpu_seconds);

/* Waits for it, four times `cpu_seconds` at most; then kills it. */
struct ChildEnd wait_for_child(pid_t child, double cpu_seconds);

/* 1 where all of the bytes went through. */
int read_all(int file, void* bytes, size_t size);
int write_all(int file, const void* bytes, size_t size);

#ifdef __cplusplus
}
#endif
