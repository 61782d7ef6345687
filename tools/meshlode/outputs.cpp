// SPDX-License-Identifier: GPL-3.0-or-later
// Signals are taken by a thread that waits for them, not by a handler: it may lock what a write under way holds, so
// that none of its steps is cut in two.
#include "outputs.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <functional>
#include <mutex>
#include <new>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <unistd.h>

#include "base/file.h"
#include "base/guarded.h"

namespace meshlode::cli {

namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

const char* name_of(int signal) {
  return signal == SIGINT ? "SIGINT" : signal == SIGTERM ? "SIGTERM" : "SIGHUP";
}

/// What is to be done at an interrupt. Never destroyed, for the same reason as output_files().
struct Interrupt {
  std::mutex mutex;
  std::function<void()> action;
};
Interrupt& interrupt() {
  static auto* const one = new Interrupt;
  return *one;
}

[[noreturn]] void end_process(int signal) {
  {
    const std::lock_guard lock(interrupt().mutex);
    try {
      if (interrupt().action) interrupt().action();
    } catch (const std::exception&) {
      // The process ends all the same.
    }
  }
  output_files().abandon();
  std::string line = std::string("meshlode: interrupted by ") + name_of(signal) + "\n";
  if (::isatty(STDERR_FILENO) == 1) line = "\r\033[K" + line;  // over the progress bar
  if (::write(STDERR_FILENO, line.data(), line.size()) < 0) {
    // Nobody is left to tell.
  }
  ::_exit(static_cast<int>(ErrorCode::kIo));
}

/// What cannot be thrown is memory that ran out, or a mistake of this program's. Allocates nothing.
[[noreturn]] void end_without_memory() {
  bool is_memory = false;
  try {
    if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::exception& thrown) {
    is_memory = is_out_of_memory(thrown);
  } catch (...) {
    // A mistake.
  }
  if (is_memory) {
    output_files().abandon();
    static std::atomic_flag is_said;  // several threads may come here at once: the first says it and ends all
    while (is_said.test_and_set()) ::pause();
    constexpr std::string_view kLine = "meshlode: out of memory\n";
    if (::write(STDERR_FILENO, kLine.data(), kLine.size()) < 0) {
      // Nobody is left to tell.
    }
    ::_exit(static_cast<int>(ErrorCode::kBuildFailed));
  }
  std::signal(SIGABRT, SIG_DFL);  // METIS may have left a handler of its own
  std::abort();
}

}  // namespace

OutputFiles& output_files() {
  // Never destroyed: the thread that waits for signals may need it while the process ends.
  static auto* const files = new OutputFiles(OutputFiles::Folders::kAreMade);
  return *files;
}

void keep_file(const std::filesystem::path& path) {
  if (const auto id = find_file_id(path)) output_files().keep(*id);
}

Status write_text(const std::string& path, const std::string& text) {
  return output_files().write(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void set_interrupt_action(std::function<void()> action) {
  const std::lock_guard lock(interrupt().mutex);
  interrupt().action = std::move(action);
}

void end_where_memory_runs_out() {
  static_cast<void>(output_files());  // made while there is memory
  std::set_terminate(end_without_memory);
}

void watch_signals() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  sigset_t waited;
  ::sigemptyset(&waited);
  bool is_any = false;
  for (const int signal : kSignals) {
    struct sigaction before {};
    if (::sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
    ::sigaddset(&waited, signal);
    is_any = true;
  }
  if (!is_any) return;
  static_cast<void>(output_files());  // both are made before there are two threads
  static_cast<void>(interrupt());
  sigset_t unblocked;
  if (::pthread_sigmask(SIG_BLOCK, &waited, &unblocked) != 0) return;  // all threads to come inherit it
  try {
    std::thread([waited] {
      int signal = 0;
      if (::sigwait(&waited, &signal) == 0) end_process(signal);
    }).detach();
  } catch (const std::system_error&) {
    ::pthread_sigmask(SIG_SETMASK, &unblocked, nullptr);  // without the thread signals end the process as ever
  }
}

}  // namespace meshlode::cli
