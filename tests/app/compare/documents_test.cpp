// SPDX-License-Identifier: GPL-3.0-or-later
// Settings and materials of two files' JSON: what differs, whatever the texts hold.
#include "app/compare/documents.h"

#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

using What = std::vector<std::vector<std::string>>;

TEST(CompareDocuments, SettingsThatDifferAreListedWithBothValues) {
  const auto changes = compare_settings(R"({"preset":"fast","grid":"auto","keep":["NORMAL"],"old_only":1})",
                                        R"({"grid":0.5,"keep":["NORMAL"],"preset":"fast","new_only":{"a":[true]}})");
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[0].key, "grid");
  EXPECT_EQ(changes[0].before, "\"auto\"");
  EXPECT_EQ(changes[0].after, "0.5");
  EXPECT_EQ(changes[1].key, "old_only");
  EXPECT_EQ(changes[1].after, "null");
  EXPECT_EQ(changes[2].key, "new_only");
  EXPECT_EQ(changes[2].before, "null");
  EXPECT_EQ(changes[2].after, R"({"a":[true]})");
}

TEST(CompareDocuments, TextsThatAreNoObjectsHaveNoSettings) {
  const std::string deep = "{\"a\":" + std::string(1U << 20, '[') + std::string(1U << 20, ']') + "}";
  for (const std::string& text : {std::string(), std::string("[1]"), std::string("{"), deep, std::string("\xFF\xFE")}) {
    EXPECT_TRUE(compare_settings(text, text).empty());
    const auto changes = compare_settings(text, R"({"a":1})");
    ASSERT_EQ(changes.size(), 1U);
    EXPECT_EQ(changes[0].before, "null");
  }
}

TEST(CompareDocuments, MaterialsDifferInTheirMembersButNotInTheirName) {
  const char* before = R"({"materials":[{"name":"a","doubleSided":true,"extras":{"x":1}},{"alphaMode":"MASK"}]})";
  const char* after = R"({"materials":[{"alphaMode":"MASK"},{"name":"b","extras":{"x":2},"emissiveFactor":[1,0,0]}]})";
  EXPECT_EQ(compare_document_materials(before, after, {{0, 1}, {1, 0}}),
            (What{{"doubleSided", "emissiveFactor", "extras"}, {}}));
  EXPECT_EQ(compare_document_materials(before, after, {{7, 0}, {0xFFFFFFFFU, 9}}), (What{{"alphaMode"}, {}}));
  for (const char* text : {"", "[]", R"({"materials":{}})", R"({"materials":[3,null]})"}) {
    EXPECT_EQ(compare_document_materials(text, text, {{0, 0}, {1, 1}}), (What{{}, {}})) << text;
  }
}

// A file may name one large material in every record.
TEST(CompareDocuments, AMaterialIsLookedAtOnce) {
  std::string large = R"({"materials":[{"extras":")" + std::string(1U << 20, 'x') + "\"}]}";
  const std::vector<std::pair<std::size_t, std::size_t>> pairs(20000, {0, 0});
  const auto start = std::chrono::steady_clock::now();
  const What what = compare_document_materials(large, R"({"materials":[{}]})", pairs);
  EXPECT_EQ(what.front(), std::vector<std::string>{"extras"});
  EXPECT_TRUE(what.back().empty());
  // 20,000 dumps of a megabyte take half a minute.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

}  // namespace
}  // namespace meshlode::app
