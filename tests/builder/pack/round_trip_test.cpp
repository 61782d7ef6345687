// SPDX-License-Identifier: GPL-3.0-or-later
// What pack makes of a page, unpack makes the same page of, byte for byte, whatever the page says.
#include <cstring>

#include <gtest/gtest.h>

#include "builder/pack/pack.h"
#include "builder/pack/page_model.h"
#include "run/unpack/unpack_page.h"
#include "support/old_codecs/old_codecs.h"
#include "support/random_page.h"

namespace meshlode::builder {
namespace {

using format::Codec;
using test::RandomPage;
using test::RandomPageOptions;

std::span<const std::uint8_t> bytes_of(const RandomPage& page) {
  return {reinterpret_cast<const std::uint8_t*>(page.words.data()), page.words.size() * 4};
}

std::vector<RandomPageOptions> every_shape() {
  std::vector<RandomPageOptions> shapes;
  for (std::uint32_t mask = 0; mask < 16; ++mask) {
    RandomPageOptions options;
    options.seed = 100 + mask;
    options.has_normals = (mask & 1U) != 0;
    options.has_color = (mask & 2U) != 0;
    options.has_material_ranges = (mask & 4U) != 0;
    options.uv_set_count = (mask & 8U) != 0 ? mask % 5 : 0;
    shapes.push_back(options);
  }
  return shapes;
}

void expect_round_trip(const RandomPage& page, Codec codec) {
  const auto stored = test::store_page(page.mesh, bytes_of(page), codec);  // noise does not shrink
  ASSERT_TRUE(stored) << stored.error().detail;
  format::PageRecord record = page.record;
  record.codec = codec;
  std::vector<std::uint32_t> out(page.words.size());
  ASSERT_EQ(run::unpack_page(page.mesh, record, *stored, out), run::UnpackOutcome::kOk);
  EXPECT_EQ(out, page.words);
}

TEST(Pack, EveryCodecGivesEveryShapeOfPageBack) {
  for (RandomPageOptions options : every_shape()) {
    for (std::uint64_t round = 0; round < 4; ++round) {
      options.seed += 1000;
      options.max_field_bits = round < 3 ? 5 : 25;  // few bits shrink, many test the widths
      const RandomPage page = test::make_random_page(options);
      for (const Codec codec : {Codec::kLz4, Codec::kZstd, Codec::kStrips, Codec::kDraco}) {
        if (codec == Codec::kDraco && round == 3 && options.seed % 5 != 0)
          continue;  // its tables for wide noise are slow
        SCOPED_TRACE("seed " + std::to_string(options.seed) + ", codec " + std::to_string(static_cast<int>(codec)));
        expect_round_trip(page, codec);
      }
    }
  }
}

TEST(Pack, ClustersOfOneTriangleAndOf256VerticesComeBack) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    expect_round_trip(
        test::make_random_page({.seed = seed, .cluster_count = 40, .max_triangles = 1, .max_field_bits = 4}),
        Codec::kStrips);
    expect_round_trip(
        test::make_random_page({.seed = seed, .cluster_count = 3, .max_triangles = 256, .max_field_bits = 6}),
        Codec::kStrips);
  }
}

TEST(Pack, TheSamePageGivesTheSameBytes) {
  const RandomPage page = test::make_random_page({.seed = 5, .max_field_bits = 5});
  for (const Codec codec : {Codec::kLz4, Codec::kZstd, Codec::kStrips, Codec::kDraco}) {
    const auto first = test::store_page(page.mesh, bytes_of(page), codec);
    const auto second = test::store_page(page.mesh, bytes_of(page), codec);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(*first, *second);
  }
}

TEST(Pack, APageThatDoesNotShrinkIsStoredAsItIs) {
  const RandomPage page = test::make_random_page({.seed = 9, .cluster_count = 1, .max_triangles = 1});
  const auto packed = test::pack_page(page.mesh, bytes_of(page), Codec::kZstd);
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->codec, Codec::kNone);
  EXPECT_TRUE(packed->bytes.empty());
}

TEST(Pack, OldCodecsAreNotWritten) {
  const RandomPage page = test::make_random_page({.seed = 5, .max_field_bits = 5});
  for (const Codec codec : {Codec::kLz4, Codec::kZstd, Codec::kDraco}) {
    EXPECT_FALSE(pack_page(page.mesh, bytes_of(page), codec));
    EXPECT_FALSE(store_page(page.mesh, bytes_of(page), codec));
  }
}

/// Vertices that an earlier cluster has are named, not stored again.
TEST(Pack, TwinsAreFound) {
  RandomPage page = test::make_random_page({.seed = 3, .cluster_count = 12, .max_field_bits = 12});
  const auto model = model_page(page.mesh, page.words);
  ASSERT_TRUE(model);
  EXPECT_GT(model->streams[format::kTwinStream].size(), 0U);
}

/// On a strip over a plane the parallelogram is exact: all errors but those of the first vertices are zero.
TEST(Pack, ParallelogramsAreExactOnAPlane) {
  constexpr std::uint32_t kTriangles = 64;
  constexpr std::uint32_t kVertices = kTriangles + 2;
  RandomPage page;
  page.mesh.material = 0;
  page.record.cluster_count = 1;
  page.words = {0, 1, 0, 0, 0, 0, 0};
  std::uint32_t* const head = page.words.data() + 2;
  format::put_field(head, format::head::kVerticesLess1, kVertices - 1);
  format::put_field(head, format::head::kTrianglesLess1, kTriangles - 1);
  format::put_field(head, format::head::kDataWord, 7);
  format::put_field(head, format::head::kReferenceBits, 1);
  for (std::size_t axis = 0; axis < 3; ++axis) format::put_field(head, format::head::kBits[axis], 8);
  std::vector<bool> bits;
  const auto put = [&bits](std::uint32_t value, std::uint32_t count) {
    for (std::uint32_t bit = 0; bit < count; ++bit) bits.push_back((value >> bit & 1U) != 0);
  };
  for (std::uint32_t v = 0; v < kVertices; ++v) {  // a zigzag between two parallel lines
    put(3 * (v / 2) + v % 2, 8);
    put(v / 2 + 5 * (v % 2), 8);
    put(v / 2 + 7 * (v % 2), 8);
  }
  for (std::uint32_t t = 0; t < kTriangles; ++t) put(t % 2, 1);
  for (std::uint32_t s = 0; s < kVertices; ++s) put(1, 1);
  page.words.resize(7 + (bits.size() + 31) / 32 + 1);
  for (std::size_t i = 0; i < bits.size(); ++i) page.words[7 + i / 32] |= (bits[i] ? 1U : 0U) << i % 32;

  const auto model = model_page(page.mesh, page.words);
  ASSERT_TRUE(model);
  for (std::uint32_t field = 0; field < 3; ++field) {
    const auto& errors = model->streams[format::kFieldStreams + field];
    ASSERT_EQ(errors.size(), kVertices);
    for (std::size_t v = 3; v < errors.size(); ++v) EXPECT_EQ(errors[v], 0U) << field << " " << v;
  }
}

/// Bytes that no writer makes have no model, rather than one that loses them.
TEST(Pack, PagesWithGapsOrDirtyPaddingAreRefused) {
  const RandomPage page = test::make_random_page({.seed = 21, .max_field_bits = 5});
  ASSERT_TRUE(model_page(page.mesh, page.words));
  RandomPage longer = page;
  longer.words.push_back(0);
  EXPECT_FALSE(model_page(page.mesh, longer.words));
  RandomPage dirty = page;
  dirty.words.back() = 1;
  EXPECT_FALSE(model_page(page.mesh, dirty.words));
  EXPECT_FALSE(pack_page(page.mesh, bytes_of(dirty), Codec::kZstd));
  RandomPage shifted = page;
  shifted.words[2] += 1U << 16U;  // the first cluster's data word
  EXPECT_FALSE(model_page(page.mesh, shifted.words));
}

}  // namespace
}  // namespace meshlode::builder
