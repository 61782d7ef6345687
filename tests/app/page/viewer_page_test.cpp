// SPDX-License-Identifier: GPL-3.0-or-later
// The page of an asset as text: what it holds can be read again, nothing in it is markup that should be text, and
// nothing in it names a place elsewhere. What it does is for tests/browser.
#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "app/page/page_texts.h"
#include "app/page/text_forms.h"
#include "app/page/viewer_page.h"
#include "app/report/info.h"
#include "run/unpack/content_hash.h"
#include "run/unpack/unpack.h"
#include "support/sample_asset.h"

namespace meshlode::app {
namespace {

using Bytes = std::vector<std::uint8_t>;

const run::Asset& sample() {
  static const run::Asset asset = *run::Asset::from_vector(test::sample_asset_bytes());
  return asset;
}

constexpr std::array<std::uint8_t, 5> kModule{0, 'a', 's', 'm', 1};

ViewerInput input_of(std::string_view title) {
  ViewerInput input;
  input.title = title;
  input.runtime = kModule;
  return input;
}

std::string page_of(const run::Asset& asset, const ViewerInput& input) {
  const auto page = viewer_page(asset, input);
  EXPECT_TRUE(page) << page.error().message();
  return page ? *page : "";
}

std::size_t count_of(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

Bytes decode_base64(std::string_view text) {
  Bytes out;
  std::uint32_t bits = 0;
  int have = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::uint32_t digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                                : c >= 'a' && c <= 'z' ? c - 'a' + 26
                                : c >= '0' && c <= '9' ? c - '0' + 52
                                : c == '+'             ? 62
                                                       : 63;
    bits = bits << 6U | digit;
    have += 6;
    if (have < 8) continue;
    have -= 8;
    out.push_back(static_cast<std::uint8_t>(bits >> have));
  }
  return out;
}

/// The file as the page's script puts it together.
Bytes file_of(std::string_view page, std::size_t size) {
  Bytes file(size, 0);
  constexpr std::string_view kMark = "class=\"piece\" data-at=\"";
  for (std::size_t at = page.find(kMark); at != std::string_view::npos; at = page.find(kMark, at + 1)) {
    std::uint64_t offset = 0;
    const char* digits = page.data() + at + kMark.size();
    const char* end = std::from_chars(digits, page.data() + page.size(), offset).ptr;
    const std::string_view rest(end + 2, static_cast<std::size_t>(page.data() + page.size() - end) - 2);
    const Bytes bytes = decode_base64(rest.substr(0, rest.find('<')));
    if (offset + bytes.size() > size) {
      ADD_FAILURE() << "a piece at " << offset << " reaches beyond the file";
      return file;
    }
    std::copy(bytes.begin(), bytes.end(), file.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  return file;
}

TEST(ViewerPage, IsTheSameForTheSameAsset) {
  const std::string page = page_of(sample(), input_of("a.lode"));
  EXPECT_EQ(page, page_of(sample(), input_of("a.lode")));
  EXPECT_NE(page, page_of(sample(), input_of("b.lode")));
}

TEST(ViewerPage, HoldsTheAssetButForItsImages) {
  const Bytes file = file_of(page_of(sample(), input_of("a.lode")), sample().bytes().size());
  const auto asset = run::Asset::from_bytes(file);
  ASSERT_TRUE(asset) << asset.error().message();
  for (std::size_t p = 0; p < asset->pages().size(); ++p) EXPECT_TRUE(run::load_page(*asset, PageId{p})) << p;
  ASSERT_FALSE(sample().blobs().empty());
  for (const format::BlobRecord& blob : asset->blobs()) {
    const auto bytes = asset->blob_bytes(blob);
    EXPECT_TRUE(std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; }));
  }
}

/// What is embedded may have another codec; what is told is the file's.
TEST(ViewerPage, TellsTheBytesOfTheFileAsItIs) {
  const run::Asset strips = *run::Asset::from_vector(test::sample_asset_bytes(format::Codec::kStrips));
  ASSERT_NE(strips.bytes().size(), sample().bytes().size());
  ViewerInput input = input_of("a.lode");
  input.file = &sample();
  std::string page = page_of(strips, input);
  std::erase_if(page, [](char c) { return c == ' ' || c == '\n'; });
  EXPECT_EQ(count_of(page, "\"file_bytes\":" + std::to_string(sample().bytes().size()) + ","), 1U);
  for (const format::SectionEntry& section : sample().sections()) {
    EXPECT_EQ(count_of(page, "[\"" + section_name(section.id) + "\"," + std::to_string(section.bytes) + "]"), 1U)
        << section_name(section.id);
  }
  EXPECT_EQ(count_of(page, ",\"none\"]"), sample().pages().size());
  EXPECT_EQ(count_of(page, ",\"strips\"]"), 0U);
}

TEST(ViewerPage, NamesNoPlaceElsewhere) {
  const std::string page = page_of(sample(), input_of("a.lode"));
  for (const char* part : {"http:", "https:", " src=", " href=", "url(", "@import"})
    EXPECT_EQ(count_of(page, part), 0U) << part;
  EXPECT_EQ(count_of(page, "default-src 'none'"), 1U);
}

TEST(ViewerPage, TakesATitleForText) {
  const std::string hostile = "</title></script><script>alert(1)</script>&\"'@RUNTIME@\x01\xFF\xE2\x80\xAE.lode";
  const std::string page = page_of(sample(), input_of(hostile));
  const std::string plain = page_of(sample(), input_of("a.lode"));
  EXPECT_EQ(count_of(page, "<script"), count_of(plain, "<script"));
  EXPECT_EQ(count_of(page, "</script"), count_of(plain, "</script"));
  EXPECT_EQ(count_of(page, "</title>"), 1U);
  EXPECT_EQ(count_of(page, encode_base64(kModule)), 1U) << "a hole in a title was filled";
  EXPECT_EQ(count_of(page, "\x01"), 0U);
  EXPECT_EQ(count_of(page, "\xFF"), 0U);
  EXPECT_EQ(count_of(page, "\xE2\x80\xAE"), 0U) << "U+202E";
  EXPECT_EQ(escape_html("\xC3\xA9\xE2\x82\xAC&"), "\xC3\xA9\xE2\x82\xAC&amp;");
}

TEST(ViewerPage, HasNoEndOfAScriptInItsScripts) {
  for (const std::string_view script : page_scripts()) EXPECT_EQ(count_of(script, "</"), 0U);
  const std::string page = page_of(sample(), input_of("a.lode"));
  EXPECT_EQ(count_of(page, "\nimport "), 0U);
  EXPECT_EQ(count_of(page, "\nexport "), 0U);
  for (const char* hole : {"@TITLE@", "@MAIN@", "@STYLE@", "@FACTS@", "@PIECES@", "@RUNTIME@", "@SCRIPT@"}) {
    EXPECT_EQ(count_of(page_frame(), hole), std::string_view(hole) == "@TITLE@" ? 2U : 1U) << hole;
    EXPECT_EQ(count_of(page, hole), 0U) << hole;
  }
}

/// The page between <main> and </main> is that of docs/examples/viewer.
TEST(ViewerPage, ShowsWhatTheViewerShows) {
  const std::string page = page_of(sample(), input_of("a.lode"));
  EXPECT_EQ(count_of(page, page_main()), 1U);
  for (const char* part : {"<main>", "</main>", "id=\"mesh-view\"", "id=\"graph\"", "id=\"treemap\"", "id=\"theme\""})
    EXPECT_EQ(count_of(page, part), 1U) << part;
}

TEST(ViewerPage, OfALargeAssetHoldsPagesThatMakeACut) {
  std::uint64_t all = 0;
  for (const format::PageRecord& page : sample().pages()) all += page.stored_bytes;
  std::size_t last = 0;
  for (const std::uint64_t limit : {std::uint64_t{0}, all / 2, all - 1, all}) {
    const auto chosen = choose_pages(sample(), limit);
    ASSERT_TRUE(chosen);
    std::uint64_t bytes = 0;
    for (std::size_t p = 0; p < chosen->size(); ++p) {
      const format::PageRecord& page = sample().pages()[p];
      const auto groups = sample().groups().subspan(page.first_group, page.group_count);
      for (const format::GroupRecord& group : groups) {
        EXPECT_TRUE((*chosen)[p] || (group.flags & format::kGroupTerminal) == 0) << "roots of page " << p;
      }
      if (!(*chosen)[p]) continue;
      bytes += page.stored_bytes;
      for (const std::uint32_t needed :
           sample().page_dependencies().subspan(page.first_dependency, page.dependency_count)) {
        EXPECT_TRUE((*chosen)[needed]) << p << " without " << needed;
      }
    }
    const auto count = static_cast<std::size_t>(std::count(chosen->begin(), chosen->end(), true));
    EXPECT_GE(count, last);
    last = count;
    ViewerInput input = input_of("a.lode");
    input.max_page_bytes = limit;
    const std::string page = page_of(sample(), input);
    EXPECT_EQ(count_of(page, "\"embedded_page_bytes\": " + std::to_string(bytes)), 1U);
    const Bytes file = file_of(page, sample().bytes().size());
    const auto asset = run::Asset::from_bytes(file);
    ASSERT_TRUE(asset) << asset.error().message();
    for (std::size_t p = 0; p < chosen->size(); ++p) {
      EXPECT_EQ(static_cast<bool>(run::load_page(*asset, PageId{p})), static_cast<bool>((*chosen)[p]))
          << "page " << p << " at " << limit;
    }
  }
  EXPECT_EQ(last, sample().pages().size());
}

TEST(ViewerPage, RefusesPagesThatABrowserCannotRead) {
  const auto asset = *run::Asset::from_vector(test::sample_asset_bytes(format::Codec::kZstd));
  const auto page = viewer_page(asset, input_of("a.lode"));
  ASSERT_FALSE(page);
  EXPECT_EQ(page.error().code, ErrorCode::kUnsupported);
}

TEST(ViewerPage, WritesBase64AsTheStandardHasIt) {
  const auto encoded = [](std::string_view text) {
    return encode_base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xFB\xFF"), "+/8=");
}

}  // namespace
}  // namespace meshlode::app
