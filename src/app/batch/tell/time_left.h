// SPDX-License-Identifier: GPL-3.0-or-later
// How long a batch will still take: files are weighed by their bytes, and take as long as those before them did.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace meshlode::app {

class TimeLeft {
 public:
  /// Bytes of each file, and of what it names where that is known.
  explicit TimeLeft(std::vector<std::uint64_t> weights) : weights_(std::move(weights)) {}

  /// File `index` is done. One that was not built says nothing about those that will be.
  void finish(std::size_t index, double seconds, bool was_built);
  /// While file `index` is at `fraction` (0 to 1) after `elapsed` seconds. Nothing as long as there is little to go by:
  /// less than a second.
  [[nodiscard]] std::optional<double> seconds_left(std::size_t index, double fraction, double elapsed) const;
  /// The share of the whole batch that is done, 0 to 1.
  [[nodiscard]] double fraction_done(std::size_t index, double fraction) const;

 private:
  std::vector<std::uint64_t> weights_;
  double built_weight_ = 0.0, built_seconds_ = 0.0;
};

/// "45 s left", "3 min left", "2 h 05 min left".
[[nodiscard]] std::string time_left_text(double seconds);

}  // namespace meshlode::app
