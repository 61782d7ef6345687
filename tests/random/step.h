// SPDX-License-Identifier: GPL-3.0-or-later
// One step of a trial: the program run once, in a process of its own with a limit of time.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace meshlode::test {

struct StepResult {
  int exit_code = -1;  ///< -1 where a signal ended it
  int signal = 0;
  bool timed_out = false;
  double cpu_seconds = 0.0;
  std::string out, err;
};

/// Where what the program prints goes; written over.
struct StepOutput {
  std::filesystem::path out, err;
};

/// Starts arguments[0] with the others. `cpu_seconds`: of processor time; a hang that sleeps ends after four times
/// that.
[[nodiscard]] StepResult run_process(std::vector<std::string> arguments, const StepOutput& output, double cpu_seconds);

/// A program that has been started, up to its main(), and runs what it is told in forks of itself (started.c). Starting
/// costs a sanitized program a third of a second of processor time, which is more than most scenes need. For one thread
/// at a time. The program has to be a dynamic executable.
class StartedProgram {
 public:
  /// `library`: started.c's
  StartedProgram(const std::filesystem::path& program, const std::filesystem::path& library);
  StartedProgram(const StartedProgram&) = delete;
  StartedProgram& operator=(const StartedProgram&) = delete;
  ~StartedProgram();

  /// As run_process(); arguments[0] is what the program is to take for its name. Where the program did not start, or
  /// has ended, the result is that of a step that exits with 127.
  [[nodiscard]] StepResult run(const std::vector<std::string>& arguments, const StepOutput& output, double cpu_seconds);

 private:
  int orders_ = -1, results_ = -1;
  pid_t process_ = -1;
};

}  // namespace meshlode::test
