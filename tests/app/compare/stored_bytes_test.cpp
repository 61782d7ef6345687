// SPDX-License-Identifier: GPL-3.0-or-later
// Damage that opening an asset does not see.
#include "app/compare/stored_bytes.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/export/build_scene.h"
#include "scene/scene.h"

namespace meshlode::app {
namespace {

std::size_t offset_in(const run::Asset& asset, std::span<const std::uint8_t> part) {
  return static_cast<std::size_t>(part.data() - asset.bytes().data());
}

/// What is told of the bytes with the one at `at` changed, which opening them accepts.
std::string told_of(std::vector<std::uint8_t> bytes, std::size_t at) {
  bytes[at] ^= 0x40U;
  const auto asset = run::Asset::from_vector(std::move(bytes));
  EXPECT_TRUE(asset.ok()) << at;
  if (!asset) return {};
  const Status status = check_stored_bytes(*asset);
  if (status) return "sound";
  EXPECT_EQ(status.error().code, ErrorCode::kInvalid);
  return status.error().where;
}

TEST(StoredBytes, AChangedByteOfAPageOrAnImageIsNamed) {
  scene::Scene scene = test::make_rock_scene(8);
  for (std::uint32_t i = 0; i < 2; ++i) {
    scene.blobs.push_back({scene::SceneBlob::Kind::kImage, "image", "image/png", i, std::vector<std::uint8_t>(100, 7)});
  }
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_vector(bytes).value();
  EXPECT_TRUE(check_stored_bytes(asset).ok());
  ASSERT_FALSE(asset.pages().empty());
  ASSERT_EQ(asset.blobs().size(), 2U);
  for (std::size_t i = 0; i < asset.pages().size(); ++i) {
    const auto page = asset.stored_page(PageId(i));
    for (const std::size_t at : {std::size_t{0}, page.size() / 2, page.size() - 1}) {
      EXPECT_EQ(told_of(bytes, offset_in(asset, page) + at), "page " + std::to_string(i) + ", field checksum");
    }
  }
  for (std::size_t i = 0; i < asset.blobs().size(); ++i) {
    const auto blob = asset.blob_bytes(asset.blobs()[i]);
    EXPECT_EQ(told_of(bytes, offset_in(asset, blob) + blob.size() - 1),
              "blob " + std::to_string(i) + ", field checksum");
  }
}

}  // namespace
}  // namespace meshlode::app
