// SPDX-License-Identifier: GPL-3.0-or-later
// Series of trials: seeds by number, seeds by the clock, and scenes of a folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "arguments.h"

namespace meshlode::test {

/// A folder for trials that goes with the object.
class WorkFolder {
 public:
  WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The GLB, and its build options beside it.
[[nodiscard]] bool write_scene(const std::filesystem::path& path, const RandomScene& scene);

/// The seed's scene made small while `rule` still finds something.
[[nodiscard]] RandomScene shrunk(std::uint64_t seed, const std::string& rule, const Arguments& arguments,
                                 const std::filesystem::path& folder);

// Exit codes: verdict() of tally.h.
[[nodiscard]] int run_seeds(const Arguments& arguments, const std::vector<std::uint64_t>& seeds);
/// Seeds from `first` on until the time is over; scenes that were begun by then are finished. Says once a minute, on
/// stderr, how far it came.
[[nodiscard]] int soak(const Arguments& arguments, std::uint64_t first, double minutes);
[[nodiscard]] int replay(const Arguments& arguments, const std::filesystem::path& folder);

}  // namespace meshlode::test
