// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of a build on stderr: a bar on a terminal, a line per mesh and level elsewhere, nothing when quiet.
#pragma once

#include <cstddef>
#include <string>

#include "build/build.h"

namespace meshlode::cli {

class Progress {
 public:
  /// Input `index` of `count`.
  Progress(bool quiet, std::size_t index, std::size_t count);
  void start(const std::string& name);
  void finish();  ///< wipes the bar; may be called twice
  [[nodiscard]] build::ProgressCallback callback();

 private:
  void show(const build::ProgressEvent& event);

  bool quiet_;
  bool is_terminal_;
  bool has_bar_ = false;
  std::string prefix_;
  std::string name_;
  double fraction_ = 0.0;
};

}  // namespace meshlode::cli
