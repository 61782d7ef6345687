// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "builder/pack/pack_section.h"
#include "format/section_columns.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A table as they are: ids that count, noise, fields that never change.
Bytes table(std::size_t records, std::uint32_t record_bytes, std::uint64_t seed) {
  test::Random random(seed);
  Bytes bytes(records * record_bytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t column = i % record_bytes;
    bytes[i] = static_cast<std::uint8_t>(column == 0 ? i / record_bytes : column < 4 ? random.below(16) : 0);
  }
  return bytes;
}

TEST(PackSection, TablesAndTextsComeBackAndShrink) {
  for (const std::uint32_t record_bytes : {0U, 8U, 24U, 28U, 56U}) {
    for (const std::size_t records : {300U, 1000U}) {
      const Bytes bytes = record_bytes == 0 ? table(records, 8, 1) : table(records, record_bytes, records);
      const Bytes packed = pack_section(bytes, record_bytes);
      ASSERT_FALSE(packed.empty()) << record_bytes;
      EXPECT_LT(packed.size(), bytes.size());
      Bytes out(bytes.size());
      ASSERT_TRUE(format::decode_section(packed, record_bytes, out));
      EXPECT_EQ(out, bytes);
    }
  }
}

TEST(PackSection, NoiseAndNothingAreStoredAsTheyAre) {
  test::Random random(8);
  Bytes noise(4096);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(random.next());
  EXPECT_TRUE(pack_section(noise, 4).empty());
  EXPECT_TRUE(pack_section({}, 4).empty());
}

TEST(PackSection, ASectionThatShrinksBeyondTheLimitIsStoredAsItIs) {
  EXPECT_TRUE(pack_section(Bytes(1 << 16U, 0), 4).empty());
}

// What a section asks for is held against its own bytes before there is room for it.
TEST(PackSection, SoundnessIsKnownWithoutDecoding) {
  for (const std::uint32_t record_bytes : {0U, 8U, 24U, 56U}) {
    const Bytes bytes = record_bytes == 0 ? table(400, 8, 1) : table(400, record_bytes, 3);
    const Bytes packed = pack_section(bytes, record_bytes);
    ASSERT_FALSE(packed.empty());
    EXPECT_TRUE(format::is_section_sound(packed, record_bytes, bytes.size()));
    for (std::size_t size = 0; size < packed.size(); ++size) {
      ASSERT_FALSE(format::is_section_sound(std::span(packed).first(size), record_bytes, bytes.size())) << size;
    }
    Bytes longer = packed;
    longer.push_back(0);
    EXPECT_FALSE(format::is_section_sound(longer, record_bytes, bytes.size()));
    EXPECT_FALSE(format::is_section_sound(packed, record_bytes, 0));
    // Eight records for each byte of a prefix code are the most that it can say.
    EXPECT_FALSE(format::is_section_sound(packed, record_bytes, std::uint64_t{1} << 40U));
    if (record_bytes != 0) {
      EXPECT_FALSE(format::is_section_sound(packed, record_bytes, bytes.size() + 1));
    }
  }
}

TEST(PackSection, WhatIsUnsoundDoesNotDecode) {
  const Bytes bytes = table(200, 24, 2);
  const Bytes packed = pack_section(bytes, 24);
  Bytes out(bytes.size());
  test::Random random(4);
  std::size_t unsound = 0;
  for (int i = 0; i < 3000; ++i) {
    Bytes changed = packed;
    changed[random.below(changed.size())] = static_cast<std::uint8_t>(random.next());
    if (format::is_section_sound(changed, 24, out.size())) continue;
    ++unsound;
    EXPECT_FALSE(format::decode_section(changed, 24, out));
  }
  EXPECT_GT(unsound, 20u);
}

TEST(PackSection, BrokenSectionsAreRefused) {
  const Bytes bytes = table(200, 24, 2);
  const Bytes packed = pack_section(bytes, 24);
  Bytes out(bytes.size());
  for (std::size_t size = 0; size < packed.size(); ++size) {
    EXPECT_FALSE(format::decode_section(std::span(packed).first(size), 24, out)) << size;
  }
  Bytes longer = packed;
  longer.push_back(0);
  EXPECT_FALSE(format::decode_section(longer, 24, out));
  EXPECT_FALSE(format::decode_section(packed, 24, std::span(out).first(out.size() - 1)));
  for (std::size_t at = 0; at < packed.size(); ++at) {  // any answer but a crash
    for (std::uint32_t bit = 0; bit < 8; ++bit) {
      Bytes flipped = packed;
      flipped[at] = static_cast<std::uint8_t>(flipped[at] ^ 1U << bit);
      (void)format::decode_section(flipped, 24, out);
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
