// SPDX-License-Identifier: GPL-3.0-or-later
// What a series of trials comes to: counts, the worst of each kind, and whether that is well.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "trial.h"

namespace meshlode::test {

/// A scene by name: a seed's or a file's.
struct Entry {
  std::string name, contents;
  std::uint64_t triangles = 0;
  std::vector<std::string> build_options;
  TrialResult result;
  bool was_skipped = false;
};

/// A series, entry by entry: it may be as long as a night.
struct Tally {
  std::uint64_t scenes = 0, clean = 0, refused = 0, failed = 0, triangles = 0, cuts = 0, cuts_above = 0,
                cuts_undecided = 0;
  double build_seconds = 0.0, total_seconds = 0.0, largest_ratio = 0.0;
  std::map<std::string, std::uint64_t> rules, refusals;
  std::string slowest;        ///< of scenes of 1,000 triangles and more
  double slowest_rate = 0.0;  ///< its processor seconds to build 10,000 triangles
  std::uint64_t slowest_triangles = 0;

  void add(const Entry& entry);
};

/// One line and what belongs to it, unless it is clean and they are not asked for.
void print_entry(const Entry& entry, bool verbose);

void print_tally(const Tally& tally);

/// Says what is not well and gives the exit code: 6 where a scene failed, where more were refused than may be, or where
/// more than 1% of the cuts of a long series deviate by more than they store (I7).
[[nodiscard]] int verdict(const Tally& tally, std::uint64_t max_refused_percent);

[[nodiscard]] std::string joined(const std::vector<std::string>& words);

}  // namespace meshlode::test
