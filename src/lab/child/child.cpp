// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/child/child.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace meshlode::lab {

namespace {

constexpr std::size_t kMaxErrors = 4096;
constexpr int kLookEvery = 10;  ///< milliseconds

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Between fork and exec: nothing but calls that are safe there.
[[noreturn]] void become(const char* program, char* const* arguments, int errors, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(127);  // it ended before it could be watched
  const int nothing = ::open("/dev/null", O_RDWR);
  if (nothing < 0 || ::dup2(nothing, STDIN_FILENO) < 0 || ::dup2(nothing, STDOUT_FILENO) < 0 ||
      ::dup2(errors, STDERR_FILENO) < 0) {
    ::_exit(127);
  }
  ::execv(program, arguments);
  ::_exit(127);
}

/// The high-water mark of what the process has had in memory since it became the program; 0 where it has ended.
/// rusage does not say that: what a process had before exec counts there, and that is what this one has.
std::uint64_t find_high_water(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  std::string line;
  while (std::getline(status, line)) {
    constexpr std::string_view kName = "VmHWM:";
    if (line.starts_with(kName)) return std::uint64_t{1024} * std::strtoull(line.c_str() + kName.size(), nullptr, 10);
  }
  return 0;
}

/// Waits until the child has become its program or ended: until then it is a copy of this process, with its memory.
/// The child's end of the pipe is closed by exec.
void wait_for_exec(int file) {
  char nothing = 0;
  while (::read(file, &nothing, 1) < 0 && errno == EINTR) {
  }
}

/// Reads stderr until the child has closed it; looks at its memory meanwhile.
void watch(int file, pid_t child, ChildRun& run) {
  std::array<char, 1024> piece{};
  for (;;) {
    pollfd wanted{file, POLLIN, 0};
    const int ready = ::poll(&wanted, 1, kLookEvery);
    if (ready < 0 && errno != EINTR) break;
    run.peak_bytes = std::max(run.peak_bytes, find_high_water(child));
    if (ready <= 0) continue;
    const ssize_t count = ::read(file, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    run.errors.append(piece.data(), static_cast<std::size_t>(count));
    if (run.errors.size() > kMaxErrors) run.errors.erase(0, run.errors.size() - kMaxErrors);
  }
}

Error cannot_start(const std::filesystem::path& program) {
  return {ErrorCode::kIo, program.string(), std::string("cannot be started: ") + std::strerror(errno)};
}

}  // namespace

Result<ChildRun> run_child(const std::filesystem::path& program, std::span<const std::string> arguments) {
  const std::string path = program.string();
  std::vector<std::string> words{path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::array<int, 2> pipe{}, started{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return cannot_start(program);
  if (::pipe2(started.data(), O_CLOEXEC) != 0) {
    const Error error = cannot_start(program);
    ::close(pipe[0]);
    ::close(pipe[1]);
    return error;
  }
  const pid_t parent = ::getpid();
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == 0) become(path.c_str(), pointers.data(), pipe[1], parent);
  const Error failed = cannot_start(program);
  ::close(pipe[1]);
  ::close(started[1]);
  ChildRun run;
  if (child > 0) {
    wait_for_exec(started[0]);
    watch(pipe[0], child, run);
  }
  ::close(started[0]);
  ::close(pipe[0]);
  if (child < 0) return failed;
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0) {
    if (errno != EINTR) return cannot_start(program);
  }
  run.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run.user_seconds = seconds_of(usage.ru_utime);
  run.system_seconds = seconds_of(usage.ru_stime);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return run;
}

}  // namespace meshlode::lab
