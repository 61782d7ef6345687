// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include <gtest/gtest.h>

#include "scene/import/json.h"

namespace meshlode::scene {
namespace {

TEST(ImportJson, WhatIsCarriedThroughComesOutAsItWentIn) {
  const std::string text =
      R"({"z":1,"a":[true,false,null],"n":-5,"u":18446744073709551615,"d":0.1,"e":1e-300,"s":"ä\n","o":{"k":[]}})";
  const auto json = parse_json(text);
  ASSERT_TRUE(json) << json.error().detail;
  const std::string again = dump_json(*json);
  const auto second = parse_json(again);
  ASSERT_TRUE(second);
  EXPECT_EQ(dump_json(*second), again);
  EXPECT_LT(again.find("\"z\""), again.find("\"a\""));  // order is kept
  EXPECT_NE(again.find("18446744073709551615"), std::string::npos);
  EXPECT_NE(again.find("0.1"), std::string::npos);
}

TEST(ImportJson, IndicesAreWholeAndNotNegative) {
  const auto json = parse_json("[0, 3.0, 1.5, -1, 1e300, \"1\", 9007199254740992]");
  ASSERT_TRUE(json);
  const Json::Array& a = *json->array();
  EXPECT_EQ(a[0].index(), 0U);
  EXPECT_EQ(a[1].index(), 3U);
  EXPECT_FALSE(a[2].index());
  EXPECT_FALSE(a[3].index());
  EXPECT_FALSE(a[4].index());
  EXPECT_FALSE(a[5].index());
  EXPECT_EQ(a[6].index(), 9007199254740992U);
}

TEST(ImportJson, RefusesWhatReadersDisagreeOn) {
  EXPECT_FALSE(parse_json("{\"a\":1,\"b\":2,\"a\":3}"));  // duplicate key
  EXPECT_FALSE(parse_json("{\"a\":1e999}"));              // no double
  EXPECT_FALSE(parse_json("{\"a\":NaN}"));
  EXPECT_FALSE(parse_json("{} {}"));
  EXPECT_FALSE(parse_json("\"\xff\""));  // not UTF-8
  EXPECT_TRUE(parse_json("{\"a\":{\"a\":{\"a\":1}}}"));
}

TEST(ImportJson, TextsAreTheShortest) {
  for (const char* text :
       {R"({"a":[],"b":{},"c":[1,-2,0.5,1e+300,-0.0,1.0,18446744073709551615],"d":null,"e":true,"f":false})",
        R"(["","plain","ü","\"\\","\n\t\u0001",{"k\"":"v"}])", "[[[]],[{}]]", "3", "\"x\""}) {
    const auto json = parse_json(text);
    ASSERT_TRUE(json) << text;
    EXPECT_EQ(dump_json(*json), text);
  }
  EXPECT_EQ(dump_json(Json::make_number(std::numeric_limits<double>::infinity())), "null");
}

TEST(ImportJson, DepthIsBoundedExactly) {
  const std::string open(kMaxJsonDepth, '[');
  const std::string close(kMaxJsonDepth, ']');
  EXPECT_TRUE(parse_json(open + close));
  EXPECT_FALSE(parse_json("[" + open + close + "]"));
}

}  // namespace
}  // namespace meshlode::scene
