// SPDX-License-Identifier: GPL-3.0-or-later
#include "step.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <thread>

#include "started.h"

namespace meshlode::test {

namespace {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

void redirect(const char* path, int descriptor) {
  const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || dup2(file, descriptor) < 0) _exit(127);
}

/// Waits until the child ends or `deadline` passes; then kills it.
bool wait_or_kill(pid_t child, double wall_seconds, int& status, rusage& usage) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(wall_seconds);
  auto pause = std::chrono::milliseconds(1);
  for (;;) {
    if (wait4(child, &status, WNOHANG, &usage) == child) return false;
    if (std::chrono::steady_clock::now() > deadline) break;
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::milliseconds(20));
  }
  kill(child, SIGKILL);
  wait4(child, &status, 0, &usage);
  return true;
}

StepResult result_of(int status, bool timed_out, double cpu_seconds, const StepOutput& output) {
  StepResult result;
  result.timed_out = timed_out;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  if (result.signal == SIGXCPU) result.timed_out = true;
  result.cpu_seconds = cpu_seconds;
  result.out = read_text(output.out);
  result.err = read_text(output.err);
  return result;
}

bool write_all(int file, const void* bytes, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t more = write(file, static_cast<const char*>(bytes) + done, size - done);
    if (more <= 0) return false;
    done += static_cast<std::size_t>(more);
  }
  return true;
}

bool read_all(int file, void* bytes, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t more = read(file, static_cast<char*>(bytes) + done, size - done);
    if (more <= 0) return false;
    done += static_cast<std::size_t>(more);
  }
  return true;
}

}  // namespace

StepResult run_process(std::vector<std::string> arguments, const StepOutput& output, double cpu_seconds) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::string out_name = output.out.string(), err_name = output.err.string();
  const rlimit cpu{static_cast<rlim_t>(std::ceil(cpu_seconds)), static_cast<rlim_t>(std::ceil(cpu_seconds)) + 1};
  const pid_t child = fork();
  if (child < 0) return {};
  if (child == 0) {  // only what is safe between fork and exec
    redirect(out_name.c_str(), STDOUT_FILENO);
    redirect(err_name.c_str(), STDERR_FILENO);
    setrlimit(RLIMIT_CPU, &cpu);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    execv(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  const bool timed_out = wait_or_kill(child, 4.0 * cpu_seconds, status, usage);
  return result_of(status, timed_out, seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime), output);
}

StartedProgram::StartedProgram(const std::filesystem::path& program, const std::filesystem::path& library) {
  signal(SIGPIPE, SIG_IGN);  // an order to a program that has ended is an error like others
  int orders[2], results[2];
  if (pipe2(orders, O_CLOEXEC) != 0) return;
  if (pipe2(results, O_CLOEXEC) != 0) {
    close(orders[0]);
    close(orders[1]);
    return;
  }
  const std::string name = program.string(), preload = "LD_PRELOAD=" + library.string();
  std::vector<char*> environment;
  for (char** word = environ; *word != nullptr; ++word) {
    if (std::string_view(*word).substr(0, 11) != "LD_PRELOAD=") environment.push_back(*word);
  }
  environment.push_back(const_cast<char*>(preload.c_str()));
  environment.push_back(nullptr);
  char* const argv[] = {const_cast<char*>(name.c_str()), nullptr};
  process_ = fork();
  if (process_ == 0) {
    // Both above those that they become, so that neither is written over.
    const int from = fcntl(orders[0], F_DUPFD, kStartedResults + 1);
    const int to = fcntl(results[1], F_DUPFD, kStartedResults + 1);
    if (dup2(from, kStartedOrders) < 0 || dup2(to, kStartedResults) < 0) _exit(127);
    close(from);
    close(to);
    execve(argv[0], argv, environment.data());
    _exit(127);
  }
  close(orders[0]);
  close(results[1]);
  orders_ = orders[1];
  results_ = results[0];
}

StartedProgram::~StartedProgram() {
  if (orders_ >= 0) close(orders_);  // by which it ends
  if (results_ >= 0) close(results_);
  if (process_ > 0) waitpid(process_, nullptr, 0);
}

StepResult StartedProgram::run(const std::vector<std::string>& arguments, const StepOutput& output,
                               double cpu_seconds) {
  std::string text = output.out.string() + '\0' + output.err.string() + '\0';
  for (const std::string& argument : arguments) text += argument + '\0';
  const StartedOrder order{cpu_seconds, static_cast<std::uint32_t>(text.size()),
                           static_cast<std::uint32_t>(arguments.size())};
  StartedResult ended{};
  if (!write_all(orders_, &order, sizeof order) || !write_all(orders_, text.data(), text.size()) ||
      !read_all(results_, &ended, sizeof ended)) {
    StepResult result;
    result.exit_code = 127;
    result.err = "the started program is gone";
    return result;
  }
  return result_of(ended.status, ended.timed_out != 0, ended.cpu_seconds, output);
}

}  // namespace meshlode::test
