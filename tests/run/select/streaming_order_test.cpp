// SPDX-License-Identifier: GPL-3.0-or-later
// What an asset's pages are loaded in, against its tables.
#include "run/select/streaming_order.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"

namespace meshlode::run {
namespace {

Asset built(const scene::Scene& scene) {
  builder::PipelineOptions options;
  options.page_kib = 16;
  options.codec = format::Codec::kNone;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes) << bytes.error().message();
  auto asset = Asset::from_vector(std::move(*bytes));
  EXPECT_TRUE(asset) << asset.error().message();
  return std::move(*asset);
}

scene::Scene two_rocks() {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_rock(28)));
  scene.meshes.push_back(lab::as_mesh(lab::make_rock(20)));
  scene::SceneInstance second = scene.instances.at(0);
  second.mesh = MeshId(1U);
  scene.instances.push_back(second);
  return scene;
}

/// A page waits for none that matters less: neither what it depends on, nor what has the larger errors.
TEST(StreamingOrder, BeginsWithWhatIsOffByMost) {
  const Asset asset = built(two_rocks());
  const std::size_t count = asset.pages().size();
  ASSERT_GT(count, 6U);
  std::vector<float> errors(count, 0.0F);
  for (std::size_t p = count; p-- > 0;) {
    const format::PageRecord& page = asset.pages()[p];
    for (const format::GroupRecord& group : asset.groups().subspan(page.first_group, page.group_count))
      errors[p] = std::max(errors[p], group.error);
    for (const std::uint32_t needed : asset.page_dependencies().subspan(page.first_dependency, page.dependency_count))
      errors[needed] = std::max(errors[needed], errors[p]);
  }
  EXPECT_GT(*std::max_element(errors.begin(), errors.end()), *std::min_element(errors.begin(), errors.end()));
  const std::vector<std::uint32_t> order = streaming_order(asset);
  std::vector<std::size_t> place(count, count);
  for (std::size_t i = 0; i < order.size(); ++i) place.at(order[i]) = i;
  ASSERT_EQ(order.size(), count);
  for (std::size_t i = 1; i < count; ++i) EXPECT_GE(errors[order[i - 1]], errors[order[i]]) << i;
  for (std::size_t p = 0; p < count; ++p) {
    ASSERT_LT(place[p], count) << "each page once";
    const format::PageRecord& page = asset.pages()[p];
    for (const std::uint32_t needed : asset.page_dependencies().subspan(page.first_dependency, page.dependency_count))
      EXPECT_LT(place[needed], place[p]);
  }
}

/// The first picture needs the coarsest groups of what is drawn, and no other page.
TEST(StreamingOrder, FirstRangesAreThePagesOfRoots) {
  const Asset asset = built(two_rocks());
  const std::vector<FileRange> ranges = first_ranges(asset, 0);
  std::uint64_t bytes = 0, of_pages = 0;
  for (const FileRange& range : ranges) bytes += range.bytes;
  for (const format::PageRecord& page : asset.pages()) {
    const auto groups = asset.groups().subspan(page.first_group, page.group_count);
    const bool has_root = std::any_of(groups.begin(), groups.end(), [](const format::GroupRecord& group) {
      return (group.flags & format::kGroupTerminal) != 0;
    });
    const bool is_there = std::any_of(ranges.begin(), ranges.end(), [&](const FileRange& range) {
      return range.offset <= page.offset && page.offset + page.stored_bytes <= range.offset + range.bytes;
    });
    EXPECT_EQ(is_there, has_root);
    of_pages += has_root ? page.stored_bytes : 0;
  }
  EXPECT_GE(bytes, of_pages);
  EXPECT_LE(bytes, of_pages + ranges.size() * format::kSectionAlignment);
}

}  // namespace
}  // namespace meshlode::run
