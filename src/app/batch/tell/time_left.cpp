// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/tell/time_left.h"

#include <algorithm>
#include <cmath>

#include "base/append_format.h"

namespace meshlode::app {

void TimeLeft::finish(std::size_t index, double seconds, bool was_built) {
  if (!was_built) return;
  built_weight_ += static_cast<double>(weights_[index]);
  built_seconds_ += seconds;
}

std::optional<double> TimeLeft::seconds_left(std::size_t index, double fraction, double elapsed) const {
  const double current = static_cast<double>(weights_[index]);
  const double seconds = built_seconds_ + elapsed, done = built_weight_ + current * fraction;
  if (seconds < 1.0 || !(done > 0.0)) return std::nullopt;
  double left = current * (1.0 - fraction);
  for (std::size_t i = index + 1; i < weights_.size(); ++i) left += static_cast<double>(weights_[i]);
  return left * seconds / done;
}

double TimeLeft::fraction_done(std::size_t index, double fraction) const {
  double all = 0.0, done = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const double weight = static_cast<double>(weights_[i]);
    all += weight;
    done += i < index ? weight : i == index ? weight * fraction : 0.0;
  }
  return all > 0.0 ? done / all : fraction;
}

std::string time_left_text(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::ceil(std::clamp(seconds, 0.0, 3600.0 * 1000.0)));
  std::string text;
  if (whole < 100) {
    append_format(text, "%llu s left", static_cast<unsigned long long>(whole));
  } else if (whole < 3600) {
    append_format(text, "%llu min left", static_cast<unsigned long long>((whole + 30) / 60));
  } else {
    append_format(text, "%llu h %02llu min left", static_cast<unsigned long long>(whole / 3600),
                  static_cast<unsigned long long>(whole % 3600 / 60));
  }
  return text;
}

}  // namespace meshlode::app
