// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader asks before it loads a page: the ranges of the first pages, and hints, in C as in C++.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshlode/build.h>
#include <meshlode/meshlode.h>
#include <meshlode/runtime.h>

#include "arrays.h"
#include "base/file.h"
#include "base/random.h"

namespace meshlode {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Pages that a selection marks as those without which nothing is drawn.
std::set<std::uint32_t> first_pages(const AssetFile& asset) {
  ResidentSelector selector = asset.resident_selector();
  std::vector<DrawItem> items;
  EXPECT_TRUE(selector.select({}, 1.0, {}, items).ok());
  std::set<std::uint32_t> pages;
  for (std::uint32_t p = 0; p < asset.pages().size(); ++p) {
    if (selector.page_priorities()[p] == format::kInfiniteError) pages.insert(p);
  }
  return pages;
}

void expect_first_ranges(const Bytes& bytes) {
  const auto asset = AssetFile::view(bytes);
  ASSERT_TRUE(asset.ok());
  meshlode_asset* c_asset = nullptr;
  ASSERT_EQ(meshlode_open_buffer(bytes.data(), bytes.size(), &c_asset, nullptr), MESHLODE_OK);
  const std::set<std::uint32_t> wanted = first_pages(*asset);
  ASSERT_FALSE(wanted.empty());
  for (const std::uint64_t gap : {0ULL, 15ULL, 20000ULL, ~0ULL}) {
    const std::vector<ByteRange> ranges = asset->first_ranges(gap);
    std::set<std::uint32_t> held;
    for (std::uint32_t p = 0; p < asset->pages().size(); ++p) {
      const ByteRange page = asset->page_range(p);
      for (const ByteRange& range : ranges) {
        const bool is_in = range.offset <= page.offset && page.offset + page.bytes <= range.offset + range.bytes;
        if (is_in) held.insert(p);
        const bool meets = range.offset < page.offset + page.bytes && page.offset < range.offset + range.bytes;
        ASSERT_TRUE(is_in || !meets) << "half of page " << p;
      }
    }
    ASSERT_TRUE(std::ranges::includes(held, wanted));
    ASSERT_TRUE(gap >= 16 || held == wanted) << "nothing else is read";
    ASSERT_TRUE(gap != ~0ULL || ranges.size() == 1);
    for (std::size_t r = 0; r < ranges.size(); ++r) {
      ASSERT_TRUE(wanted.contains(*std::ranges::find_if(wanted, [&](std::uint32_t p) {
        return asset->page_range(p).offset == ranges[r].offset;
      }))) << "a range begins with a first page";
      if (r == 0) continue;
      ASSERT_GT(ranges[r].offset - (ranges[r - 1].offset + ranges[r - 1].bytes), std::max<std::uint64_t>(gap, 15));
    }
    std::vector<meshlode_range> c_ranges(ranges.size());
    std::size_t count = 0;
    ASSERT_EQ(meshlode_first_ranges(c_asset, gap, c_ranges.data(), c_ranges.size(), &count, nullptr), MESHLODE_OK);
    ASSERT_EQ(count, ranges.size());
    ASSERT_EQ(std::memcmp(c_ranges.data(), ranges.data(), count * sizeof(ByteRange)), 0);
    meshlode_error error{};
    ASSERT_EQ(meshlode_first_ranges(c_asset, gap, nullptr, 0, &count, &error), MESHLODE_TOO_SMALL);
    ASSERT_EQ(count, ranges.size());
  }
  meshlode_close(c_asset);
}

View random_view(SplitMix64& random, const AssetFile& asset, std::array<double, 3>& target) {
  const format::InstanceRecord& instance = asset.instances()[random.below(asset.instances().size())];
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  const double reach = instance.scale * mesh.diagonal * std::exp2(random.between(-3.0, 6.0));
  View view;
  for (std::size_t i = 0; i < 3; ++i) {
    view.eye[i] = instance.transform[4 * i + 3] + reach * random.between(-1.0, 1.0);
    target[i] = instance.transform[4 * i + 3] + 0.2 * reach * random.between(-1.0, 1.0);
  }
  view.near_distance = 1e-3 * reach;
  view.height_px = 1080;
  return view;
}

/// The projected error of a hint, in pixels, the largest over the instances of its mesh: what a reader ranks pages by.
double projected_hint(const AssetFile& asset, const View& view, std::uint32_t mesh_id,
                      const format::PageHintRecord& hint) {
  const format::MeshRecord& mesh = asset.meshes()[mesh_id];
  const double pixels = view.height_px / (2.0 * std::tan(0.5 * view.fovy_radians));
  double largest = 0.0;
  for (const format::InstanceRecord& instance : asset.instances()) {
    if (instance.mesh != mesh_id || (instance.flags & format::kInstanceSingular) != 0) continue;
    double square = 0.0;
    for (std::size_t row = 0; row < 3; ++row) {
      const double* m = instance.transform + 4 * row;
      double at = m[3] - view.eye[row];
      for (std::size_t i = 0; i < 3; ++i) at += m[i] * (mesh.origin[i] + double{hint.center[i]});
      square += at * at;
    }
    // Priorities are of floats: what is left of the two lengths has the rounding of both, a dozen times 2^-24.
    const double reach = double{hint.radius} * instance.scale;
    const double least = std::sqrt(square) - reach - 1e-6 * (std::sqrt(square) + reach);
    largest =
        std::max(largest, double{hint.largest_error} * instance.scale * pixels / std::max(least, view.near_distance));
  }
  return largest;
}

/// A hint never says less than the selection finds a page worth, culled or not.
void expect_hints_bound_priorities(const Bytes& bytes) {
  const auto asset = AssetFile::view(bytes);
  ASSERT_TRUE(asset.ok());
  meshlode_asset* c_asset = nullptr;
  ASSERT_EQ(meshlode_open_buffer(bytes.data(), bytes.size(), &c_asset, nullptr), MESHLODE_OK);
  std::vector<format::PageHintRecord> hints;
  for (std::uint32_t p = 0; p < asset->pages().size(); ++p) {
    hints.push_back(asset->page_hint(p));
    const meshlode_hint c_hint = meshlode_page_hint(c_asset, p);
    ASSERT_EQ(std::memcmp(&c_hint, &hints[p], sizeof(c_hint)), 0);
  }
  EXPECT_EQ(meshlode_page_hint(c_asset, static_cast<std::uint32_t>(hints.size())).largest_error, 0.0F);
  meshlode_close(c_asset);
  ResidentSelector selector = asset->resident_selector();
  std::vector<DrawItem> items;
  SplitMix64 random(11);
  double tightest = HUGE_VAL;
  std::uint64_t compared = 0;
  for (int n = 0; n < 200; ++n) {
    std::array<double, 3> target{};
    const View view = random_view(random, *asset, target);
    const auto frustum = make_frustum(view, target, {0.0, 1.0, 0.0}, 1.5);
    if (!frustum) continue;
    ASSERT_TRUE(selector.select(view, 1.0, {}, items, n % 2 == 0 ? nullptr : &*frustum).ok());
    for (std::uint32_t p = 0; p < hints.size(); ++p) {
      const float priority = selector.page_priorities()[p];
      if (priority == format::kInfiniteError) {
        ASSERT_EQ(hints[p].largest_error, format::kInfiniteError);
      } else if (priority > 0.0F) {
        const std::uint32_t mesh = asset->groups()[asset->pages()[p].first_group].mesh;
        const double ratio = projected_hint(*asset, view, mesh, hints[p]) / double{priority};
        ASSERT_GE(ratio, 1.0 - 4e-6) << "page " << p << ", view " << n;
        tightest = std::min(tightest, ratio);
        ++compared;
      }
    }
  }
  if (compared > 100) {
    EXPECT_LT(tightest, 1.5) << "a bound that is never near says nothing";
  }
}

Bytes built(const std::string& name, BuildOptions options) {
  options.preset = Preset::kFast;
  const std::string output = testing::TempDir() + "first_" + name + std::to_string(::getpid()) + ".lode";
  const Status status = build_file(std::string(MESHLODE_SOURCE_DIR) + "/data/" + name + ".glb", output, options);
  EXPECT_TRUE(status.ok()) << status.error().message();
  const auto file = MappedFile::open(output);
  Bytes bytes;
  if (file) bytes.assign(file->bytes().begin(), file->bytes().end());
  std::filesystem::remove(output);
  return bytes;
}

class FirstPages : public testing::TestWithParam<const char*> {};

TEST_P(FirstPages, RangesHoldThemAndHintsBoundWhatIsFound) {
  BuildOptions options;
  options.page_size = 16;  // so that there are pages behind the first
  const Bytes bytes = built(GetParam(), options);
  ASSERT_FALSE(bytes.empty());
  expect_first_ranges(bytes);
  expect_hints_bound_priorities(bytes);
}

INSTANTIATE_TEST_SUITE_P(Data, FirstPages, testing::Values("city", "crystal", "foliage", "rock", "terrain"),
                         [](const auto& name) { return std::string(name.param); });

TEST(FirstPages, ManySmallMeshesTakeOneRead) {
  const test::Arrays arrays(lab::make_sphere(4));
  const PrimitiveInput primitive = arrays.primitive();
  const std::vector<MeshInput> meshes(40, MeshInput{"sphere", {&primitive, 1}});
  SceneInput scene;
  scene.meshes = meshes;
  BuildOptions options;
  options.preset = Preset::kFast;
  const auto bytes = build_asset(scene, options);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  const auto asset = AssetFile::view(*bytes);
  ASSERT_TRUE(asset.ok());
  EXPECT_EQ(asset->pages().size(), 40U);
  const auto ranges = asset->first_ranges();
  ASSERT_EQ(ranges.size(), 1U);
  EXPECT_EQ(ranges[0].offset, asset->page_range(0).offset);
  EXPECT_EQ(ranges[0].offset + ranges[0].bytes, asset->page_range(39).offset + asset->page_range(39).bytes);
}

TEST(FirstPages, HintsAreStoredOnDemandAndChangeNothingElse) {
  BuildOptions options;
  const Bytes without = built("rock", options);
  options.page_hints = true;
  const Bytes with = built("rock", options);
  const auto asset = AssetFile::view(with), plain = AssetFile::view(without);
  ASSERT_TRUE(asset.ok() && plain.ok());
  const auto section_of = [](const Bytes& file, std::uint32_t id) -> const format::SectionEntry* {
    const auto* entries = reinterpret_cast<const format::SectionEntry*>(file.data() + sizeof(format::FileHeader));
    const auto count = reinterpret_cast<const format::FileHeader*>(file.data())->section_count;
    const auto* found = std::find_if(entries, entries + count, [&](const auto& entry) { return entry.id == id; });
    return found == entries + count ? nullptr : found;
  };
  const auto id = static_cast<std::uint32_t>(format::SectionId::kPageHints);
  EXPECT_EQ(section_of(without, id), nullptr);
  const format::SectionEntry* const entry = section_of(with, id);
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->record_count, asset->pages().size());
  EXPECT_EQ(entry->flags, 0U) << "who does not know it skips it";
  EXPECT_EQ(std::memcmp(asset->header().content_hash, plain->header().content_hash, 16), 0);
  ASSERT_EQ(entry->codec, 0U) << "so few bytes do not shrink";
  for (std::uint32_t p = 0; p < asset->pages().size(); ++p) {
    const format::PageHintRecord hint = asset->page_hint(p);
    EXPECT_EQ(std::memcmp(with.data() + entry->offset + p * sizeof(hint), &hint, sizeof(hint)), 0);
  }
}

}  // namespace
}  // namespace meshlode
