// SPDX-License-Identifier: GPL-3.0-or-later
// Another codec for the pages of an asset gives the bytes that a build with that codec gives.
#include "builder/write/repack.h"

#include <cstring>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "builder/write_meta.h"
#include "judge/validate/validate.h"
#include "run/read/asset.h"
#include "run/unpack/unpack.h"
#include "support/old_codecs/old_codecs.h"
#include "support/reseal.h"
#include "support/sample_asset.h"

namespace meshlode::builder {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr format::Codec kCodecs[] = {format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd,
                                     format::Codec::kStrips, format::Codec::kDraco};

RepackInput input_of(const run::Asset& asset, format::Codec codec) {
  RepackInput input;
  for (const format::SectionEntry& entry : asset.sections()) {
    input.sections.push_back({entry, asset.section_bytes(entry)});
  }
  std::memcpy(input.content_hash.data(), asset.header().content_hash, input.content_hash.size());
  input.meta_json = meta_with_codec(asset.meta_json(), codec);
  input.load_page = [&asset](std::size_t p) -> Result<Bytes> {
    const auto page = run::load_page(asset, PageId{p});
    if (!page) return page.error();
    return Bytes(page->bytes().begin(), page->bytes().end());
  };
  input.codec = codec;
  input.pack = test::pack_page;
  return input;
}

/// Aborts the test where the asset cannot be opened.
Result<Bytes> repack(const Bytes& bytes, format::Codec codec) {
  const auto asset = run::Asset::from_bytes(bytes);
  if (!asset) return asset.error();
  return repack_asset(input_of(*asset, codec));
}

/// The sample's spheres are those of no real build, which some rules find: what a test asks is that no more do.
std::vector<std::string> findings_of(const Bytes& asset) {
  std::vector<std::string> out;
  for (const judge::Finding& finding : judge::validate_asset(asset).findings) {
    out.push_back(finding.id + " " + finding.where + ": " + finding.detail);
  }
  return out;
}

/// An asset whose file ends with a section that nobody knows, of bytes that have no meaning.
Bytes with_unknown_section(const Bytes& asset) {
  format::FileHeader header{};
  std::memcpy(&header, asset.data(), sizeof(header));
  std::vector<format::SectionEntry> entries(header.section_count);
  std::memcpy(entries.data(), asset.data() + sizeof(header), entries.size() * sizeof(entries[0]));
  const std::size_t first = entries.front().offset;
  // The table grows by 64 bytes, a multiple of 16: every section moves by as much.
  constexpr std::size_t kMove = sizeof(format::SectionEntry);
  Bytes out(first + kMove);
  out.insert(out.end(), asset.begin() + static_cast<std::ptrdiff_t>(first), asset.end());
  for (format::SectionEntry& entry : entries) entry.offset += kMove;
  out.resize((out.size() + 15) / 16 * 16);
  format::SectionEntry unknown{};
  unknown.id = format::four_cc('N', 'O', 'T', 'E');
  unknown.version = 7;
  unknown.codec = 99;
  unknown.offset = out.size();
  unknown.bytes = 5;
  unknown.decoded_bytes = 12345;
  entries.push_back(unknown);
  for (const char c : {'h', 'e', 'l', 'l', 'o'}) out.push_back(static_cast<std::uint8_t>(c));
  header.section_count += 1;
  header.file_bytes = out.size();
  std::memcpy(out.data(), &header, sizeof(header));
  std::memcpy(out.data() + sizeof(header), entries.data(), entries.size() * sizeof(entries[0]));
  const auto move_records = [&](format::SectionId id, auto record) {
    for (const format::SectionEntry& entry : entries) {
      if (entry.id != static_cast<std::uint32_t>(id)) continue;
      for (std::size_t at = entry.offset; at < entry.offset + entry.bytes; at += sizeof(record)) {
        std::memcpy(&record, out.data() + at, sizeof(record));
        record.offset += kMove;
        std::memcpy(out.data() + at, &record, sizeof(record));
      }
    }
  };
  move_records(format::SectionId::kPages, format::PageRecord{});
  move_records(format::SectionId::kBlobs, format::BlobRecord{});
  test::reseal(out);
  return out;
}

TEST(Repack, EveryCodecBecomesEveryOtherToTheByte) {
  for (const format::Codec from : kCodecs) {
    const Bytes asset = test::sample_asset_bytes(from);
    for (const format::Codec to : kCodecs) {
      const auto repacked = repack(asset, to);
      ASSERT_TRUE(repacked.ok()) << repacked.error().message();
      EXPECT_EQ(*repacked, test::sample_asset_bytes(to))
          << "from codec " << static_cast<int>(from) << " to " << static_cast<int>(to);
    }
  }
}

TEST(Repack, SameBytesForAnyNumberOfThreads) {  // I10
  const Bytes asset = test::sample_asset_bytes(format::Codec::kZstd);
  const auto expected = repack(asset, format::Codec::kStrips);
  ASSERT_TRUE(expected.ok());
  for (const int threads : {1, 2, 4}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { EXPECT_EQ(*repack(asset, format::Codec::kStrips), *expected); });
  }
}

TEST(Repack, ASectionThatNobodyKnowsStaysAsItIs) {
  const Bytes strange = with_unknown_section(test::sample_asset_bytes());
  ASSERT_EQ(findings_of(strange), findings_of(test::sample_asset_bytes()));
  for (const format::Codec codec : kCodecs) {
    const auto repacked = repack(strange, codec);
    ASSERT_TRUE(repacked.ok()) << repacked.error().message();
    const auto asset = run::Asset::from_bytes(*repacked);
    ASSERT_TRUE(asset.ok()) << asset.error().message();
    EXPECT_EQ(findings_of(*repacked), findings_of(strange)) << "places and checksums are as sound as they were";
    const format::SectionEntry& entry = asset->sections().back();
    EXPECT_EQ(entry.id, format::four_cc('N', 'O', 'T', 'E'));
    EXPECT_EQ(entry.version, 7U);
    EXPECT_EQ(entry.codec, 99U);
    EXPECT_EQ(entry.flags, 0U);
    EXPECT_EQ(entry.decoded_bytes, 12345U);
    EXPECT_EQ(entry.checksum, run::Asset::from_bytes(strange)->sections().back().checksum);
    const auto bytes = asset->section_bytes(entry);
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "hello");
    const auto back = repack(*repacked, format::Codec::kNone);
    ASSERT_TRUE(back.ok()) << back.error().message();
    EXPECT_EQ(*back, strange);
  }
}

TEST(Repack, APageThatDoesNotLoadIsAnError) {
  Bytes asset = test::sample_asset_bytes();
  const std::uint64_t page = test::section_offset(asset, format::SectionId::kPageData);
  asset[page + 40] ^= 1U;
  const auto repacked = repack(asset, format::Codec::kZstd);
  ASSERT_FALSE(repacked.ok());
  EXPECT_EQ(repacked.error().code, ErrorCode::kInvalid);
  EXPECT_EQ(repacked.error().where, "page 0, field checksum");
}

/// One byte of any page, with checksums that are right again: never a crash, and what comes out says the same.
TEST(Repack, AChangedPageIsRefusedOrComesBack) {
  const Bytes sound = test::sample_asset_bytes();
  const auto first = static_cast<std::size_t>(test::section_offset(sound, format::SectionId::kPageData));
  std::size_t refused = 0, kept = 0;
  for (std::size_t at = first; at < sound.size() && at < first + 1024; at += 5) {
    Bytes changed = sound;
    changed[at] ^= static_cast<std::uint8_t>(1U << (at % 8));
    test::reseal(changed);
    const auto packed = repack(changed, format::Codec::kStrips);
    if (!packed) {
      ++refused;
      continue;
    }
    const auto back = repack(*packed, format::Codec::kNone);
    ASSERT_TRUE(back.ok()) << at << ": " << back.error().message();
    EXPECT_EQ(*back, changed) << at;
    ++kept;
  }
  EXPECT_GT(refused, 0U);
  EXPECT_GT(kept, 0U);
}

TEST(RepackMeta, OnlyTheCodecOfTheSettingsChanges) {
  const auto lz4 = [](std::string_view text) { return meta_with_codec(text, format::Codec::kLz4); };
  EXPECT_EQ(lz4(R"({"settings":{"codec":"zstd","grid":1.50}})"), R"({"settings":{"codec":"lz4","grid":1.50}})");
  EXPECT_EQ(lz4("{ \"settings\" : { \"a\" : [\"codec\", {\"codec\":\"x\"}],\n \"codec\" :\t\"none\" } }"),
            "{ \"settings\" : { \"a\" : [\"codec\", {\"codec\":\"x\"}],\n \"codec\" :\t\"lz4\" } }");
  EXPECT_EQ(lz4(R"({"plan":["settings"],"x\"settings":{"codec":"a"},"settings":{"b\\":"}","codec":"\"zstd"}})"),
            R"({"plan":["settings"],"x\"settings":{"codec":"a"},"settings":{"b\\":"}","codec":"lz4"}})");
}

TEST(RepackMeta, AnyOtherTextStaysAsItIs) {
  for (const std::string& text :
       {std::string(), std::string("{}"), std::string(R"({"codec":"zstd"})"), std::string(R"({"settings":"codec"})"),
        std::string(R"({"settings":{"codec":5}})"), std::string(R"({"settings":{"codec":["zstd"]}})"),
        std::string(R"({"settings":["codec","zstd"]})"), std::string(R"([{"settings":{"codec":"zstd"}}])"),
        std::string(R"({"settings":{"deeper":{"codec":"zstd"}}})"), std::string(R"({"settings":{"codec":"zstd"})"),
        std::string("{\"settings\":{\"codec\":\"\xFF\"}}"), std::string("{}\0\"settings", 12), std::string("\"\\")}) {
    EXPECT_EQ(meta_with_codec(text, format::Codec::kLz4), text);
  }
}

}  // namespace
}  // namespace meshlode::builder
