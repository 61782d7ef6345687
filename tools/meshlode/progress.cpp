// SPDX-License-Identifier: GPL-3.0-or-later
#include "progress.h"

#include <algorithm>
#include <cstdio>

#include <unistd.h>

namespace meshlode::cli {

Progress::Progress(bool quiet, std::size_t index, std::size_t count)
    : quiet_(quiet), is_terminal_(isatty(STDERR_FILENO) == 1) {
  if (count > 1) prefix_ = "[" + std::to_string(index + 1) + "/" + std::to_string(count) + "] ";
}

void Progress::start(const std::string& name) {
  name_ = name;
  for (char& c : name_) {
    if (static_cast<unsigned char>(c) < 0x20) c = '?';
  }
}

void Progress::finish() {
  if (has_bar_) std::fputs("\r\033[K", stderr);
  has_bar_ = false;
}

void Progress::show(const build::ProgressEvent& event) {
  std::string mesh = event.mesh_name.substr(0, 24);
  for (char& c : mesh) {
    if (static_cast<unsigned char>(c) < 0x20) c = '?';
  }
  if (!is_terminal_) {
    std::fprintf(stderr, "%s%s: mesh %u of %u %s level %u: %llu triangles\n", prefix_.c_str(), name_.c_str(),
                 event.mesh + 1, event.mesh_count, mesh.c_str(), event.level,
                 static_cast<unsigned long long>(event.triangles));
    return;
  }
  // Meshes finish in any order: a bar that runs backwards helps nobody.
  fraction_ = std::max(fraction_, std::clamp(event.fraction, 0.0, 1.0));
  constexpr int kWidth = 24;
  const int done = static_cast<int>(fraction_ * kWidth);
  const std::string bar =
      std::string(static_cast<std::size_t>(done), '#') + std::string(static_cast<std::size_t>(kWidth - done), '.');
  std::fprintf(stderr, "\r\033[K%s%.20s [%s] %3d%% mesh %u/%u %.12s level %u", prefix_.c_str(), name_.c_str(),
               bar.c_str(), static_cast<int>(100.0 * fraction_), event.mesh + 1, event.mesh_count, mesh.c_str(),
               event.level);
  std::fflush(stderr);
  has_bar_ = true;
}

build::ProgressCallback Progress::callback() {
  if (quiet_) return [](const build::ProgressEvent&) { return true; };
  return [this](const build::ProgressEvent& event) {
    show(event);
    return true;
  };
}

}  // namespace meshlode::cli
