// SPDX-License-Identifier: GPL-3.0-or-later
// The grammar of --fail-if: what it takes, what it refuses and with which words, and that no text harms it.
#include "app/budget/conditions.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

/// A path as one letter a step: k(ey), i(ndex), n(ame), ? any, * all, # count.
std::string shape_of(const Condition& condition) {
  std::string shape;
  for (const Step& step : condition.path) shape += "kin?*#"[static_cast<std::size_t>(step.kind)];
  return shape;
}

Condition only(const std::string& text) {
  const auto parsed = parse_conditions(text);
  EXPECT_TRUE(parsed.ok()) << text << ": " << (parsed ? "" : parsed.error().detail);
  if (!parsed) return {};
  EXPECT_EQ(parsed->size(), 1U) << text;
  return parsed->front();
}

std::string refusal(const std::string& text) {
  const auto parsed = parse_conditions(text);
  if (parsed) return "taken";
  EXPECT_EQ(parsed.error().code, ErrorCode::kUsage);
  return parsed.error().detail;
}

TEST(Conditions, APathIsKeysSubscriptsAndQuantifiers) {
  EXPECT_EQ(shape_of(only("file_bytes>1")), "k");
  EXPECT_EQ(shape_of(only("totals.clusters>1")), "kk");
  EXPECT_EQ(shape_of(only("any(meshes).stuck_groups>0")), "k?k");
  EXPECT_EQ(shape_of(only("all(a.b).c.count(d)>0")), "kk*kk#");
  EXPECT_EQ(shape_of(only("any(meshes).any(levels).fill<0.5")), "k?k?k");
  EXPECT_EQ(shape_of(only("meshes[3].levels[0].error_max>1")), "kikik");
  EXPECT_EQ(shape_of(only("any(meshes[\"a, b>c\"].levels).fill<1")), "knk?k");
  EXPECT_EQ(shape_of(only(" count ( meshes ) > 1 ")), "k#");
  EXPECT_EQ(only("meshes['a \"b\"'].levels[12].fill<1").path[1].name, "a \"b\"");
  EXPECT_EQ(only("meshes[18446744073709551615].clusters<1").path[1].index, 18446744073709551615U);
  // Only a bracket makes them quantifiers.
  EXPECT_EQ(shape_of(only("any.all.count>1")), "kkk");
}

TEST(Conditions, AValueIsANumberATextATruthOrNull) {
  const auto number = [](const std::string& text) { return std::get<double>(only("a>" + text).value); };
  EXPECT_EQ(number("10"), 10.0);
  EXPECT_EQ(number(" -1.5e-3"), -1.5e-3);
  EXPECT_EQ(number("5K"), 5000.0);
  EXPECT_EQ(number("2M"), 2e6);
  EXPECT_EQ(number("1.5KiB"), 1536.0);
  EXPECT_EQ(number("3MiB"), 3.0 * 1048576.0);
  EXPECT_EQ(number("1GiB"), 1073741824.0);
  EXPECT_EQ(std::get<std::string>(only("a==\"x y\"").value), "x y");
  EXPECT_EQ(std::get<std::string>(only("a!=built-in_2").value), "built-in_2");
  EXPECT_TRUE(std::get<bool>(only("a==true").value));
  EXPECT_FALSE(std::get<bool>(only("a!=false").value));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(only("a==null").value));
}

TEST(Conditions, StandBetweenCommasAndKeepTheirText) {
  const auto parsed = parse_conditions(" a>1 ,b . c<=2, any(d)!='x, y' ");
  ASSERT_TRUE(parsed.ok()) << parsed.error().detail;
  ASSERT_EQ(parsed->size(), 3U);
  EXPECT_EQ((*parsed)[0].text, "a>1");
  EXPECT_EQ((*parsed)[1].text, "b . c<=2");
  EXPECT_EQ((*parsed)[2].text, "any(d)!='x, y'");
  EXPECT_EQ((*parsed)[1].relation, Relation::kLessEqual);
  EXPECT_TRUE(mentions(*parsed, "d"));
  EXPECT_FALSE(mentions(*parsed, "c"));
}

TEST(Conditions, SayWhatWasExpectedAndWhatWasFound) {
  EXPECT_EQ(refusal(""), "is empty: give a condition");
  EXPECT_EQ(refusal(" \n"), "is empty: give a condition");
  EXPECT_EQ(refusal("a"), "expected one of > >= < <= == !=, found the end");
  EXPECT_EQ(refusal("a>"), "expected a number, a text, true, false or null, found the end");
  EXPECT_EQ(refusal("a=1"), "expected one of > >= < <= == !=, found '=1'");
  EXPECT_EQ(refusal("a>1;b>2"), "expected a comma and another condition, or the end, found ';b>2'");
  EXPECT_EQ(refusal("a>1,"), "expected a key, found the end");
  EXPECT_EQ(refusal(".a>1"), "expected a key, found '.a>1'");
  EXPECT_EQ(refusal("any(a>1"), "expected a closing bracket, found '>1'");
  EXPECT_EQ(refusal("any(any(a))>1"), "expected a closing bracket, found '(a))>1'");
  EXPECT_EQ(refusal("a[x]>1"), "expected an index or a name in quotes, found 'x]>1'");
  EXPECT_EQ(refusal("a[-1]>1"), "expected an index or a name in quotes, found '-1]>1'");
  EXPECT_EQ(refusal("a[18446744073709551616]>1").substr(0, 17), "expected an index");
  EXPECT_EQ(refusal("a['x]>1"), "expected a closing quote, found ''x]>1'");
  EXPECT_EQ(refusal("a>1kg"), "expected K, M, G, KB, MB, GB, KiB, MiB, GiB or nothing behind a number, found 'kg'");
  EXPECT_EQ(refusal("a>-inf").substr(0, 17), "expected a number");
  EXPECT_EQ(refusal("a>nan"), "a>nan: > compares numbers");
  EXPECT_EQ(refusal("a>-nan").substr(0, 17), "expected a number");
  EXPECT_EQ(refusal("a>1e999").substr(0, 17), "expected a number");
  EXPECT_EQ(refusal("a>1e308M"), "a number beyond 1.8e308");
  EXPECT_EQ(refusal("a<='x'"), "a<='x': <= compares numbers");
  EXPECT_EQ(refusal("count(a).b>1"), "expected one of > >= < <= == !=, found '.b>1'");
}

TEST(Conditions, LongTextsAndPathsAreRefused) {
  for (const char byte : {' ', 'a', '(', '[', '9', '"', '\0'}) {
    EXPECT_EQ(refusal(std::string(kMaxConditionsBytes + 1, byte)), "more than 16384 bytes");
    EXPECT_EQ(refusal(std::string(1 << 20, byte)), "more than 16384 bytes");
  }
  std::string path = "a";
  for (std::size_t i = 1; i < kMaxSteps; ++i) path += ".a";
  EXPECT_EQ(refusal(path + ">1"), "taken");
  EXPECT_NE(refusal(path + ".a>1"), "taken");
  EXPECT_NE(refusal("any(" + path + ")>1"), "taken");
  std::string subscripts = "a";
  for (std::size_t i = 0; i < 100; ++i) subscripts += "[0]";
  EXPECT_NE(refusal(subscripts + ">1"), "taken");
}

// Whatever is cut off or changed, the answer is conditions with a path or an error with words.
TEST(Conditions, NoTextDoesHarm) {
  const std::string good =
      "totals.clusters>=5K, any(meshes[\"rock\"].levels[2]).fill<0.5 , settings.codec!='x',count(a)==1";
  const auto look = [](const std::string& text) {
    const auto parsed = parse_conditions(text);
    if (!parsed) {
      EXPECT_FALSE(parsed.error().detail.empty());
      return;
    }
    for (const Condition& condition : *parsed) EXPECT_FALSE(condition.path.empty()) << text;
  };
  for (std::size_t length = 0; length <= good.size(); ++length) {
    look(good.substr(0, length));
    look(good.substr(length));
  }
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (int byte = 0; byte < 256; ++byte) {
      std::string mutant = good;
      mutant[at] = static_cast<char>(byte);
      look(mutant);
    }
  }
  for (const char* bracket : {"(", "[", "any(", "a[", "'", ".", ",", "-", "any(a)."}) {
    std::string text;
    while (text.size() + 8 < kMaxConditionsBytes) text += bracket;
    look(text);
  }
}

}  // namespace
}  // namespace meshlode::app
