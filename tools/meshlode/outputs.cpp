// SPDX-License-Identifier: GPL-3.0-or-later
// Signals are taken by a thread that waits for them, not by a handler: it may lock what a write under way holds, so
// that none of its steps is cut in two.
#include "outputs.h"

#include <csignal>
#include <system_error>
#include <thread>

#include <unistd.h>

namespace meshlode::cli {

namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

const char* name_of(int signal) {
  return signal == SIGINT ? "SIGINT" : signal == SIGTERM ? "SIGTERM" : "SIGHUP";
}

[[noreturn]] void end_process(int signal) {
  output_files().abandon();
  std::string line = std::string("meshlode: interrupted by ") + name_of(signal) + "\n";
  if (::isatty(STDERR_FILENO) == 1) line = "\r\033[K" + line;  // over the progress bar
  if (::write(STDERR_FILENO, line.data(), line.size()) < 0) {
    // Nobody is left to tell.
  }
  ::_exit(static_cast<int>(ErrorCode::kIo));
}

}  // namespace

OutputFiles& output_files() {
  // Never destroyed: the thread that waits for signals may need it while the process ends.
  static auto* const files = new OutputFiles;
  return *files;
}

Status write_text(const std::string& path, const std::string& text) {
  return output_files().write(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
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
  static_cast<void>(output_files());  // made before there are two threads
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
