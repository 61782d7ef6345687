// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as text: for people, and for coordinates. No locale, the same on every machine.
#pragma once

#include <string>
#include <string_view>

namespace meshlode::lab::page {

/// At most `digits` significant digits, without trailing zeros: "0.0125", "1.3e-6", "12000". \pre 1 <= digits <= 17
[[nodiscard]] std::string number_text(double value, int digits = 3);

/// A figure with its unit as sweep.json names it: seconds as "83 ms", bytes as "1.25 MB" (powers of 1000), triangles as
/// "12,345", dB, degrees; shares and others as numbers.
[[nodiscard]] std::string amount_text(double value, std::string_view unit);

/// "+12%", "-3.4%", "×5.2" and "÷2" from a factor of two on; "same" where both are equal, "-" where it cannot be said.
[[nodiscard]] std::string change_text(double before, double after);

/// Of pixels: at most two decimals.
[[nodiscard]] std::string coordinate(double value);

/// mantissa times ten to the exponent, the nearest double to it.
[[nodiscard]] double decimal(long long mantissa, int exponent);

}  // namespace meshlode::lab::page
