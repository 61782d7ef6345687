// SPDX-License-Identifier: GPL-3.0-or-later
// Each rule about the inside of a page, broken alone, is refused when the page is loaded (I11).
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "break_asset.h"
#include "decode/decode.h"

namespace meshlode {
namespace {

using format::SectionId;

/// Page 0 holds the patch: seven channels, cluster 0 of level 2 with one material range.
class PageRefusals : public testing::Test {
 protected:
  PageRefusals() : bytes_(test::sample_asset_bytes()), asset_(*Asset::from_bytes(bytes_)) {
    page_at_ = asset_.pages()[0].offset;
    std::memcpy(&cluster_at_, bytes_.data() + page_at_ + sizeof(format::PageHeader), 4);
    std::memcpy(&cluster_, bytes_.data() + page_at_ + cluster_at_, sizeof(cluster_));
  }

  template <class Record>
  void expect_refused(std::uint64_t at_in_page, const std::function<void(Record&)>& change, const std::string& where) {
    auto broken = bytes_;
    Record record;
    std::memcpy(&record, broken.data() + page_at_ + at_in_page, sizeof(record));
    change(record);
    std::memcpy(broken.data() + page_at_ + at_in_page, &record, sizeof(record));
    test::reseal(broken);
    const auto asset = Asset::from_vector(broken);
    ASSERT_TRUE(asset.ok()) << asset.error().message();
    const auto page = load_page(*asset, PageId{0U});
    ASSERT_FALSE(page.ok()) << "accepted: " << where;
    EXPECT_EQ(page.error().where, where) << page.error().message();
    EXPECT_EQ(page.error().code, ErrorCode::kInvalid);
  }

  std::vector<std::uint8_t> bytes_;
  Asset asset_;
  std::uint64_t page_at_ = 0;
  std::uint32_t cluster_at_ = 0;
  format::PageCluster cluster_{};
};

TEST_F(PageRefusals, ThePageHeaderMatchesTheTable) {
  using H = format::PageHeader;
  expect_refused<H>(0, [](H& h) { h.first_cluster += 1; }, "page 0, field first_cluster");
  expect_refused<H>(0, [](H& h) { h.cluster_count -= 1; }, "page 0, field cluster_count");
}

TEST_F(PageRefusals, OffsetsAreTheOnlyOnesPossible) {
  for (const std::uint32_t wrong : {0U, 4U, cluster_at_ + 4U, 0xFFFFFFFCU}) {
    expect_refused<std::uint32_t>(sizeof(format::PageHeader), [=](std::uint32_t& offset) { offset = wrong; },
                                  "page 0, cluster 0, field offset");
  }
}

TEST_F(PageRefusals, TheClusterHeaderMatchesItsRecordAndMesh) {
  using C = format::PageCluster;
  const std::string where = "page 0, cluster 0, field ";
  expect_refused<C>(cluster_at_, [](C& c) { c.vertex_count += 1; }, where + "vertex_count");
  expect_refused<C>(cluster_at_, [](C& c) { c.triangle_count -= 1; }, where + "triangle_count");
  expect_refused<C>(cluster_at_, [](C& c) { c.channel_count = 3; }, where + "channel_count");
  expect_refused<C>(cluster_at_, [](C& c) { c.material_range_count = 0; }, where + "material_range_count");
  expect_refused<C>(cluster_at_, [](C& c) { c.material_range_count = 0xFFFF; }, where + "material_range_count");
  expect_refused<C>(cluster_at_, [](C& c) { c.vertex_bits += 1; }, where + "vertex_bits");
  expect_refused<C>(cluster_at_, [](C& c) { c.vertex_offset += 4; }, where + "vertex_offset");
  expect_refused<C>(cluster_at_, [](C& c) { c.vertex_offset = 0xFFFFFFFFU; }, where + "vertex_offset");
  expect_refused<C>(cluster_at_, [](C& c) { c.triangle_offset -= 4; }, where + "triangle_offset");
  expect_refused<C>(cluster_at_, [](C& c) { c.triangle_offset = 0xFFFFFFFCU; }, where + "triangle_offset");
}

TEST_F(PageRefusals, ChannelsStayInRange) {
  using C = format::Channel;
  const auto channel_at = [&](std::size_t c) { return cluster_at_ + sizeof(format::PageCluster) + 8 * c; };
  const std::string where = "page 0, cluster 0, field ";
  expect_refused<C>(channel_at(0), [](C& c) { c.bits = 26; }, where + "bits");
  expect_refused<C>(channel_at(0), [](C& c) { c.bits = 0xFFFFFFFFU; }, where + "bits");
  expect_refused<C>(channel_at(0), [](C& c) { c.minimum = 1 << 24; }, where + "minimum");
  expect_refused<C>(channel_at(0), [](C& c) { c.minimum = -(1 << 24); }, where + "minimum");
  expect_refused<C>(channel_at(3), [](C& c) { c.minimum = -1; }, where + "minimum");  // a normal
  expect_refused<C>(channel_at(5), [](C& c) { c.bits += 1; }, where + "vertex_bits");
}

TEST_F(PageRefusals, MaterialRangesCoverTheTrianglesInOrder) {
  using R = format::MaterialRange;
  const std::uint64_t at = cluster_at_ + sizeof(format::PageCluster) + 8U * cluster_.channel_count;
  const std::string where = "page 0, cluster 0, field ";
  expect_refused<R>(at, [](R& r) { r.material = 2; }, where + "material");
  expect_refused<R>(at, [](R& r) { r.material = 0xFFFFFFFFU; }, where + "material");
  expect_refused<R>(at, [](R& r) { r.triangle_count = 0; }, where + "triangle_count");
  expect_refused<R>(at, [](R& r) { r.triangle_count += 1; }, where + "material_range_count");
}

TEST_F(PageRefusals, TrianglesNameVerticesAndEveryVertexIsUsed) {
  using B = std::uint8_t;
  expect_refused<B>(cluster_.triangle_offset, [&](B& b) { b = static_cast<B>(cluster_.vertex_count); },
                    "page 0, cluster 0, field triangles");
  expect_refused<B>(cluster_.triangle_offset, [](B& b) { b = 255; }, "page 0, cluster 0, field triangles");
  // The first corner of the first triangle is vertex 0 by construction; all its uses become vertex 1.
  auto broken = bytes_;
  for (std::uint64_t i = 0; i < 3U * cluster_.triangle_count; ++i) {
    std::uint8_t& index = broken[page_at_ + cluster_.triangle_offset + i];
    if (index == 0) index = 1;
  }
  test::reseal(broken);
  const auto asset = Asset::from_vector(broken);
  ASSERT_TRUE(asset.ok());
  EXPECT_FALSE(load_page(*asset, PageId{0U}).ok());
}

TEST_F(PageRefusals, PaddingIsZero) {
  const std::uint64_t stream_bits = std::uint64_t{cluster_.vertex_count} * cluster_.vertex_bits;
  const std::uint64_t stream_end = cluster_.vertex_offset + (stream_bits + 7) / 8;
  if (stream_end < cluster_.triangle_offset) {
    expect_refused<std::uint8_t>(stream_end, [](std::uint8_t& b) { b = 1; }, "page 0, cluster 0, field vertex_offset");
  }
  if (stream_bits % 8 != 0) {
    expect_refused<std::uint8_t>(stream_end - 1, [](std::uint8_t& b) { b |= 0x80U; },
                                 "page 0, cluster 0, field vertex_offset");
  }
  EXPECT_TRUE(stream_bits % 32 != 0) << "the sample has padding to test";
}

TEST_F(PageRefusals, ChecksumsAreChecked) {
  auto broken = bytes_;
  broken[page_at_ + cluster_.vertex_offset] ^= 1U;
  auto asset = Asset::from_vector(broken);
  ASSERT_TRUE(asset.ok()) << "pages are checked when they are loaded";
  EXPECT_EQ(load_page(*asset, PageId{0U}).error().where, "page 0, field checksum");
  const auto lying = test::with_changed_record<format::PageRecord>(
      test::sample_asset_bytes(format::Codec::kZstd), SectionId::kPages, 0,
      [](format::PageRecord& p) { p.decoded_checksum ^= 1U; });
  asset = Asset::from_vector(lying);
  ASSERT_TRUE(asset.ok());
  EXPECT_EQ(load_page(*asset, PageId{0U}).error().where, "page 0, field decoded_checksum");
}

TEST_F(PageRefusals, PackedPagesUnpackToTheirSizeOrNotAtAll) {
  using P = format::PageRecord;
  for (const format::Codec codec : {format::Codec::kLz4, format::Codec::kZstd}) {
    const auto packed = test::sample_asset_bytes(codec);
    const auto sound = Asset::from_bytes(packed);
    ASSERT_TRUE(sound.ok());
    ASSERT_EQ(sound->pages()[0].codec, codec);
    for (const int change : {-4, 4, 1024}) {
      const auto asset = Asset::from_vector(test::with_changed_record<P>(packed, SectionId::kPages, 0, [=](P& p) {
        p.bytes = static_cast<std::uint32_t>(static_cast<int>(p.bytes) + change);
      }));
      ASSERT_TRUE(asset.ok());
      EXPECT_EQ(load_page(*asset, PageId{0U}).error().where, "page 0, field codec");
    }
    // The other codec's bytes.
    const format::Codec other = codec == format::Codec::kLz4 ? format::Codec::kZstd : format::Codec::kLz4;
    const auto asset = Asset::from_vector(
        test::with_changed_record<P>(packed, SectionId::kPages, 0, [=](P& p) { p.codec = other; }));
    ASSERT_TRUE(asset.ok());
    EXPECT_FALSE(load_page(*asset, PageId{0U}).ok());
    const auto draco = Asset::from_vector(
        test::with_changed_record<P>(packed, SectionId::kPages, 0, [](P& p) { p.codec = format::Codec::kDraco; }));
    ASSERT_TRUE(draco.ok());
    EXPECT_EQ(load_page(*draco, PageId{0U}).error().code, ErrorCode::kUnsupported);
  }
}

TEST_F(PageRefusals, APageThatIsNotThereIsAnError) {
  EXPECT_FALSE(load_page(asset_, PageId{99U}).ok());
  EXPECT_FALSE(load_page(asset_, PageId{}).ok());
}

}  // namespace
}  // namespace meshlode
