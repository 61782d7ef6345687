// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as lengths, for people.
#pragma once

#include <string>

namespace meshlode::app {

enum class BarStyle {
  kAscii,   ///< "####......", for pipes and files: the same bytes whoever is looking
  kBlocks,  ///< eighths of a character, in UTF-8
};

/// `width` characters, of which `fraction` is filled; what is not between 0 and 1 is taken to the nearer end, and NaN
/// to 0. A fraction above 0 is never shown as nothing.
[[nodiscard]] std::string bar(double fraction, int width, BarStyle style);

/// Where an error stands among those of its mesh: the square root of its share of the largest, so that a bar is half as
/// long for a quarter of the error. Errors grow by a factor from level to level: by their own lengths all bars but
/// those of the coarsest levels would be empty. 0 for what is not above 0.
[[nodiscard]] double error_fraction(double error, double largest);

}  // namespace meshlode::app
