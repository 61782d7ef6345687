// SPDX-License-Identifier: MIT
#include "base/byte_size.h"

#include <utility>

#include "base/amounts.h"

namespace meshlode {

namespace {

constexpr std::pair<std::string_view, unsigned> kUnits[] = {{"GiB", 30}, {"MiB", 20}, {"KiB", 10}, {"B", 0}};

}  // namespace

std::optional<std::uint64_t> parse_byte_size(std::string_view text) {
  constexpr std::uint64_t kOne = 1, kKilo = 1000;
  constexpr AmountUnit kFactors[] = {{"GiB", kOne << 30U},
                                     {"MiB", kOne << 20U},
                                     {"KiB", kOne << 10U},
                                     {"GB", kKilo * kKilo * kKilo},
                                     {"MB", kKilo * kKilo},
                                     {"KB", kKilo},
                                     {"G", kKilo * kKilo * kKilo},
                                     {"M", kKilo * kKilo},
                                     {"K", kKilo},
                                     {"B", 1}};
  return parse_amount(text, kFactors, std::uint64_t{1} << 62U);
}

std::string byte_size_text(std::uint64_t bytes) {
  for (const auto& [unit, shift] : kUnits) {
    const std::uint64_t one = std::uint64_t{1} << shift;
    if (bytes < one && shift != 0) continue;
    const std::uint64_t whole = bytes >> shift, rest = bytes & (one - 1);
    if (rest == 0) return std::to_string(whole) + std::string(unit);
    const std::uint64_t tenths = (rest * 10 + one - 1) >> shift;  // rest < 2^30
    return tenths == 10 ? std::to_string(whole + 1) + std::string(unit)
                        : std::to_string(whole) + "." + std::to_string(tenths) + std::string(unit);
  }
  return "0B";
}

}  // namespace meshlode
