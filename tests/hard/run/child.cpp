// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/child.h"

#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace meshlode::test::hard {

namespace {

/// Reads until the other end is closed. False where the deadline comes first.
bool read_all(int descriptor, double wall_seconds, std::string& out) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(wall_seconds);
  char buffer[4096];
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    pollfd wait{descriptor, POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(std::max<long long>(0, left.count())));
    if (ready <= 0) return false;
    const ssize_t bytes = read(descriptor, buffer, sizeof buffer);
    if (bytes <= 0) return true;
    out.append(buffer, static_cast<std::size_t>(bytes));
  }
}

void set_limit(int what, std::size_t value) {
  const rlimit limit{value, value};
  setrlimit(static_cast<decltype(RLIMIT_CPU)>(what), &limit);
}

}  // namespace

ChildResult run_child(const std::string& program, std::vector<std::string> arguments, const ChildLimits& limits) {
  arguments.insert(arguments.begin(), program);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  ChildResult result;
  int ends[2];
  if (pipe(ends) != 0) return result;
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    return result;
  }
  if (child == 0) {  // only what is safe between fork and exec
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    set_limit(RLIMIT_CPU, static_cast<std::size_t>(std::ceil(limits.cpu_seconds)));
    set_limit(RLIMIT_CORE, 0);
    if (limits.memory_bytes > 0) set_limit(RLIMIT_AS, limits.memory_bytes);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(ends[1]);
  const bool is_over = read_all(ends[0], limits.wall_seconds, result.out);
  close(ends[0]);
  if (!is_over) kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  // At a hard limit equal to the soft one the kernel kills outright.
  result.timed_out = !is_over || result.signal == SIGXCPU || result.signal == SIGKILL;
  return result;
}

}  // namespace meshlode::test::hard
