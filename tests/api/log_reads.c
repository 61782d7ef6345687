/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Preloaded into a program: writes to the file $READS_LOG how it reads files whose names end in .lode, a line a call.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static int asset = -1;

static void log_call(const char* name, long long offset, size_t bytes) {
  const char* path = getenv("READS_LOG");
  FILE* log = path ? fopen(path, "a") : NULL;
  if (!log) return;
  fprintf(log, "%s %lld %zu\n", name, offset, bytes);
  fclose(log);
}

int open(const char* path, int flags, ...) {
  const size_t length = strlen(path);
  va_list arguments;
  int mode, file;
  va_start(arguments, flags);
  mode = (flags & O_CREAT) ? va_arg(arguments, int) : 0;
  va_end(arguments);
  file = ((int (*)(const char*, int, ...))dlsym(RTLD_NEXT, "open"))(path, flags, mode);
  if (length > 5 && strcmp(path + length - 5, ".lode") == 0) asset = file;
  return file;
}

ssize_t pread(int file, void* to, size_t bytes, off_t offset) {
  if (file == asset) log_call("pread", offset, bytes);
  return ((ssize_t(*)(int, void*, size_t, off_t))dlsym(RTLD_NEXT, "pread"))(file, to, bytes, offset);
}

ssize_t read(int file, void* to, size_t bytes) {
  if (file == asset) log_call("read", 0, bytes);
  return ((ssize_t(*)(int, void*, size_t))dlsym(RTLD_NEXT, "read"))(file, to, bytes);
}

void* mmap(void* at, size_t bytes, int protection, int flags, int file, off_t offset) {
  if (file >= 0 && file == asset) log_call("mmap", offset, bytes);
  return ((void* (*)(void*, size_t, int, int, int, off_t))dlsym(RTLD_NEXT, "mmap"))(at, bytes, protection, flags, file,
                                                                                    offset);
}
