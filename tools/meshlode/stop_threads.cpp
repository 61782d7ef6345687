// SPDX-License-Identifier: GPL-3.0-or-later
// A signal whose handler waits until the stop is over. Calls of the system that it interrupts are begun anew by the
// system (SA_RESTART), or by their callers.
#include "stop_threads.h"

#include <dirent.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace meshlode::cli {

namespace {

constinit std::atomic<std::uint32_t> the_stop = 0;  ///< 0: none; else its number
constinit std::atomic<std::uint32_t> standing = 0;

/// Ignored where nobody asks for it, and there once however often it was sent: some threads block all signals.
constexpr int kStopSignal = SIGURG;

void sleep_microseconds(long count) {
  const timespec time{0, count * 1000};
  (void)::nanosleep(&time, nullptr);
}

/// Only what a signal handler may do.
void stand(int /*signal*/) {
  const int before = errno;
  standing.fetch_add(1);
  const std::uint32_t stop = the_stop.load();
  while (stop != 0 && the_stop.load() == stop) sleep_microseconds(100);
  standing.fetch_sub(1);
  errno = before;
}

void install() {
  struct sigaction action {};
  action.sa_handler = stand;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  (void)::sigaction(kStopSignal, &action, nullptr);
}

}  // namespace

StoppedThreads::StoppedThreads() {
  static const bool is_installed = [] {
    install();
    return true;
  }();
  (void)is_installed;
  static std::uint32_t number = 0;
  DIR* const tasks = ::opendir("/proc/self/task");
  if (tasks == nullptr) return;
  if (++number == 0) ++number;
  the_stop.store(number);
  const auto self = static_cast<long>(::syscall(SYS_gettid));
  while (const dirent* const entry = ::readdir(tasks)) {
    const long thread = std::strtol(entry->d_name, nullptr, 10);
    if (thread <= 0 || thread == self) continue;
    if (::syscall(SYS_tgkill, ::getpid(), thread, kStopSignal) == 0) ++count_;
  }
  constexpr int kLooks = 10;  // some never stand
  for (int look = 0; look < kLooks && standing.load() < count_; ++look) sleep_microseconds(20);
  tasks_ = tasks;
}

StoppedThreads::~StoppedThreads() {
  the_stop.store(0);
  if (tasks_ != nullptr) ::closedir(static_cast<DIR*>(tasks_));
}

}  // namespace meshlode::cli
