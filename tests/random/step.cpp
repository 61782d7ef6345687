// SPDX-License-Identifier: GPL-3.0-or-later
#include "step.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>

#include "child.h"
#include "started.h"

namespace meshlode::test {

namespace {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

StepResult result_of(const ChildEnd& end, const StepOutput& output) {
  StepResult result;
  if (WIFEXITED(end.status)) result.exit_code = WEXITSTATUS(end.status);
  if (WIFSIGNALED(end.status)) result.signal = WTERMSIG(end.status);
  result.timed_out = end.was_killed != 0 || result.signal == SIGXCPU;
  result.cpu_seconds = end.cpu_seconds;
  result.out = read_text(output.out);
  result.err = read_text(output.err);
  return result;
}

}  // namespace

StepResult run_process(std::vector<std::string> arguments, const StepOutput& output, double cpu_seconds) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::string out_name = output.out.string(), err_name = output.err.string();
  const pid_t child = fork();
  if (child < 0) return {};
  if (child == 0) {
    prepare_child(out_name.c_str(), err_name.c_str(), cpu_seconds);
    execv(argv[0], argv.data());
    _exit(127);
  }
  return result_of(wait_for_child(child, cpu_seconds), output);
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
  ChildEnd ended{};
  if (write_all(orders_, &order, sizeof order) == 0 || write_all(orders_, text.data(), text.size()) == 0 ||
      read_all(results_, &ended, sizeof ended) == 0) {
    StepResult result;
    result.exit_code = 127;
    result.err = "the started program is gone";
    return result;
  }
  return result_of(ended, output);
}

}  // namespace meshlode::test
