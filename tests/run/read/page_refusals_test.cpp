// SPDX-License-Identifier: GPL-3.0-or-later
// Each rule about the inside of a page, broken alone, is refused when the page is loaded (I11).
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include <meshlode/page.h>

#include "break_asset.h"
#include "run/decode/decode.h"

namespace meshlode::run {
namespace {

using format::SectionId;

namespace head = format::head;

/// Page 0 holds the patch: normals, one UV set, material ranges; cluster 0 is of level 2.
class PageRefusals : public testing::Test {
 protected:
  PageRefusals() : bytes_(test::sample_asset_bytes()), asset_(*Asset::from_bytes(bytes_)) {
    page_at_ = asset_.pages()[0].offset;
    const auto page = load_page(asset_, PageId{0U});
    EXPECT_EQ(format::read_cluster_layout(asset_.meshes()[0], page->words(), 0, layout_), nullptr);
  }

  /// Changes the page's words, seals them, and expects the page to be refused there.
  void expect_refused(const std::function<void(std::vector<std::uint32_t>&)>& change, const std::string& where,
                      std::uint32_t page_id = 0) {
    auto broken = bytes_;
    const format::PageRecord& record = asset_.pages()[page_id];
    std::vector<std::uint32_t> words(record.bytes / 4);
    std::memcpy(words.data(), broken.data() + record.offset, record.bytes);
    change(words);
    std::memcpy(broken.data() + record.offset, words.data(), record.bytes);
    test::reseal(broken);
    const auto asset = Asset::from_vector(broken);
    ASSERT_TRUE(asset.ok()) << asset.error().message();
    const auto page = load_page(*asset, PageId{page_id});
    ASSERT_FALSE(page.ok()) << "accepted: " << where;
    EXPECT_EQ(page.error().where, where) << page.error().message();
    EXPECT_EQ(page.error().code, ErrorCode::kInvalid);
  }
  /// A field of words that start at `word`.
  void expect_field_refused(std::uint32_t word, format::BitField field, std::uint32_t value, const char* name) {
    expect_refused(
        [&](std::vector<std::uint32_t>& words) {
          words[word + field.word] &= ~(field.mask() << field.shift);
          words[word + field.word] |= (value & field.mask()) << field.shift;
        },
        std::string("page 0, cluster 0, field ") + name);
  }
  static void put_bits(std::vector<std::uint32_t>& words, std::uint32_t at, std::uint32_t count, std::uint32_t value) {
    for (std::uint32_t i = 0; i < count; ++i) {
      words[(at + i) / 32] &= ~(1U << (at + i) % 32);
      words[(at + i) / 32] |= (value >> i & 1U) << (at + i) % 32;
    }
  }

  std::vector<std::uint8_t> bytes_;
  Asset asset_;
  std::uint64_t page_at_ = 0;
  format::ClusterLayout layout_;
};

TEST_F(PageRefusals, ThePageHeaderMatchesTheTable) {
  expect_refused([](auto& w) { w[0] += 1; }, "page 0, field first_cluster");
  expect_refused([](auto& w) { w[1] -= 1; }, "page 0, field cluster_count");
}

TEST_F(PageRefusals, DataLieWhereTheyMust) {
  const std::uint32_t right = layout_.data_word;
  for (const std::uint32_t wrong : {0U, right - 1, right + 1}) {
    expect_field_refused(layout_.head_word, format::head::kDataWord, wrong, "data_word");
  }
  expect_field_refused(layout_.head_word, format::head::kDataWord, 0xFFFFU, "data_word");
}

TEST_F(PageRefusals, CountsMatchTheRecord) {
  const std::uint32_t at = layout_.head_word;
  expect_field_refused(at, format::head::kTrianglesLess1, layout_.triangle_count - 2, "material_range");
  expect_field_refused(at, format::head::kVerticesLess1, layout_.vertex_count - 2, "uv_range");
  // Where neither ranges nor UVs notice: the tetrahedron.
  const std::uint32_t last = static_cast<std::uint32_t>(asset_.pages().size()) - 1;
  const std::string where =
      "page " + std::to_string(last) + ", cluster " + std::to_string(asset_.pages()[last].first_cluster) + ", field ";
  expect_refused([](auto& w) { w[2] -= 1; }, where + "vertices_less_1", last);
}

TEST_F(PageRefusals, BitCountsChartsAndAxesAreKnownOnes) {
  const std::uint32_t at = layout_.head_word;
  for (const auto& field : format::head::kBits) {
    expect_field_refused(at, field, 25, "bits");
    expect_field_refused(at, field, 31, "bits");
  }
  expect_field_refused(at, format::head::kChart, 6, "chart");
  expect_field_refused(at, format::head::kChart, 7, "chart");
  expect_field_refused(at, format::head::kShearAxis, 3, "shear_axis");
  expect_field_refused(at, format::head::kReferenceBits, 0, "reference_bits");
  expect_field_refused(at, format::head::kReferenceBits, 9, "reference_bits");
  expect_field_refused(at, format::head::kNormalBitsA, 15, "normal_bits");
  expect_field_refused(at, format::head::kNormalBitsB, 15, "normal_bits");
  expect_field_refused(at, format::head::kStripsLess1, 255, "strip_count");
  expect_field_refused(layout_.uv_word[0], format::uv_range::kBitsU, 26, "uv_range.bits");
  expect_field_refused(layout_.uv_word[0], format::uv_range::kBitsV, 31, "uv_range.bits");
}

TEST_F(PageRefusals, RangesCoverWhatTheyMust) {
  expect_field_refused(layout_.material_word, format::material_range::kTrianglesLess1, 255, "material_range");
  expect_field_refused(layout_.material_word, format::material_range::kMaterial, 2, "material");
  expect_field_refused(layout_.material_word, format::material_range::kMaterial, 0xFFFFFFU, "material");
  expect_field_refused(layout_.uv_word[0], format::uv_range::kVerticesLess1, 255, "uv_range");
}

TEST_F(PageRefusals, NothingReachesBeyondThePage) {
  // The last cluster of the page claims the widest vertices that there are.
  const format::PageRecord& page = asset_.pages()[0];
  expect_refused(
      [&](std::vector<std::uint32_t>& words) {
        std::uint32_t* const last = &words[2 + (page.cluster_count - 1) * format::head_words(asset_.meshes()[0])];
        for (const auto& field : format::head::kBits) {
          last[field.word] &= ~(field.mask() << field.shift);
          format::put_field(last, field, 24);
        }
      },
      "page 0, cluster " + std::to_string(page.first_cluster + page.cluster_count - 1) + ", field data_word");
}

TEST_F(PageRefusals, StripsStartInOrderAndTurnLeft) {
  expect_refused([&](auto& w) { put_bits(w, layout_.turn_bit, 1, 1); }, "page 0, cluster 0, field turn");
  if (layout_.strip_count > 1) {
    expect_refused([&](auto& w) { put_bits(w, layout_.restart_bit, layout_.restart_bits, 0); },
                   "page 0, cluster 0, field restart");
  }
}

TEST_F(PageRefusals, EveryVertexIsNamedFreshAndReferencesNameOneBefore) {
  expect_refused([&](auto& w) { put_bits(w, layout_.reference_bit, layout_.reference_bits, 0xFFU); },
                 "page 0, cluster 0, field reference");
  // The first slot that is not fresh says it is: one vertex too many.
  const auto page = load_page(asset_, PageId{0U});
  std::uint32_t slot = 0;
  while (format::get_bits(page->words().data(), layout_.fresh_bit + slot, 1) != 0) ++slot;
  expect_refused([&](auto& w) { put_bits(w, layout_.fresh_bit + slot, 1, 1); }, "page 0, cluster 0, field fresh");
  expect_refused([&](auto& w) { put_bits(w, layout_.fresh_bit, 1, 0); }, "page 0, cluster 0, field reference");
}

TEST_F(PageRefusals, UnnamedBitsAreZero) {
  const std::string where = "page 0, cluster 0, field ";
  expect_refused([&](auto& w) { w[layout_.head_word + 2] |= 1U << 31U; }, where + "head");
  expect_refused([&](auto& w) { w[layout_.head_word + 3] |= 1U << 29U; }, where + "head");
  expect_refused([&](auto& w) { w[layout_.uv_word[0]] |= 1U << 31U; }, where + "uv_range");
  expect_refused([](auto& w) { w.back() = 1; }, "page 0, field data_word");
  format::ClusterLayout layout = layout_;
  std::uint32_t c = 0;
  const auto page = load_page(asset_, PageId{0U});
  while (layout.end_bit % 32 == 0) {
    ASSERT_EQ(format::read_cluster_layout(asset_.meshes()[0], page->words(), ++c, layout), nullptr);
  }
  expect_refused([&](auto& w) { put_bits(w, layout.end_bit, 1, 1); },
                 "page 0, cluster " + std::to_string(c) + ", field data_word");
}

TEST_F(PageRefusals, ChecksumsAreChecked) {
  auto broken = bytes_;
  broken[page_at_ + 4 * layout_.stream_word] ^= 1U;
  auto asset = Asset::from_vector(broken);
  ASSERT_TRUE(asset.ok()) << "pages are checked when they are loaded";
  EXPECT_EQ(load_page(*asset, PageId{0U}).error().where, "page 0, field checksum");
  const auto lying =
      test::with_changed_record<format::PageRecord>(test::sample_asset_bytes(format::Codec::kZstd), SectionId::kPages,
                                                    0, [](format::PageRecord& p) { p.decoded_checksum ^= 1U; });
  asset = Asset::from_vector(lying);
  ASSERT_TRUE(asset.ok());
  EXPECT_EQ(load_page(*asset, PageId{0U}).error().where, "page 0, field decoded_checksum");
}

TEST_F(PageRefusals, PackedPagesUnpackToTheirSizeOrNotAtAll) {
  using P = format::PageRecord;
  for (const format::Codec codec : {format::Codec::kLz4, format::Codec::kZstd, format::Codec::kStrips}) {
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
    const auto asset =
        Asset::from_vector(test::with_changed_record<P>(packed, SectionId::kPages, 0, [=](P& p) { p.codec = other; }));
    ASSERT_TRUE(asset.ok());
    EXPECT_FALSE(load_page(*asset, PageId{0U}).ok());
    const auto draco = Asset::from_vector(
        test::with_changed_record<P>(packed, SectionId::kPages, 0, [](P& p) { p.codec = format::Codec::kDraco; }));
    ASSERT_TRUE(draco.ok());
    EXPECT_FALSE(load_page(*draco, PageId{0U}).ok());
  }
}

TEST_F(PageRefusals, APageThatIsNotThereIsAnError) {
  EXPECT_FALSE(load_page(asset_, PageId{99U}).ok());
  EXPECT_FALSE(load_page(asset_, PageId{}).ok());
}

}  // namespace
}  // namespace meshlode::run
