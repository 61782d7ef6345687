// SPDX-License-Identifier: GPL-3.0-or-later
// The text layer of the polygon readers: line ends, blanks and numbers as programs write them.
#include "scene/import/polygons/text_scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace meshlode::scene {
namespace {

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> out;
  while (!text.empty()) out.emplace_back(take_line(text));
  return out;
}

TEST(TextScan, ALineEndsWithLfCrLfOrCrAndAFileMayMixThem) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of("a\nb\r\nc\rd"), (Lines{"a", "b", "c", "d"}));
  EXPECT_EQ(lines_of("a\r\rb\n\rc"), (Lines{"a", "", "b", "", "c"}));
  EXPECT_EQ(lines_of("a\r\n"), Lines{"a"});
}

TEST(TextScan, AByteOrderMarkIsNoText) {
  const std::vector<std::uint8_t> bytes{0xEF, 0xBB, 0xBF, 'v'};
  EXPECT_EQ(text_of(bytes), "v");
  EXPECT_EQ(text_of(std::span(bytes).first(2)).size(), 2U);
  EXPECT_EQ(text_of({}), "");
}

TEST(TextScan, FormFeedsVerticalTabsAndNulAreBlanks) {
  std::string_view text("\f\v\0 one\0two", 12);
  EXPECT_EQ(take_word(text), "one");
  EXPECT_EQ(take_word(text), "two");
  EXPECT_EQ(take_word(text), "");
}

TEST(TextScan, ABackslashJoinsLinesButNotInAComment) {
  std::string_view text = "f 1 2 \\ \r\n 3\rv 0\n# C:\\parts\\\nv 1\n";
  std::string joined;
  std::size_t count = 0;
  EXPECT_EQ(take_joined_line(text, joined, count), "f 1 2   3");
  EXPECT_EQ(count, 1U);
  EXPECT_EQ(take_joined_line(text, joined, count), "v 0");
  EXPECT_EQ(take_joined_line(text, joined, count), "# C:\\parts\\");
  EXPECT_EQ(take_joined_line(text, joined, count), "v 1");
  text = "g C:\\parts\\\nmtllib a.mtl \\\nb.mtl\n";
  EXPECT_EQ(take_joined_line(text, joined, count), "g C:\\parts\\");
  EXPECT_EQ(take_joined_line(text, joined, count), "mtllib a.mtl  b.mtl");
  text = "a \\";
  EXPECT_EQ(take_joined_line(text, joined, count), "a ");
}

TEST(TextScan, NumbersAreReadAsLibrariesPrintThem) {
  EXPECT_EQ(parse_number("+1.0E+00"), 1.0);
  EXPECT_EQ(parse_number("-.5"), -0.5);
  EXPECT_EQ(parse_number("3."), 3.0);
  EXPECT_EQ(parse_number("1e999"), HUGE_VAL);
  EXPECT_EQ(parse_number("1e-999"), 0.0);
  for (const char* word : {"nan", "-nan(ind)", "-1.#IND", "1.#QNAN", "1.#QNAN0", "-1.#IND00", "1.#SNAN"}) {
    EXPECT_TRUE(parse_number(word) && std::isnan(*parse_number(word))) << word;
  }
  EXPECT_EQ(parse_number("1.#INF00"), HUGE_VAL);
  EXPECT_EQ(parse_number("-1.#INF"), -HUGE_VAL);
  for (const char* word : {"", "+", "-", "+-1", "++1", "1x", "1,5", "1.#", "1.#FOO", "0x10", "."}) {
    EXPECT_FALSE(parse_number(word)) << word;
  }
  EXPECT_EQ(parse_integer("+7"), 7);
  EXPECT_FALSE(parse_integer("+-7"));
  EXPECT_FALSE(parse_integer("7.0"));
}

}  // namespace
}  // namespace meshlode::scene
