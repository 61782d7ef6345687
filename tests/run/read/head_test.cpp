// SPDX-License-Identifier: GPL-3.0-or-later
// An asset by its head: what the tables say is as of the whole file, pages come from bytes that the caller hands in,
// and a head that is cut off or hostile is refused at its place.
#include <algorithm>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "base/hash.h"
#include "run/read/asset.h"
#include "run/read/find_image.h"
#include "run/read/json_text.h"
#include "run/read/sections.h"
#include "run/select/resident.h"
#include "run/unpack/unpack.h"
#include "support/random.h"
#include "support/sample_asset.h"

namespace meshlode::run {
namespace {

using Bytes = std::vector<std::uint8_t>;
using format::SectionId;

std::uint64_t head_size(const Bytes& file) {
  const auto head = find_head(file, file.size());
  EXPECT_TRUE(head.ok() && head->is_known);
  return head.ok() ? head->bytes : 0;
}

Bytes first_bytes(const Bytes& file, std::size_t count) {
  return {file.begin(), file.begin() + static_cast<std::ptrdiff_t>(count)};
}

template <class T>
void expect_same(std::span<const T> a, std::span<const T> b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

class HeadOfCodec : public testing::TestWithParam<format::Codec> {
 protected:
  const Bytes file_ = test::sample_asset_bytes(GetParam());
};

TEST_P(HeadOfCodec, TablesAreThoseOfTheFile) {
  const Asset whole = *Asset::from_bytes(file_);
  const std::uint64_t size = head_size(file_);
  EXPECT_EQ(size, test::section_offset(file_, SectionId::kPageData));
  EXPECT_LT(size, file_.size());
  for (const std::uint64_t given : {size, size + 1, std::uint64_t{file_.size()}}) {
    const auto head = Asset::from_head(first_bytes(file_, given), file_.size());
    ASSERT_TRUE(head.ok()) << head.error().message();
    EXPECT_FALSE(head->has_body());
    EXPECT_EQ(head->bytes().size(), size);
    expect_same(head->meshes(), whole.meshes());
    expect_same(head->materials(), whole.materials());
    expect_same(head->instances(), whole.instances());
    expect_same(head->groups(), whole.groups());
    expect_same(head->clusters(), whole.clusters());
    expect_same(head->nodes(), whole.nodes());
    expect_same(head->pages(), whole.pages());
    expect_same(head->page_dependencies(), whole.page_dependencies());
    expect_same(head->blobs(), whole.blobs());
    EXPECT_EQ(head->scene_json(), whole.scene_json());
    EXPECT_EQ(head->meta_json(), whole.meta_json());
    for (const format::SectionEntry& entry : head->sections()) {
      const bool is_table = entry.id != static_cast<std::uint32_t>(SectionId::kPageData) &&
                            entry.id != static_cast<std::uint32_t>(SectionId::kBlobData);
      EXPECT_EQ(head->section_bytes(entry).size(), is_table ? entry.decoded_bytes : 0U);
    }
  }
}

TEST_P(HeadOfCodec, PagesUnpackFromBytesOfTheCaller) {
  const Asset whole = *Asset::from_bytes(file_);
  const Asset head = *Asset::from_head(first_bytes(file_, head_size(file_)), file_.size());
  for (std::uint32_t p = 0; p < whole.pages().size(); ++p) {
    const auto expected = load_page(whole, PageId(p));
    ASSERT_TRUE(expected.ok());
    const format::PageRecord& record = head.pages()[p];
    // At an odd address, in memory of exactly their size.
    Bytes stored(record.stored_bytes + 1U);
    std::memcpy(stored.data() + 1, file_.data() + record.offset, record.stored_bytes);
    std::vector<std::uint32_t> words(record.bytes / 4, 0xDEADBEEFU);
    const Status status = unpack_stored_page(head, PageId(p), std::span(stored).subspan(1), words);
    ASSERT_TRUE(status.ok()) << status.error().message();
    expect_same(std::span<const std::uint32_t>(words), expected->words());

    const auto refuse = [&](std::span<const std::uint8_t> bytes, std::span<std::uint32_t> out, const char* field,
                            ErrorCode code) {
      const Status refused = unpack_stored_page(head, PageId(p), bytes, out);
      ASSERT_FALSE(refused.ok()) << field;
      EXPECT_EQ(refused.error().where, "page " + std::to_string(p) + ", field " + field);
      EXPECT_EQ(refused.error().code, code);
    };
    refuse(stored, words, "stored_bytes", ErrorCode::kUsage);
    refuse(std::span(stored).subspan(2), words, "stored_bytes", ErrorCode::kUsage);
    refuse(std::span(stored).subspan(1), std::span(words).subspan(1), "bytes", ErrorCode::kUsage);
    for (const std::size_t at : {std::size_t{1}, stored.size() / 2, stored.size() - 1}) {
      stored[at] ^= 1U;
      refuse(std::span(stored).subspan(1), words, "checksum", ErrorCode::kInvalid);
      stored[at] ^= 1U;
    }
  }
  std::vector<std::uint32_t> words(1);
  EXPECT_EQ(unpack_stored_page(head, PageId(whole.pages().size()), {}, words).error().code, ErrorCode::kUsage);
}

INSTANTIATE_TEST_SUITE_P(Codecs, HeadOfCodec,
                         testing::Values(format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd,
                                         format::Codec::kStrips, format::Codec::kDraco),
                         [](const auto& codec) { return "codec" + std::to_string(static_cast<int>(codec.param)); });

// A checksum of what is stored does not say what it decodes to.
TEST(Head, BothChecksumsOfAPageAreChecked) {
  Bytes file = test::sample_asset_bytes(format::Codec::kStrips);
  const std::uint64_t at =
      test::section_offset(file, SectionId::kPages) + offsetof(format::PageRecord, decoded_checksum);
  file[at] ^= 1U;
  test::reseal(file);
  const Asset head = *Asset::from_head(first_bytes(file, head_size(file)), file.size());
  const format::PageRecord& page = head.pages()[0];
  std::vector<std::uint32_t> words(page.bytes / 4);
  const Status status =
      unpack_stored_page(head, PageId(0U), std::span(file).subspan(page.offset, page.stored_bytes), words);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().where, "page 0, field decoded_checksum");
}

TEST(Head, WhatNeedsPagesSaysSo) {
  const Bytes file = test::sample_asset_bytes();
  const Asset head = *Asset::from_head(first_bytes(file, head_size(file)), file.size());
  const auto page = load_page(head, PageId(0U));
  ASSERT_FALSE(page.ok());
  EXPECT_EQ(page.error().code, ErrorCode::kUsage);
  EXPECT_EQ(page.error().where, "page 0");
  EXPECT_NE(page.error().detail.find("head"), std::string::npos);
  EXPECT_TRUE(head.stored_page(PageId(0U)).empty());
  ASSERT_FALSE(head.blobs().empty());
  EXPECT_TRUE(head.blob_bytes(head.blobs()[0]).empty());
}

TEST(Head, BlobsAreCheckedByNumberAndChecksum) {
  const Bytes file = test::sample_asset_bytes();
  const Asset head = *Asset::from_head(first_bytes(file, head_size(file)), file.size());
  for (std::uint32_t b = 0; b < head.blobs().size(); ++b) {
    const format::BlobRecord& blob = head.blobs()[b];
    Bytes bytes(file.begin() + static_cast<std::ptrdiff_t>(blob.offset),
                file.begin() + static_cast<std::ptrdiff_t>(blob.offset + blob.bytes));
    EXPECT_TRUE(check_blob(head, b, bytes).ok());
    EXPECT_EQ(check_blob(head, b, std::span(bytes).subspan(1)).error().code, ErrorCode::kUsage);
    bytes.back() ^= 1U;
    const Status broken = check_blob(head, b, bytes);
    EXPECT_EQ(broken.error().where, "blob " + std::to_string(b) + ", field checksum");
    EXPECT_EQ(broken.error().code, ErrorCode::kInvalid);
  }
  EXPECT_EQ(check_blob(head, static_cast<std::uint32_t>(head.blobs().size()), {}).error().code, ErrorCode::kUsage);
}

TEST(Head, TexturesLeadToTheBytesOfTheirImages) {
  scene::Scene scene = test::sample_scene();
  scene.document = R"({"textures":[{"source":0},{"name":"\"}]\"","sampler":1},{"source":7},
      {"extensions":{"KHR_texture_basisu":{"source":2.0}}},{"source":1,"extensions":{"EXT_texture_webp":{"source":0}}}],
      "images":[{"blob":0},{"uri":"elsewhere.png"},{"name":"basis","blob":0},{"blob":1},{"blob":9}]})";
  const Bytes file = test::sample_asset_bytes(scene, format::Codec::kNone);
  const Asset head = *Asset::from_head(first_bytes(file, head_size(file)), file.size());
  ASSERT_EQ(head.blobs()[1].kind, format::BlobKind::kBuffer);
  const std::uint32_t none = format::kNone;
  const std::uint32_t image_of[] = {0, none, none, 2, 1, none, none};
  for (std::uint32_t t = 0; t < 7; ++t) EXPECT_EQ(find_image_of_texture(head, t), image_of[t]) << t;
  const std::uint32_t blob_of[] = {0, none, 0, none, none, none};
  for (std::uint32_t i = 0; i < 6; ++i) EXPECT_EQ(find_blob_of_image(head, i), blob_of[i]) << i;
  EXPECT_EQ(find_image_of_texture(head, none), none);
  EXPECT_EQ(find_blob_of_image(head, none), none);
}

TEST(Head, ItsSizeIsKnownFromTheSectionTableOn) {
  const Bytes file = test::promised_asset_bytes(format::Codec::kStrips);
  const Asset whole = *Asset::from_bytes(file);
  const std::size_t table = 64 + 64 * whole.header().section_count;
  const std::uint64_t size = head_size(file);
  for (std::size_t given = 0; given <= file.size(); ++given) {
    const auto head = find_head(std::span(file).first(given), file.size());
    ASSERT_TRUE(head.ok()) << given;
    EXPECT_EQ(head->is_known, given >= table);
    EXPECT_EQ(head->bytes, given < 64 ? 64U : given < table ? table : size);
  }
  // At every address.
  Bytes moved(file.size() + 8);
  for (std::size_t offset = 0; offset < 8; ++offset) {
    std::copy(file.begin(), file.end(), moved.begin() + static_cast<std::ptrdiff_t>(offset));
    EXPECT_EQ(find_head(std::span(moved).subspan(offset, table), file.size())->bytes, size);
  }
}

TEST(Head, EveryTruncationIsRefusedWithItsPlace) {
  for (const Bytes& file : {test::sample_asset_bytes(format::Codec::kStrips), test::promised_asset_bytes()}) {
    const std::uint64_t size = head_size(file);
    for (std::size_t given = 0; given < size; ++given) {
      const auto head = Asset::from_head(first_bytes(file, given), file.size());
      ASSERT_FALSE(head.ok()) << given;
      EXPECT_EQ(head.error().where, "head");
      EXPECT_EQ(head.error().code, ErrorCode::kInvalid);
    }
    // A file that ends elsewhere than it says: the size that the caller knows decides.
    for (const std::uint64_t other :
         {std::uint64_t{0}, size, std::uint64_t{file.size() - 1}, std::uint64_t{file.size() + 1}, UINT64_MAX}) {
      const auto head = Asset::from_head(file, other);
      ASSERT_FALSE(head.ok()) << other;
      EXPECT_EQ(head.error().where, other == 0 ? "header, field magic" : "header, field file_bytes");
    }
  }
}

/// META moved behind all others.
Bytes with_a_table_at_the_end(const Bytes& file) {
  const Asset asset = *Asset::from_bytes(file);
  const auto entries = asset.sections();
  const std::uint64_t gap = entries[1].offset - entries[0].offset;
  Bytes out = first_bytes(file, entries[0].offset);
  out.insert(out.end(), file.begin() + static_cast<std::ptrdiff_t>(entries[1].offset), file.end());
  std::vector<format::SectionEntry> moved(entries.begin() + 1, entries.end());
  for (format::SectionEntry& entry : moved) entry.offset -= gap;
  out.resize((out.size() + 15) / 16 * 16);
  moved.push_back(entries[0]);
  moved.back().offset = out.size();
  const auto meta = asset.meta_json();
  out.insert(out.end(), meta.begin(), meta.end());
  std::memcpy(out.data() + 64, moved.data(), moved.size() * sizeof(moved[0]));
  const std::uint64_t file_bytes = out.size();
  std::memcpy(out.data() + offsetof(format::FileHeader, file_bytes), &file_bytes, sizeof(file_bytes));
  const auto shift = [&](std::uint64_t at) {
    std::uint64_t offset = 0;
    std::memcpy(&offset, out.data() + at, sizeof(offset));
    offset -= gap;
    std::memcpy(out.data() + at, &offset, sizeof(offset));
  };
  const std::uint64_t pages = test::section_offset(out, SectionId::kPages);
  for (std::size_t p = 0; p < asset.pages().size(); ++p) shift(pages + p * sizeof(format::PageRecord));
  const std::uint64_t blobs = test::section_offset(out, SectionId::kBlobs);
  for (std::size_t b = 0; b < asset.blobs().size(); ++b) {
    shift(blobs + b * sizeof(format::BlobRecord) + offsetof(format::BlobRecord, offset));
  }
  test::reseal(out);
  return out;
}

TEST(Head, AFileWithATableBehindItsPagesIsRefusedByName) {
  const Bytes file = with_a_table_at_the_end(test::sample_asset_bytes());
  const auto whole = Asset::from_vector(file);
  ASSERT_TRUE(whole.ok()) << whole.error().message();
  EXPECT_FALSE(whole->meta_json().empty());
  for (const auto& error : {find_head(file, file.size()).error(), Asset::from_head(file, file.size()).error()}) {
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_EQ(error.where, "section META");
  }
}

/// All that a caller does with a head, whatever it says. `bytes`: a file's, of which some may be missing.
void use_head(const Asset& head, const Bytes& bytes, test::RandomSource& random) {
  const SelectTables tables = tables_of(head);
  ResidentSelector selector(tables);
  std::vector<std::uint32_t> resident(head.pages().size() / 32 + 1);
  for (std::uint32_t& word : resident) word = static_cast<std::uint32_t>(random.below(UINT32_MAX));
  std::vector<ClusterInstance> items(1000);
  for (const double distance : {0.1, 3.0, 1e6}) {
    Camera camera;
    camera.eye = random.direction() * distance;
    const Frustum frustum = frustum_of(camera);
    for (const double pixel_error : {0.0, 1.0}) {
      const std::size_t count = selector.select(tables, {camera, pixel_error, resident, &frustum}, items);
      for (const ClusterInstance& item : std::span(items).first(std::min(count, items.size()))) {
        ASSERT_LT(item.cluster.value, head.clusters().size());
        ASSERT_LT(item.instance.value, head.instances().size());
      }
      for (const PageRequest& request : selector.requests()) ASSERT_LT(request.page, head.pages().size());
    }
  }
  for (std::uint32_t p = 0; p < head.pages().size(); ++p) {
    const format::PageRecord& record = head.pages()[p];
    std::vector<std::uint32_t> words(record.bytes / 4);
    Bytes stored(record.stored_bytes);
    for (std::size_t i = 0; i < stored.size() && record.offset + i < bytes.size(); ++i)
      stored[i] = bytes[record.offset + i];
    const Status status = unpack_stored_page(head, PageId(p), stored, words);
    ASSERT_TRUE(status.ok() || !status.error().where.empty());
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t blob = find_blob_of_image(head, find_image_of_texture(head, i));
    ASSERT_TRUE(blob == format::kNone || blob < head.blobs().size());
  }
}

TEST(Head, TwentyThousandMutantsAreRefusedOrUsed) {
  test::RandomSource random(401);
  const std::vector<Bytes> files{test::sample_asset_bytes(), test::sample_asset_bytes(format::Codec::kStrips),
                                 test::promised_asset_bytes(format::Codec::kStrips),
                                 test::asset_bytes_of(test::sample_tetrahedron(), format::Codec::kStrips)};
  std::size_t used = 0, refused = 0;
  for (int n = 0; n < 20000; ++n) {
    const Bytes& file = files[random.below(4)];
    Bytes mutant = file;
    const std::uint64_t size = head_size(file);
    // Most in the tables; a quarter in what a page stores.
    for (std::uint32_t k = 1 + random.below(3); k-- > 0;) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(n % 4 == 0 ? file.size() : size));
      mutant[at] =
          static_cast<std::uint8_t>(random.chance(0.5) ? random.below(256) : mutant[at] ^ (1U << random.below(8)));
    }
    if (n % 8 != 0) test::reseal(mutant);
    const std::size_t given = n % 16 == 3 ? random.below(static_cast<std::uint32_t>(size + 64)) : size;
    const auto head = Asset::from_head(first_bytes(mutant, std::min(given, mutant.size())), mutant.size());
    if (!head) {
      ASSERT_FALSE(head.error().where.empty()) << n;
      ++refused;
      continue;
    }
    ++used;
    use_head(*head, mutant, random);
  }
  EXPECT_GT(used, 2000U);
  EXPECT_GT(refused, 2000U);
}

TEST(JsonTextTest, ReadsWhatGltfHas) {
  const JsonText json(
      R"( {"a": [1, {"x": "}]\",", "n": 3.0}, [], 12] , "b":{"c" : 7 },"e":-1,"f":1e3,"g":1.5,"a2":"s"} )");
  EXPECT_TRUE(json.is_object());
  EXPECT_EQ(json.find("a").size(), 4U);
  EXPECT_EQ(json.find("a").item(0).index(), 1U);
  EXPECT_EQ(json.find("a").item(1).find("n").index(), 3U);
  EXPECT_EQ(json.find("a").item(3).index(), 12U);
  EXPECT_EQ(json.find("a").item(4), JsonText());
  EXPECT_EQ(json.find("b").find("c").index(), 7U);
  EXPECT_EQ(json.find("b").size(), 0U);
  for (const char* key : {"e", "f", "g", "a2", "none"}) EXPECT_FALSE(json.find(key).index()) << key;
  EXPECT_FALSE(JsonText("9007199254740992").index());
  EXPECT_EQ(JsonText("9007199254740991").index(), 9007199254740991U);
}

TEST(JsonTextTest, WhateverItIsItEnds) {
  test::RandomSource random(402);
  const std::string letters = "{}[]\",:\\ 0129.ax\n";
  for (int n = 0; n < 20000; ++n) {
    std::string text = random.chance(0.5) ? R"({"images":[{"blob":0}],"textures":[{"source":0}]})"
                                          : std::string(random.below(40), ' ');
    for (std::uint32_t k = text.empty() ? 0 : 1 + random.below(8); k-- > 0;) {
      text[random.below(static_cast<std::uint32_t>(text.size()))] =
          letters[random.below(static_cast<std::uint32_t>(letters.size()))];
    }
    const JsonText json(text);
    (void)json.find("textures").item(0).find("source").index();
    (void)json.find("images").item(0).find("blob").index();
    (void)json.size();
  }
  // No stack is taken by depth.
  EXPECT_EQ(JsonText(std::string(1000000, '[')).item(0), JsonText());
}

}  // namespace
}  // namespace meshlode::run
