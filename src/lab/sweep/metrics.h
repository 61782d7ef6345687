// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of a point: their names, which is better, and how repeated ones become one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshlode::lab {

struct Metric {
  const char* key;
  const char* title;
  const char* unit;
  bool is_less_better;
  const char* group;  ///< build, size, accuracy, triangles, load, picture
  bool is_timed;      ///< differs from run to run
  const char* description;
};

/// In the order of columns. Keys never change their meaning.
[[nodiscard]] std::span<const Metric> all_metrics();
/// Nothing for another word. Short words that people say ("bytes", "time") are known too.
[[nodiscard]] const Metric* find_metric(std::string_view word);
/// Keys, then the short words.
[[nodiscard]] std::vector<std::string> metric_words();

/// Shares of a mesh's diagonal at which the fewest triangles are figures.
constexpr double kAtMax = 1e-3, kAtRms = 3e-4;

/// Repeated measurements of one metric.
struct Figure {
  double value = 0.0;  ///< the median; of an even number the mean of the middle two
  double min = 0.0, max = 0.0;
  std::uint32_t count = 0;
};
/// \pre not empty
[[nodiscard]] Figure figure_of(std::vector<double> values);

/// By the metric's key.
using Figures = std::map<std::string, Figure>;

/// What a figure may have been. One measurement of processor time stands for a spread that is assumed
/// (kAssumedSpread); one of any other time says nothing about its spread.
struct FigureRange {
  double low = 0.0, high = 0.0;
};
/// A single build's processor time is taken to be off by a quarter either way, and by 20 ms.
constexpr double kAssumedSpread = 0.25, kAssumedSeconds = 0.02;
/// Nothing where the figure cannot be compared: a time that was measured once.
[[nodiscard]] std::optional<FigureRange> range_of(const Metric& metric, const Figure& figure);
/// Whether the range is an assumed one.
[[nodiscard]] bool is_assumed(const Metric& metric, const Figure& figure);

/// Whether one figure is better than another beyond doubt: their ranges do not touch.
[[nodiscard]] bool is_clearly_better(const Metric& metric, const Figure& a, const Figure& b);

}  // namespace meshlode::lab
