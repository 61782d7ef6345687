// SPDX-License-Identifier: GPL-3.0-or-later
// Any byte string is either refused or can be read to its end: opened, every page loaded, every cluster decoded to
// finite floats, every name and blob touched (I11). The sanitizers of the sanitized build are the judges.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "run/decode/decode.h"
#include "support/random.h"
#include "support/sample_asset.h"
#include "support/sanitized.h"

namespace meshlode::run {
namespace {

enum class Outcome { kRefused, kPageRefused, kRead };

std::uint64_t touch(std::string_view text) {
  std::uint64_t sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return sum;
}

/// Reads all that an asset has. Vectors hold the exact bytes, so that the address sanitizer sees the end.
Outcome read_everything(std::span<const std::uint8_t> bytes) {
  const auto asset = Asset::from_vector({bytes.begin(), bytes.end()});
  if (!asset) {
    EXPECT_FALSE(asset.error().detail.empty());
    return Outcome::kRefused;
  }
  std::uint64_t sum = touch(asset->meta_json()) + touch(asset->scene_json());
  for (const auto& mesh : asset->meshes()) sum += touch(asset->string(mesh.name));
  for (const auto& material : asset->materials()) sum += touch(asset->string(material.name));
  for (const auto& instance : asset->instances()) sum += touch(asset->string(instance.name));
  for (const auto& blob : asset->blobs()) {
    sum += touch(asset->string(blob.name)) + touch(asset->string(blob.mime_type));
    for (const std::uint8_t byte : asset->blob_bytes(blob)) sum += byte;
  }
  Outcome outcome = Outcome::kRead;
  DecodedCluster cluster;
  ClusterAttributes attributes;
  for (std::size_t p = 0; p < asset->pages().size(); ++p) {
    const auto page = load_page(*asset, PageId{p});
    if (!page) {
      outcome = Outcome::kPageRefused;
      continue;
    }
    const format::PageRecord& record = asset->pages()[p];
    for (std::uint32_t i = 0; i < record.cluster_count; ++i) {
      const ClusterId id{record.first_cluster + i};
      decode_cluster(*asset, *page, id, cluster);
      const format::GroupRecord& group = asset->groups()[asset->clusters()[id.value].coarser_group];
      decode_attributes(asset->meshes()[group.mesh], cluster, attributes);
      for (const Vec3f& v : attributes.positions) {
        EXPECT_TRUE(std::isfinite(v.x) || asset->meshes()[group.mesh].grid.log2 > 70);
      }
      for (const Vec3f& v : attributes.normals) EXPECT_TRUE(std::isfinite(v.x + v.y + v.z));
      for (const auto& triangle : cluster.triangles) sum += attributes.positions[triangle[0]].x > 0.0F ? 1 : 0;
      for (const std::uint32_t material : cluster.triangle_material) sum += asset->materials()[material].double_sided;
    }
  }
  volatile std::uint64_t keep = sum;
  (void)keep;
  return outcome;
}

/// How thorough: the sanitized build is about fifteen times slower, and both stay within seconds.
std::size_t stride_of(std::size_t size, std::size_t most) {
  return std::max<std::size_t>(1, size * (test::kIsSanitized ? 3 : 1) / most);
}

TEST(Malformed, EveryTruncationIsRefused) {
  const auto bytes = test::sample_asset_bytes(format::Codec::kZstd);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_EQ(read_everything(std::span(bytes).first(size)), Outcome::kRefused) << size << " bytes";
  }
}

TEST(Malformed, EveryTruncationIsRefusedWithTheHeaderMadeToFit) {
  const auto bytes = test::sample_asset_bytes();
  for (std::size_t size = sizeof(format::FileHeader); size < bytes.size(); ++size) {
    std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const std::uint64_t file_bytes = size;
    std::memcpy(cut.data() + offsetof(format::FileHeader, file_bytes), &file_bytes, sizeof(file_bytes));
    test::reseal(cut);
    ASSERT_EQ(read_everything(cut), Outcome::kRefused) << size << " bytes";
  }
}

// Checksums cover every byte but those of blobs, whose own checksums the reader leaves to validate.
TEST(Malformed, EveryChangedByteIsSeen) {
  for (const format::Codec codec : {format::Codec::kNone, format::Codec::kZstd, format::Codec::kStrips}) {
    auto bytes = test::sample_asset_bytes(codec);
    const std::uint64_t blobs = test::section_offset(bytes, format::SectionId::kBlobData);
    const std::size_t stride = (codec == format::Codec::kNone ? 1 : 5) * (test::kIsSanitized ? 3 : 1);
    for (std::size_t at = 0; at < bytes.size(); at += stride) {
      bytes[at] ^= 0x10U;
      const Outcome outcome = read_everything(bytes);
      bytes[at] ^= 0x10U;
      if (at < blobs) {
        ASSERT_NE(outcome, Outcome::kRead) << "byte " << at;
      }
    }
  }
}

TEST(Malformed, EveryFlippedBitWithChecksumsMadeToFitIsRefusedOrRead) {
  for (const format::Codec codec : {format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd,
                                    format::Codec::kStrips, format::Codec::kDraco}) {
    const auto bytes = test::sample_asset_bytes(codec);
    test::Random random(21);
    std::size_t counts[3] = {};
    for (std::size_t at = 0; at < bytes.size(); at += stride_of(bytes.size(), 5000)) {
      auto broken = bytes;
      broken[at] ^= static_cast<std::uint8_t>(1U << random.below(8));
      test::reseal(broken);
      ++counts[static_cast<int>(read_everything(broken))];
    }
    EXPECT_GT(counts[0], 100U) << "the checks behind the checksums were reached";
    EXPECT_GT(counts[1], 100U);
  }
}

TEST(Malformed, PromisesWithFlippedBitsAreRefusedOrRead) {
  for (const format::Codec codec : {format::Codec::kNone, format::Codec::kStrips}) {
    const auto bytes = test::promised_asset_bytes(codec);
    const std::uint64_t begin = test::section_offset(bytes, format::SectionId::kPromises);
    const std::uint64_t end = test::section_offset(bytes, format::SectionId::kPageData);
    std::size_t counts[3] = {};
    for (std::uint64_t at = begin; at < end; ++at) {
      for (int bit = 0; bit < 8; ++bit) {
        auto broken = bytes;
        broken[at] ^= static_cast<std::uint8_t>(1U << bit);
        test::reseal(broken);
        ++counts[static_cast<int>(read_everything(broken))];
        auto asset = Asset::from_vector(std::move(broken));
        for (const format::Promise promise : {format::Promise::kTexels, format::Promise::kAppearance}) {
          if (!asset || !asset->has_promise(promise)) continue;
          const auto promised = asset->with_promise(promise);
          ASSERT_TRUE(promised);
          for (const format::NodeRecord& node : promised->nodes()) ASSERT_TRUE(node.error >= 0.0F);
        }
      }
    }
    EXPECT_GT(counts[0], 100U) << "the checks behind the checksums were reached";
  }
}

// Words become the values that break arithmetic: zero, all ones, one less than overflow, another word of the file.
TEST(Malformed, RandomWordsWithChecksumsMadeToFitAreRefusedOrRead) {
  const char* more = std::getenv("MESHLODE_FUZZ_ROUNDS");
  const int rounds = more != nullptr ? std::atoi(more) : test::kIsSanitized ? 2000 : 6000;
  for (const format::Codec codec : {format::Codec::kNone, format::Codec::kZstd, format::Codec::kStrips}) {
    const auto bytes = test::sample_asset_bytes(codec);
    const std::uint64_t pages = test::section_offset(bytes, format::SectionId::kPageData);
    test::Random random(22);
    std::size_t counts[3] = {};
    for (int round = 0; round < rounds; ++round) {
      auto broken = bytes;
      const std::uint64_t changes = 1 + random.below(3);
      for (std::uint64_t i = 0; i < changes; ++i) {
        // Half in the tables, half anywhere.
        const std::uint64_t range = random.below(2) == 0 ? pages : broken.size() - 4;
        const std::uint64_t at = random.below(range / 4) * 4;
        std::uint32_t word = 0;
        std::memcpy(&word, broken.data() + at, 4);
        const std::uint64_t other = random.below(broken.size() / 4) * 4;
        switch (random.below(8)) {
          case 0: word = 0; break;
          case 1: word = 0xFFFFFFFFU; break;
          case 2: word = 0x7FFFFFFFU; break;
          case 3: word += 1; break;
          case 4: word -= 1; break;
          case 5: word = static_cast<std::uint32_t>(random.next()); break;
          case 6: std::memcpy(&word, broken.data() + other, 4); break;
          default: word = static_cast<std::uint32_t>(random.below(64)); break;
        }
        std::memcpy(broken.data() + at, &word, 4);
      }
      test::reseal(broken);
      ++counts[static_cast<int>(read_everything(broken))];
      if (HasFailure()) {
        FAIL() << "seed 22, round " << round;
      }
    }
    EXPECT_GT(counts[0], 100U);
    EXPECT_GT(counts[1], 10U);
    EXPECT_GT(counts[2], 10U) << "some changes are harmless";
  }
}

TEST(Malformed, NoiseIsRefused) {
  test::Random random(23);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint8_t> noise(random.below(4096));
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random.next());
    if (noise.size() >= 8) std::memcpy(noise.data(), "LODE\0\0\0\0", 8);
    test::reseal(noise);
    ASSERT_EQ(read_everything(noise), Outcome::kRefused) << "seed 23, round " << round;
  }
}

}  // namespace
}  // namespace meshlode::run
