// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement as one line of JSON, and back. The line comes from a file: nothing in it is trusted.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lab/sweep/measurement.h"

namespace meshlode::lab {

[[nodiscard]] std::string measurement_line(const Measurement& measurement);
/// Nothing for a text that measurement_line() does not write.
[[nodiscard]] std::optional<Measurement> read_measurement(std::string_view line);

}  // namespace meshlode::lab
