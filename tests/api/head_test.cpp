// SPDX-License-Identifier: GPL-3.0-or-later
// An engine that reads a file itself, through the public headers alone: the head, pages from its own bytes, and cuts by
// what is resident, in C as in C++; the scenes of data/, in every codec.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshlode/build.h>
#include <meshlode/meshlode.h>
#include <meshlode/runtime.h>

#include "arrays.h"
#include "base/file.h"

namespace meshlode {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// What is opened of it: the bytes before the pages, at a multiple of 8, and the rest as a file to read from.
struct Streamed {
  explicit Streamed(const Bytes& bytes) : file(bytes) {
    HeadSize size;
    while (!size.is_known) {  // as a caller does that has read nothing yet
      const auto asked = find_head({file.data(), size.bytes}, file.size());
      EXPECT_TRUE(asked.ok());
      if (!asked) return;
      size = *asked;
    }
    head.assign(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size.bytes));
    EXPECT_EQ(meshlode_open_head(head.data(), head.size(), file.size(), &asset, nullptr), MESHLODE_OK);
  }
  ~Streamed() { meshlode_close(asset); }
  Streamed(const Streamed&) = delete;
  Streamed& operator=(const Streamed&) = delete;
  [[nodiscard]] std::span<const std::uint8_t> read(std::uint64_t offset, std::uint64_t bytes) const {
    return std::span(file).subspan(offset, bytes);
  }

  const Bytes& file;
  Bytes head;
  meshlode_asset* asset = nullptr;
};

void expect_pages_unpack(const Bytes& bytes) {
  const auto whole = AssetFile::view(bytes);
  ASSERT_TRUE(whole.ok()) << whole.error().message();
  const Streamed streamed(bytes);
  const auto head = AssetFile::view_head(streamed.head, bytes.size());
  ASSERT_TRUE(head.ok()) << head.error().message();
  ASSERT_NE(streamed.asset, nullptr);
  EXPECT_EQ(streamed.head.size(), whole->pages().empty() ? bytes.size() : whole->pages()[0].offset);
  for (std::uint32_t p = 0; p < whole->pages().size(); ++p) {
    const auto expected = whole->load_page(p);
    ASSERT_TRUE(expected.ok());
    const ByteRange range = head->page_range(p);
    const auto stored = streamed.read(range.offset, range.bytes);
    std::vector<std::uint32_t> words(head->pages()[p].bytes / 4), c_words(words.size());
    const auto page = head->unpack_page(p, stored, words);
    ASSERT_TRUE(page.ok()) << page.error().message();
    ASSERT_TRUE(std::ranges::equal(page->bytes(), expected->bytes())) << p;
    const meshlode_range c_range = meshlode_page_range(streamed.asset, p);
    ASSERT_TRUE(c_range.offset == range.offset && c_range.bytes == range.bytes);
    ASSERT_EQ(meshlode_unpack_page(streamed.asset, p, stored.data(), stored.size(), c_words.data(), 4 * c_words.size(),
                                   nullptr),
              MESHLODE_OK);
    ASSERT_EQ(words, c_words);
    ClusterIntegers a, b;
    ASSERT_TRUE(whole->decode(*expected, whole->pages()[p].first_cluster, a).ok());
    ASSERT_TRUE(head->decode(*page, whole->pages()[p].first_cluster, b).ok());
    ASSERT_TRUE(a.values == b.values && a.triangles == b.triangles);
  }
}

View random_view(std::uint32_t& state, const AssetFile& asset, std::array<double, 3>& target) {
  const auto next = [&] {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8U) * 0x1p-24;
  };
  const auto instances = asset.instances();
  const format::InstanceRecord& instance =
      instances[static_cast<std::size_t>(next() * 0.999 * static_cast<double>(instances.size()))];
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  const double reach = instance.scale * mesh.diagonal * (next() < 0.5 ? 0.3 : 20.0);
  View view;
  for (std::size_t i = 0; i < 3; ++i) {
    view.eye[i] = instance.transform[4 * i + 3] + reach * (next() - 0.5);
    target[i] = view.eye[i] + next() - 0.5;
  }
  view.near_distance = 1e-3 * reach;
  view.height_px = 1080;
  return view;
}

void expect_cuts_of_what_is_resident(const Bytes& bytes) {
  const auto whole = AssetFile::view(bytes);
  ASSERT_TRUE(whole.ok());
  const Streamed streamed(bytes);
  const auto head = AssetFile::view_head(streamed.head, bytes.size());
  ASSERT_TRUE(head.ok());
  ResidentSelector selector = head->resident_selector();
  meshlode_selector* c_selector = nullptr;
  ASSERT_EQ(meshlode_create_selector(streamed.asset, &c_selector, nullptr), MESHLODE_OK);
  const std::size_t pages = whole->pages().size();
  std::vector<DrawItem> items;
  std::vector<meshlode_draw_item> c_items(whole->clusters().size() * whole->instances().size());
  std::uint32_t state = 7;
  for (int n = 0; n < 40; ++n) {
    std::array<double, 3> target{};
    const View view = random_view(state, *whole, target);
    const auto frustum = make_frustum(view, target, {0.0, 1.0, 0.0}, 1.5);
    ASSERT_TRUE(frustum.ok());
    meshlode_view c_view{{view.eye[0], view.eye[1], view.eye[2]},
                         0,
                         view.fovy_radians,
                         view.ortho_height,
                         view.near_distance,
                         view.height_px,
                         static_cast<std::uint32_t>(view.promise)};
    const double up[3] = {0.0, 1.0, 0.0};
    meshlode_frustum c_frustum{};
    ASSERT_EQ(meshlode_make_frustum(&c_view, target.data(), up, 1.5, &c_frustum, nullptr), MESHLODE_OK);
    ASSERT_EQ(std::memcmp(&c_frustum, &*frustum, sizeof(c_frustum)), 0);
    // Nothing, the pages with terminal groups, and what is asked for, one after another, until nothing is.
    std::vector<std::uint32_t> resident((pages + 31) / 32);
    const bool is_culled = n % 2 == 0;
    std::size_t loaded = 0;
    for (;;) {
      ASSERT_TRUE(selector.select(view, 1.0, resident, items, is_culled ? &*frustum : nullptr).ok());
      std::size_t count = 0;
      ASSERT_EQ(meshlode_select_resident(c_selector, &c_view, is_culled ? &c_frustum : nullptr, 1.0, resident.data(),
                                         c_items.data(), c_items.size(), &count, nullptr),
                MESHLODE_OK);
      ASSERT_EQ(count, items.size());
      ASSERT_TRUE(items.empty() || std::memcmp(items.data(), c_items.data(), count * sizeof(DrawItem)) == 0);
      const auto requests = selector.requests();
      std::size_t request_count = 0, priority_count = 0;
      const meshlode_page_request* c_requests = meshlode_page_requests(c_selector, &request_count);
      ASSERT_EQ(request_count, requests.size());
      ASSERT_TRUE(requests.empty() || std::memcmp(requests.data(), c_requests, requests.size_bytes()) == 0);
      const float* priorities = meshlode_page_priorities(c_selector, &priority_count);
      ASSERT_TRUE(std::ranges::equal(selector.page_priorities(), std::span(priorities, priority_count)));
      ASSERT_EQ(priority_count, pages);
      if (requests.empty()) break;
      ASSERT_TRUE(loaded > 0 || requests[0].priority == format::kInfiniteError);
      for (std::size_t r = 0; r < (requests.size() + 1) / 2; ++r) {
        resident[requests[r].page / 32] |= 1U << requests[r].page % 32;
        ++loaded;
      }
    }
    const auto all = whole->select_view(view, 1.0, is_culled ? &*frustum : nullptr);
    ASSERT_TRUE(all.ok());
    ASSERT_EQ(items.size(), all->size());
    ASSERT_TRUE(items.empty() || std::memcmp(items.data(), all->data(), items.size() * sizeof(DrawItem)) == 0);
    if (is_culled) {
      ASSERT_LE(items.size(), whole->select_view(view, 1.0)->size());
      std::size_t count = 0;
      ASSERT_EQ(meshlode_select_frustum(streamed.asset, &c_view, &c_frustum, 1.0, c_items.data(), c_items.size(),
                                        &count, nullptr),
                MESHLODE_OK);
      ASSERT_EQ(count, items.size());
    }
  }
  meshlode_destroy_selector(c_selector);
}

class HeadOfData : public testing::TestWithParam<const char*> {};

TEST_P(HeadOfData, PagesUnpackAndCutsAgreeInEveryCodec) {
  BuildOptions options;
  options.preset = Preset::kFast;
  const auto built = [&](format::Codec codec) -> Bytes {
    options.codec = codec;
    const std::string scene = std::string(MESHLODE_SOURCE_DIR) + "/data/" + GetParam() + ".glb";
    const std::string output = testing::TempDir() + "head_" + GetParam() + ".lode";
    const Status status = build_file(scene, output, options);
    EXPECT_TRUE(status.ok()) << status.error().message();
    const auto file = MappedFile::open(output);
    Bytes bytes;
    if (file) bytes.assign(file->bytes().begin(), file->bytes().end());
    std::filesystem::remove(output);
    return bytes;
  };
  const Bytes plain = built(format::Codec::kNone);
  ASSERT_FALSE(plain.empty());
  expect_cuts_of_what_is_resident(plain);
  for (const format::Codec codec :
       {format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd, format::Codec::kDraco}) {
    SCOPED_TRACE(static_cast<int>(codec));
    const Bytes stored = test::stored_as(plain, codec);
    ASSERT_FALSE(stored.empty());
    expect_pages_unpack(stored);
  }
  const Bytes strips = built(format::Codec::kStrips);
  ASSERT_FALSE(strips.empty());
  expect_pages_unpack(strips);
  expect_cuts_of_what_is_resident(strips);
}

INSTANTIATE_TEST_SUITE_P(Data, HeadOfData, testing::Values("city", "crystal", "foliage", "rock", "terrain"),
                         [](const auto& name) { return std::string(name.param); });

TEST(ApiHead, WhatMakesNoSenseIsAnError) {
  const test::Arrays arrays(lab::make_sphere(12));
  const auto bytes = test::build_one(arrays.primitive());
  ASSERT_TRUE(bytes.ok());
  const Streamed streamed(*bytes);
  meshlode_error error{};
  std::uint64_t needed = 77;
  EXPECT_EQ(meshlode_head_bytes(nullptr, 0, bytes->size(), &needed, &error), MESHLODE_TOO_SMALL);
  EXPECT_EQ(needed, 64U);
  EXPECT_EQ(meshlode_head_bytes(nullptr, 1, bytes->size(), &needed, &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_head_bytes(bytes->data(), 64, bytes->size() - 1, &needed, &error), MESHLODE_INVALID);
  EXPECT_STREQ(std::string(error.text).substr(0, 24).c_str(), "header, field file_bytes");
  meshlode_asset* none = nullptr;
  EXPECT_EQ(meshlode_open_head(streamed.head.data(), streamed.head.size() - 1, bytes->size(), &none, &error),
            MESHLODE_INVALID);
  EXPECT_EQ(std::string(error.text).substr(0, 5), "head:");
  EXPECT_EQ(meshlode_open_head(streamed.head.data() + 1, streamed.head.size() - 1, bytes->size(), &none, &error),
            MESHLODE_USAGE);
  EXPECT_EQ(none, nullptr);

  std::vector<std::uint32_t> words(MESHLODE_MAX_PAGE_BYTES / 4);
  const void* view = nullptr;
  EXPECT_EQ(meshlode_load_page(streamed.asset, 0, words.data(), 4 * words.size(), &error), MESHLODE_USAGE);
  EXPECT_EQ(std::string(error.text).substr(0, 7), "page 0:");
  EXPECT_NE(meshlode_view_page(streamed.asset, 0, &view, &error), MESHLODE_OK);
  EXPECT_EQ(view, nullptr);
  const meshlode_range range = meshlode_page_range(streamed.asset, 0);
  const auto stored = streamed.read(range.offset, range.bytes);
  EXPECT_EQ(
      meshlode_unpack_page(streamed.asset, 0, stored.data(), stored.size() - 1, words.data(), 4 * words.size(), &error),
      MESHLODE_USAGE);
  EXPECT_EQ(meshlode_unpack_page(streamed.asset, 0, stored.data(), stored.size(), words.data(), 4, &error),
            MESHLODE_TOO_SMALL);
  EXPECT_EQ(meshlode_unpack_page(streamed.asset, 0, nullptr, 0, words.data(), 4 * words.size(), &error),
            MESHLODE_USAGE);
  EXPECT_EQ(meshlode_unpack_page(streamed.asset, 0xFFFFFFFFU, stored.data(), stored.size(), words.data(),
                                 4 * words.size(), &error),
            MESHLODE_USAGE);
  Bytes broken(stored.begin(), stored.end());
  broken[broken.size() / 2] ^= 4U;
  EXPECT_EQ(
      meshlode_unpack_page(streamed.asset, 0, broken.data(), broken.size(), words.data(), 4 * words.size(), &error),
      MESHLODE_INVALID);
  EXPECT_EQ(std::string(error.text).substr(0, 22), "page 0, field checksum");
  EXPECT_EQ(meshlode_page_range(streamed.asset, 0xFFFFFFFFU).bytes, 0U);
  EXPECT_EQ(meshlode_blob_range(streamed.asset, 0).bytes, 0U);
  EXPECT_EQ(meshlode_check_blob(streamed.asset, 0, nullptr, 0, &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_image_of_texture(streamed.asset, 0), MESHLODE_NONE);
  EXPECT_EQ(meshlode_blob_of_image(streamed.asset, 0), MESHLODE_NONE);

  meshlode_view look{{0, 0, 3}, 0, 0.8, 0, 0.01, 720, 0};
  meshlode_frustum frustum{};
  const double at[3] = {0, 0, 0}, up[3] = {0, 1, 0}, along[3] = {0, 0, -2}, infinite[3] = {HUGE_VAL, 0, 0};
  EXPECT_EQ(meshlode_make_frustum(&look, at, up, 1.5, &frustum, &error), MESHLODE_OK);
  EXPECT_EQ(meshlode_make_frustum(&look, look.eye, up, 1.5, &frustum, &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_make_frustum(&look, at, along, 1.5, &frustum, &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_make_frustum(&look, infinite, up, 1.5, &frustum, &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_make_frustum(&look, at, up, 0.0, &frustum, &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_make_frustum(&look, at, up, HUGE_VAL, &frustum, &error), MESHLODE_USAGE);
  look.height_px = 0;
  EXPECT_EQ(meshlode_make_frustum(&look, at, up, 1.5, &frustum, &error), MESHLODE_USAGE);
  meshlode_selector* selector = nullptr;
  ASSERT_EQ(meshlode_create_selector(streamed.asset, &selector, &error), MESHLODE_OK);
  std::size_t count = 0;
  EXPECT_EQ(meshlode_select_resident(selector, &look, nullptr, 1.0, nullptr, nullptr, 0, &count, &error),
            MESHLODE_USAGE);
  look.height_px = 720;
  EXPECT_EQ(meshlode_select_resident(selector, &look, nullptr, -1.0, nullptr, nullptr, 0, &count, &error),
            MESHLODE_USAGE);
  EXPECT_EQ(meshlode_select_resident(selector, &look, nullptr, 1.0, nullptr, nullptr, 0, &count, &error), MESHLODE_OK);
  EXPECT_EQ(count, 0U);
  std::uint32_t all[8];
  std::fill(std::begin(all), std::end(all), 0xFFFFFFFFU);
  EXPECT_EQ(meshlode_select_resident(selector, &look, &frustum, 1.0, all, nullptr, 0, &count, &error),
            MESHLODE_TOO_SMALL);
  EXPECT_GT(count, 0U);
  meshlode_destroy_selector(selector);
  meshlode_destroy_selector(nullptr);

  auto taken = AssetFile::take_head(streamed.head, bytes->size());
  ASSERT_TRUE(taken.ok());
  EXPECT_FALSE(taken->load_page(0).ok());
  EXPECT_EQ(taken->streaming_order()->size(), taken->pages().size());
  AssetFile moved = std::move(*taken);
  ResidentSelector one = moved.resident_selector();
  ResidentSelector other = std::move(one);
  std::vector<DrawItem> items;
  EXPECT_FALSE(other.select({}, -1.0, {}, items).ok());
  EXPECT_TRUE(other.select({}, 1.0, {}, items).ok());
  EXPECT_TRUE(items.empty());
  EXPECT_FALSE(other.requests().empty());
}

}  // namespace
}  // namespace meshlode
