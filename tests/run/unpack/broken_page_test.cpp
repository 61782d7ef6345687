// SPDX-License-Identifier: GPL-3.0-or-later
// Stored pages that are cut, flipped or made up (I11). Under sanitizers these tests say that nothing is read or written
// outside; here they say that broken bytes never pass for the page.
#include <cstring>

#include <gtest/gtest.h>

#include "format/page_streams.h"
#include "run/unpack/unpack_page.h"
#include "support/old_codecs/old_codecs.h"
#include "support/random.h"
#include "support/random_page.h"

namespace meshlode::run {
namespace {

using format::Codec;
using test::RandomPage;

struct Stored {
  RandomPage page;
  format::PageRecord record;
  std::vector<std::uint8_t> bytes;
};

Stored store(const test::RandomPageOptions& options, Codec codec) {
  Stored stored{test::make_random_page(options), {}, {}};
  const auto bytes = test::store_page(
      stored.page.mesh, {reinterpret_cast<const std::uint8_t*>(stored.page.words.data()), stored.page.words.size() * 4},
      codec);
  EXPECT_TRUE(bytes);
  stored.record = stored.page.record;
  stored.record.codec = codec;
  stored.bytes = *bytes;
  return stored;
}

/// The page that came out, or nothing.
std::vector<std::uint32_t> unpacked(const Stored& stored, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint32_t> out(stored.page.words.size());
  if (unpack_page(stored.page.mesh, stored.record, bytes, out) != UnpackOutcome::kOk) out.clear();
  return out;
}

constexpr Codec kCodecs[] = {Codec::kLz4, Codec::kZstd, Codec::kStrips, Codec::kDraco};

const test::RandomPageOptions kSmall{.seed = 31,
                                     .cluster_count = 12,
                                     .uv_set_count = 2,
                                     .has_color = true,
                                     .has_material_ranges = true,
                                     .max_triangles = 30,
                                     .max_field_bits = 2};

TEST(BrokenPage, EveryTruncationIsRefused) {
  for (const Codec codec : kCodecs) {
    const Stored stored = store(kSmall, codec);
    ASSERT_EQ(unpacked(stored, stored.bytes), stored.page.words);
    for (std::size_t size = 0; size < stored.bytes.size(); ++size) {
      std::vector<std::uint8_t> cut(stored.bytes.begin(), stored.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_TRUE(unpacked(stored, cut).empty()) << "codec " << static_cast<int>(codec) << ", size " << size;
    }
  }
}

TEST(BrokenPage, MoreBytesThanThePageIsRefused) {
  for (const Codec codec : kCodecs) {
    Stored stored = store(kSmall, codec);
    stored.bytes.push_back(0);
    EXPECT_TRUE(unpacked(stored, stored.bytes).empty()) << static_cast<int>(codec);
  }
}

TEST(BrokenPage, FlippedBitsAreSurvived) {
  for (const Codec codec : kCodecs) {
    const Stored stored = store(kSmall, codec);
    std::size_t refused = 0;
    for (std::size_t bit = 0; bit < stored.bytes.size() * 8; bit += 3) {  // every bit's turn comes within three bytes
      std::vector<std::uint8_t> flipped = stored.bytes;
      flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ 1U << bit % 8);
      if (unpacked(stored, flipped).empty()) ++refused;
    }
    EXPECT_GT(refused, 0U);  // the others are for the checksum
  }
}

TEST(BrokenPage, RandomBytesBehindASoundHeaderAreSurvived) {
  test::Random random(77);
  for (const Codec codec : kCodecs) {
    const Stored stored = store(kSmall, codec);
    for (int round = 0; round < 2000; ++round) {
      std::vector<std::uint8_t> bytes = stored.bytes;
      format::StoredHeader header;
      std::memcpy(&header, bytes.data(), sizeof(header));
      // Side information stays sound in half of the rounds, so that the streams behind it are reached.
      const std::size_t from = sizeof(header) + (round % 2 == 0 ? header.side_stored : 0U);
      const std::size_t first = from + random.below(bytes.size() - from);
      const std::size_t last = std::min(bytes.size(), first + 1 + random.below(64));
      for (std::size_t i = first; i < last; ++i) bytes[i] = static_cast<std::uint8_t>(random.next());
      (void)unpacked(stored, bytes);
    }
  }
}

/// The numbers that memory is taken by are lies.
TEST(BrokenPage, CountsThatNothingJustifiesAreRefused) {
  for (const Codec codec : kCodecs) {
    const Stored stored = store(kSmall, codec);
    for (std::size_t field = 0; field < sizeof(format::StoredHeader) / 4; ++field) {
      for (const std::uint32_t lie : {0xFFFFFFFFU, 0x7FFFFFFFU, 0x00FFFFFFU}) {
        std::vector<std::uint8_t> bytes = stored.bytes;
        std::memcpy(bytes.data() + 4 * field, &lie, sizeof(lie));
        EXPECT_TRUE(unpacked(stored, bytes).empty()) << "field " << field;
      }
    }
  }
}

/// A page table that calls for another page than the stored one: more or fewer clusters, another size.
TEST(BrokenPage, AnotherPageTableIsRefused) {
  for (const Codec codec : kCodecs) {
    Stored stored = store(kSmall, codec);
    for (const std::uint32_t count : {0U, 1U, 11U, 13U, 6000U, 0xFFFFFFFFU}) {
      stored.record.cluster_count = count;
      EXPECT_TRUE(unpacked(stored, stored.bytes).empty()) << count;
    }
    stored.record.cluster_count = stored.page.record.cluster_count;
    for (const std::size_t words :
         {std::size_t{0}, std::size_t{2}, std::size_t{3}, stored.page.words.size() - 1, stored.page.words.size() + 1}) {
      std::vector<std::uint32_t> out(words);
      EXPECT_NE(unpack_page(stored.page.mesh, stored.record, stored.bytes, out), UnpackOutcome::kOk) << words;
    }
  }
}

/// The mesh's record says that vertices have other attributes.
TEST(BrokenPage, AnotherMeshIsSurvived) {
  for (const Codec codec : kCodecs) {
    Stored stored = store(kSmall, codec);
    for (std::uint32_t sets = 0; sets <= format::kMaxUvSets; ++sets) {
      stored.page.mesh.uv_set_count = sets;
      for (const std::uint32_t has_color : {0U, 1U}) {
        stored.page.mesh.has_color = has_color;
        (void)unpacked(stored, stored.bytes);
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::run
