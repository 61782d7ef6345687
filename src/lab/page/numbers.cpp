// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/numbers.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "base/printable.h"

namespace meshlode::lab::page {

namespace {

std::string plain(double value, int decimals) {
  std::array<char, 400> text{};
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed, decimals);
  std::string out(text.data(), end.ptr);
  if (out.find('.') != std::string::npos) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

struct Prefix {
  double factor;
  std::string_view unit;
};

/// With the largest of the units that the value has one of; the last where it has none.
template <std::size_t N>
std::string with_prefix(double value, const std::array<Prefix, N>& prefixes) {
  for (const Prefix& prefix : prefixes) {
    if (std::abs(value) >= prefix.factor || &prefix == &prefixes.back()) {
      return number_text(value / prefix.factor) + " " + std::string(prefix.unit);
    }
  }
  return {};
}

}  // namespace

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return value != value ? "-" : value > 0.0 ? "infinite" : "-infinite";
  if (value == 0.0) return "0";
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::scientific, digits - 1);
  const std::string_view written(text.data(), static_cast<std::size_t>(end.ptr - text.data()));
  const std::size_t mark = written.find('e');
  int exponent = 0;
  const char* const first = written.data() + mark + (written[mark + 1] == '+' ? 2 : 1);
  std::from_chars(first, end.ptr, exponent);
  if (exponent >= -4 && exponent < 7) {
    // What was rounded to the digits, so that 99999 to three of them is 100000.
    double rounded = value;
    std::from_chars(written.data(), end.ptr, rounded);
    return plain(rounded, digits - 1 > exponent ? digits - 1 - exponent : 0);
  }
  std::string mantissa(written.substr(0, mark));
  if (mantissa.find('.') != std::string::npos) {
    mantissa.erase(mantissa.find_last_not_of('0') + 1);
    if (mantissa.back() == '.') mantissa.pop_back();
  }
  return mantissa + "e" + std::to_string(exponent);
}

std::string amount_text(double value, std::string_view unit) {
  static constexpr std::array kSeconds = {Prefix{60.0, "min"}, Prefix{1.0, "s"}, Prefix{1e-3, "ms"},
                                          Prefix{1e-6, "µs"}};
  static constexpr std::array kBytes = {Prefix{1e9, "GB"}, Prefix{1e6, "MB"}, Prefix{1e3, "kB"}, Prefix{1.0, "B"}};
  if (!std::isfinite(value)) return number_text(value);
  if (unit == "seconds") {
    if (value == 0.0) return "0 s";
    return std::abs(value) < 120.0 && std::abs(value) >= 60.0 ? number_text(value) + " s"
                                                              : with_prefix(value, kSeconds);
  }
  if (unit == "bytes") return value == 0.0 ? "0 B" : with_prefix(value, kBytes);
  if (unit == "triangles" && value >= 0.0 && value < 0x1p53 && value == std::floor(value)) {
    return grouped_digits(static_cast<std::uint64_t>(value));
  }
  if (unit == "dB") return number_text(value) + " dB";
  if (unit == "degrees") return number_text(value) + "°";
  return number_text(value);
}

std::string change_text(double before, double after) {
  if (before == after) return "same";
  if (!std::isfinite(before) || !std::isfinite(after) || before == 0.0 || (before < 0.0) != (after < 0.0)) return "-";
  const double ratio = after / before;
  if (ratio >= 2.0) return "×" + number_text(ratio, 2);
  if (ratio <= 0.5) return ratio > 0.0 ? "÷" + number_text(1.0 / ratio, 2) : "-100%";
  const double percent = 100.0 * (ratio - 1.0);
  return (percent > 0.0 ? "+" : "") + number_text(percent, 2) + "%";
}

std::string coordinate(double value) {
  return std::isfinite(value) ? plain(value, 2) : "0";
}

double decimal(long long mantissa, int exponent) {
  const std::string text = std::to_string(mantissa) + "e" + std::to_string(exponent);
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace meshlode::lab::page
