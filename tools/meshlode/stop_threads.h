// SPDX-License-Identifier: GPL-3.0-or-later
// Holds the other threads of the process where they are for a moment: they touch no memory meanwhile.
#pragma once

#include <cstddef>

namespace meshlode::cli {

/// One at a time. Whatever a thread holds when it is stopped it goes on holding: until the end of the stop nothing may
/// be asked for that it could hold, memory of the C library and locks among it.
class StoppedThreads {
 public:
  /// Stops all but the calling thread, and waits until they stand, though not for long: one that is inside the system
  /// stands when it comes back from there.
  StoppedThreads();
  ~StoppedThreads();
  StoppedThreads(const StoppedThreads&) = delete;
  StoppedThreads& operator=(const StoppedThreads&) = delete;

  [[nodiscard]] std::size_t count() const { return count_; }  ///< that were told to stop

 private:
  std::size_t count_ = 0;
  void* tasks_ = nullptr;  ///< the list of threads, freed when they go on
};

}  // namespace meshlode::cli
