// SPDX-License-Identifier: GPL-3.0-or-later
// What a batch shows on stderr while it runs: on a terminal a bar over the whole batch with the time left, and a line a
// file, elsewhere the lines alone. Nothing when quiet, but errors.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "app/batch/batch.h"
#include "app/batch/tell/time_left.h"

namespace meshlode::cli {

class BatchShow {
 public:
  /// `jobs` must outlive it. `has_lines`: a line for each file that did not fail.
  BatchShow(const std::vector<app::Job>& jobs, bool quiet, bool has_lines);
  [[nodiscard]] app::BatchWatcher watcher();

 private:
  void start(std::size_t job);
  void show(const builder::ProgressEvent& event);
  void end(std::size_t job, const app::JobResult& result, const Error* error);
  void wipe();

  const std::vector<app::Job>& jobs_;
  bool has_bar_, has_lines_;
  bool is_drawn_ = false;
  app::TimeLeft time_left_;
  std::size_t job_ = 0;
  std::string name_;
  double fraction_ = 0.0;  ///< of the job
  std::chrono::steady_clock::time_point started_;
};

}  // namespace meshlode::cli
