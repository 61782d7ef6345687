// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/byte_size.h"

#include <gtest/gtest.h>

#include "base/amounts.h"

namespace meshlode {
namespace {

constexpr std::uint64_t kMiB = 1u << 20u;

TEST(ByteSize, ReadsUnitsAndNothingElse) {
  EXPECT_EQ(parse_byte_size("0"), 0u);
  EXPECT_EQ(parse_byte_size("71"), 71u);
  EXPECT_EQ(parse_byte_size("71B"), 71u);
  EXPECT_EQ(parse_byte_size("3KiB"), 3072u);
  EXPECT_EQ(parse_byte_size("512MiB"), 512 * kMiB);
  EXPECT_EQ(parse_byte_size("8GiB"), 8192 * kMiB);
  EXPECT_EQ(parse_byte_size("1MB"), 1'000'000U);
  EXPECT_EQ(parse_byte_size("2KB"), 2000U);
  EXPECT_EQ(parse_byte_size("3GB"), 3'000'000'000U);
  EXPECT_EQ(parse_byte_size("5K"), 5000U);
  EXPECT_EQ(parse_byte_size("16M"), 16'000'000U);
  EXPECT_EQ(parse_byte_size("4G"), 4'000'000'000U);
  EXPECT_EQ(parse_byte_size("4294967296GiB"), std::uint64_t{1} << 62u);
  for (const char* text : {"", "MiB", "-1", "+1", "1.5GiB", "1 MiB", "1mib", "1mb", "1Mi", "0x10", "4294967297GiB",
                           "18446744073709551616", "1MiBB"}) {
    EXPECT_FALSE(parse_byte_size(text)) << text;
  }
}

TEST(ByteSize, TextsAreExactOrRoundedUp) {
  EXPECT_EQ(byte_size_text(0), "0B");
  EXPECT_EQ(byte_size_text(1023), "1023B");
  EXPECT_EQ(byte_size_text(512 * kMiB), "512MiB");
  EXPECT_EQ(byte_size_text(512 * kMiB + 1), "512.1MiB");
  EXPECT_EQ(byte_size_text(1024 * kMiB - 1), "1024MiB");
  EXPECT_EQ(byte_size_text(1024 * kMiB), "1GiB");
  EXPECT_EQ(byte_size_text(1024 * kMiB + kMiB), "1.1GiB");
  for (std::uint64_t bytes = 1; bytes < std::uint64_t{1} << 62u; bytes = bytes * 7 + 3) {
    const std::string text = byte_size_text(bytes);
    if (text.find('.') == std::string::npos && bytes % 1024 == 0) {
      EXPECT_EQ(parse_byte_size(text), bytes);
    }
  }
}

TEST(Amounts, CountsTakeThousandsAndMillions) {
  EXPECT_EQ(parse_count("0"), 0u);
  EXPECT_EQ(parse_count("42"), 42u);
  EXPECT_EQ(parse_count("500K"), 500000u);
  EXPECT_EQ(parse_count("16M"), 16000000u);
  EXPECT_EQ(parse_count("4611686018427M"), 4611686018427000000u);
  for (const char* text :
       {"", "M", "-1", "+1", "1.5M", "1 M", "1m", "1KM", "1KiB", "0x10", "4611686018428M", "18446744073709551616"}) {
    EXPECT_FALSE(parse_count(text)) << text;
  }
}

TEST(Amounts, TheFirstUnitThatFitsCounts) {
  constexpr AmountUnit kUnits[] = {{"dozen", 12}, {"en", 100}};
  EXPECT_EQ(parse_amount("3dozen", kUnits, 36), 36u);
  EXPECT_FALSE(parse_amount("3dozen", kUnits, 35));
  EXPECT_EQ(parse_amount("3en", kUnits, 300), 300u);
}

}  // namespace
}  // namespace meshlode
