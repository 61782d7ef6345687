// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/bar.h"

#include <algorithm>
#include <cmath>

namespace meshlode::app {

std::string bar(double fraction, int width, BarStyle style) {
  const int parts = style == BarStyle::kBlocks ? 8 : 1;
  int filled = 0;
  if (fraction > 0.0) {
    filled = static_cast<int>(std::lround(std::min(fraction, 1.0) * width * parts));
    filled = std::max(filled, 1);
  }
  std::string text;
  for (int cell = 0; cell < width; ++cell) {
    const int part = std::clamp(filled - cell * parts, 0, parts);
    if (style == BarStyle::kAscii) {
      text += part > 0 ? '#' : '.';
    } else if (part == 0) {
      text += ' ';
    } else {
      // U+2588 is a full block, U+258F an eighth.
      text += "\xE2\x96";
      text += static_cast<char>(0x90 - part);
    }
  }
  return text;
}

double error_fraction(double error, double largest) {
  if (!(error > 0.0) || !(largest > 0.0)) return 0.0;
  return std::sqrt(std::min(error / largest, 1.0));
}

}  // namespace meshlode::app
