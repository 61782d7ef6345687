// SPDX-License-Identifier: GPL-3.0-or-later
// The byte map as JSON has it: the parts of a file, of its pages, its blobs and its levels leave nothing over.
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/report/info.h"
#include "app/report/rows.h"
#include "support/sample_asset.h"

namespace meshlode::app {
namespace {

using Json = nlohmann::json;

Json json_of(const run::Asset& asset) {
  AssetInfo info = describe_asset(asset);
  auto map = map_bytes(asset);
  EXPECT_TRUE(map);
  info.byte_map = *map;
  return Json::parse(info_json(asset, info, false));
}

double sum_of(const Json& list, const char* key) {
  double sum = 0.0;
  for (const Json& one : list) sum += one.at(key).get<double>();
  return sum;
}

double section_bytes(const Json& info, const std::string& name) {
  for (const Json& section : info.at("sections")) {
    if (section.at("name") == name) return section.at("bytes");
  }
  ADD_FAILURE() << "no section " << name;
  return 0.0;
}

class ByteMapJson : public ::testing::TestWithParam<format::Codec> {};

TEST_P(ByteMapJson, PartsLeaveNothingOfTheFileOver) {
  const run::Asset asset = *run::Asset::from_vector(test::sample_asset_bytes(GetParam()));
  const Json info = json_of(asset);
  const Json& map = info.at("byte_map");
  EXPECT_EQ(info.at("file_bytes"), asset.bytes().size());
  EXPECT_EQ(map.at("head_bytes").get<double>() + map.at("alignment_bytes").get<double>() +
                sum_of(info.at("sections"), "bytes"),
            asset.bytes().size());
  EXPECT_GT(map.at("alignment_bytes"), 0);
  EXPECT_GT(map.at("head_bytes"), 64) << "a header and a table";

  double blobs = 0.0;  // images, and buffers of the document, which JSON does not list
  for (const format::BlobRecord& blob : asset.blobs()) blobs += static_cast<double>(blob.bytes);
  EXPECT_EQ(map.at("blob_alignment_bytes").get<double>() + blobs, section_bytes(info, "BLOB"));

  ASSERT_GE(map.at("levels").size(), 2U);
  EXPECT_NEAR(map.at("page_alignment_bytes").get<double>() + sum_of(map.at("levels"), "stored"),
              section_bytes(info, "PAGE"), 1e-6);
  EXPECT_EQ(sum_of(map.at("levels"), "total"), map.at("pages").at("total").get<double>());
  for (const Json& level : map.at("levels")) {
    EXPECT_GT(level.at("stored"), 0.0);
    double streams = 0.0;
    for (const char* name : {"heads", "materials", "positions", "normals", "uvs", "colors", "topology", "padding"}) {
      streams += level.at(name).get<double>();
    }
    EXPECT_EQ(streams, level.at("total").get<double>());
    // What is stored as it is takes what it takes decoded.
    if (GetParam() == format::Codec::kNone) {
      EXPECT_NEAR(level.at("stored").get<double>(), level.at("total").get<double>(), 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Codecs, ByteMapJson, ::testing::Values(format::Codec::kNone, format::Codec::kStrips));

TEST(RoundedText, HalvesGoUpAsOnThePage) {
  EXPECT_EQ(rounded_text(0.5, 0), "1");
  EXPECT_EQ(rounded_text(1.5, 0), "2");
  EXPECT_EQ(rounded_text(2.5, 0), "3");
  EXPECT_EQ(rounded_text(2.4375, 0), "2");
  EXPECT_EQ(rounded_text(33.34, 1), "33.3");
}

}  // namespace
}  // namespace meshlode::app
