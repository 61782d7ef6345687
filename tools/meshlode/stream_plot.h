// SPDX-License-Identifier: GPL-3.0-or-later
// The errors of a simulation over time, as a picture.
#pragma once

#include <string>

#include "app/stream/report.h"

namespace meshlode::cli {

/// An SVG document: the largest error of the frames for the first eight runs.
[[nodiscard]] std::string stream_plot(const app::StreamReport& report);

}  // namespace meshlode::cli
