// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/json_writer.h"

#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include <meshlode/format.h>

namespace meshlode {
namespace {

template <class T>
std::string written(const T& value) {
  JsonWriter w;
  w.value(value);
  std::string text = w.text();
  text.pop_back();  // the line break
  return text;
}

TEST(JsonWriter, NestsAndSeparates) {
  JsonWriter w;
  w.begin_object();
  w.field("a", 1);
  w.key("list");
  w.begin_array();
  w.value(true);
  w.null();
  w.begin_object();
  w.end_object();
  w.end_array();
  w.key("raw");
  w.raw("{\"b\":[]}");
  w.end_object();
  EXPECT_EQ(w.text(), "{\n  \"a\": 1,\n  \"list\": [\n    true,\n    null,\n    {}\n  ],\n  \"raw\": {\"b\":[]}\n}\n");
}

TEST(JsonWriter, ListsAndWhatMayBeMissing) {
  JsonWriter w;
  w.begin_object();
  w.array_field("list", std::vector<int>{1, 2});
  w.array_field("none", std::vector<int>{});
  w.optional_field("there", std::optional<double>(0.5));
  w.optional_field("missing", std::optional<double>());
  w.text_or_null_field("text", "a");
  w.text_or_null_field("empty", "");
  w.end_object();
  EXPECT_EQ(w.text(),
            "{\n  \"list\": [\n    1,\n    2\n  ],\n  \"none\": [],\n  \"there\": 0.5,\n  \"missing\": null,\n"
            "  \"text\": \"a\",\n  \"empty\": null\n}\n");
}

TEST(JsonWriter, WritesInfinityAndNanAsNull) {
  EXPECT_EQ(written(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(written(std::numeric_limits<double>::quiet_NaN()), "null");
  EXPECT_EQ(written(-std::numeric_limits<float>::infinity()), "null");
  EXPECT_EQ(written(format::kInfiniteError), "null");
  EXPECT_EQ(written(static_cast<double>(format::kInfiniteError)), "null");
}

TEST(JsonWriter, NumbersReadBackAsTheyWere) {
  EXPECT_EQ(written(0.1), "0.1");
  EXPECT_EQ(written(0.1F), "0.1");
  EXPECT_EQ(written(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(written(std::numeric_limits<std::uint64_t>::max()), "18446744073709551615");
  EXPECT_EQ(written(-5), "-5");
}

TEST(JsonWriter, EscapesWhatJsonForbids) {
  EXPECT_EQ(written("a\"b\\c\n\t\x01"), "\"a\\\"b\\\\c\\n\\t\\u0001\"");
  EXPECT_EQ(written("caf\xC3\xA9 \xF0\x9F\x97\xBF"), "\"caf\xC3\xA9 \xF0\x9F\x97\xBF\"");
}

// Names come from files: bytes that are not UTF-8 become one U+FFFD each, overlong forms and surrogates too.
TEST(JsonWriter, ReplacesWhatIsNotUtf8) {
  const std::string replacement = "\xEF\xBF\xBD";
  EXPECT_EQ(written("\xFF"), "\"" + replacement + "\"");
  EXPECT_EQ(written("a\xC3"), "\"a" + replacement + "\"");
  EXPECT_EQ(written("\xC0\x80"), "\"" + replacement + replacement + "\"");
  EXPECT_EQ(written("\xED\xA0\x80"), "\"" + replacement + replacement + replacement + "\"");
}

}  // namespace
}  // namespace meshlode
