// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshlode/options.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "meshlode/output_name.h"

namespace meshlode::cli {
namespace {

int run_nothing(const Verb&, std::span<char* const>) {
  return 0;
}
const Verb kTestVerb{"test", "a verb of this test", "Does nothing.", "meshlode test a", run_nothing};

struct Parsed {
  std::optional<int> exit_code;
  std::string file, choice = "a";
  double number = 0.0;
  std::optional<double> maybe;
  std::uint32_t count = 7;
  bool flag = false;
};

Parsed parse(std::vector<std::string> words) {
  std::vector<char*> args;
  for (std::string& word : words) args.push_back(word.data());
  Parsed p;
  OptionParser parser(kTestVerb);
  parser.add_positional("file", p.file, "a file");
  parser.add_value("--choice", p.choice, "one of two", {"a", "b"});
  parser.add_value("--number", p.number, "any");
  parser.add_value("--maybe", p.maybe, "any");
  parser.add_value("-c,--count", p.count, "not negative");
  parser.add_flag("--flag", p.flag, "on");
  p.exit_code = parser.parse(args);
  return p;
}

TEST(OptionParser, FillsWhatIsGivenAndLeavesTheRest) {
  const Parsed p = parse({"--number", "-1.5", "in.glb", "--choice=b", "-c", "3"});
  EXPECT_FALSE(p.exit_code.has_value());
  EXPECT_EQ(p.file, "in.glb");
  EXPECT_EQ(p.choice, "b");
  EXPECT_EQ(p.number, -1.5);
  EXPECT_EQ(p.count, 3U);
  EXPECT_FALSE(p.maybe.has_value());
  EXPECT_FALSE(p.flag);
  EXPECT_EQ(parse({"x", "--maybe", "0", "--flag"}).maybe, 0.0);
}

TEST(OptionParser, AnswersUsageForWhatItDoesNotKnow) {
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"a", "b"},
                                                       {"a", "--no"},
                                                       {"a", "--choice", "c"},
                                                       {"a", "--number"},
                                                       {"a", "--number", "x"},
                                                       {"a", "-c", "-1"},
                                                       {"a", "-c", "4294967296"},
                                                       {"a", "--number", "1", "--number", "2"}};
  for (const auto& words : wrong) {
    const Parsed p = parse(words);
    std::string line;
    for (const std::string& word : words) line += word + " ";
    EXPECT_EQ(p.exit_code, static_cast<int>(ErrorCode::kUsage)) << line;
  }
  EXPECT_EQ(parse({"--help"}).exit_code, 0);
}

std::string told_of(const std::vector<std::string>& words) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(parse(words).exit_code, static_cast<int>(ErrorCode::kUsage));
  return testing::internal::GetCapturedStderr();
}

TEST(OptionParser, NamesTheNearestOfItsOptions) {
  const std::string flag = "meshlode: unknown option '--falg'; the nearest is --flag; see meshlode test --help\n";
  EXPECT_EQ(told_of({"a", "--falg"}), flag);
  EXPECT_EQ(told_of({"--falg"}), flag) << "before what it misses";
  EXPECT_EQ(told_of({"a", "--falg=7"}), flag);
  EXPECT_EQ(told_of({"a", "--NUMBR", "7"}),
            "meshlode: unknown option '--NUMBR'; the nearest is --number; see meshlode test --help\n");
  // A letter is nearer to it, but nobody writes two dashes for one.
  EXPECT_EQ(told_of({"a", "--fl"}),
            "meshlode: unknown option '--fl'; the nearest is --flag; see meshlode test --help\n");
  EXPECT_EQ(told_of({"a", "-flag"}),
            "meshlode: unknown option '-flag'; the nearest is --flag; see meshlode test --help\n");
  EXPECT_EQ(told_of({"a", "b"}).find("nearest"), std::string::npos) << "no option";
  EXPECT_EQ(told_of({"a", "--", "--falg"}).find("nearest"), std::string::npos) << "no option";
}

TEST(OptionParser, NamesNoOptionThatIsNotNear) {
  EXPECT_EQ(told_of({"a", "--no-such-option"}),
            "meshlode: unknown option '--no-such-option'; see meshlode test --help\n");
  EXPECT_EQ(told_of({"a", "-x"}), "meshlode: unknown option '-x'; see meshlode test --help\n") << "not -c";
}

TEST(OptionParser, SaysWhatAValueShouldHaveBeen) {
  EXPECT_EQ(told_of({"a", "--count", "many"}), "meshlode: --count: expected a whole number, 0 or more, got 'many'\n");
  EXPECT_EQ(told_of({"a", "--count", "-1"}), "meshlode: --count: expected a whole number, 0 or more, got '-1'\n");
  EXPECT_EQ(told_of({"a", "--count="}), "meshlode: --count: needs a whole number\n");
  EXPECT_EQ(told_of({"a", "--number", "nan"}), "meshlode: --number: expected a number, got 'nan'\n");
  EXPECT_EQ(told_of({"a", "--maybe", "inf"}), "meshlode: --maybe: expected a number, got 'inf'\n");
  EXPECT_EQ(told_of({"a", "--maybe", "5%"}), "meshlode: --maybe: expected a number, got '5%'\n");
  EXPECT_EQ(told_of({"a", "--choice", "aaa"}),
            "meshlode: --choice: unknown value 'aaa'; choose a or b; the nearest is a\n");
  EXPECT_EQ(told_of({"a", "--choice", "c"}), "meshlode: --choice: unknown value 'c'; choose a or b\n");
  EXPECT_EQ(told_of({"a", "--choice"}), "meshlode: --choice: needs a value: a or b\n");
  EXPECT_EQ(told_of({"a", "--number", "1", "--number", "2"}), "meshlode: --number: given more than once\n");
  EXPECT_EQ(told_of({"a", "b"}), "meshlode: unexpected argument 'b': test takes one (file)\n");
}

TEST(OutputName, AnExtensionOfAnotherFormatIsRefused) {
  for (const char* name : {"x.png", "x.PNG", "x", "x.out", "dir.jpg/x", "/dev/stdout", "", ".png", "x.tmp", "x.part",
                           "x.bak", "x.old", "x.new", "x.2", "x.v2", "tmp.Ab3dE"}) {
    EXPECT_TRUE(check_output_name("-o", name, ".png")) << name;
  }
  for (const char* name : {"x.jpg", "x.JPEG", "x.webp", "a.png.jpg", "x.glb", "x.lode", "x.json", "x.jpe", "x.heic",
                           "x.ico", "x.b3dm", "x.step", "x.mtl", "x.anything"}) {
    EXPECT_FALSE(check_output_name("-o", name, ".png")) << name;
  }
  EXPECT_EQ(check_output_name("-o", "x.gltf", ".glb").error().detail,
            "writes a .glb file, not a .gltf file (got 'x.gltf'); choose a name that ends in .glb");
}

TEST(OutputName, AnExtensionOfAKnownFormatIsRefusedForText) {
  EXPECT_TRUE(check_text_name("--html", "x.htm", {".html", ".htm"}));
  EXPECT_FALSE(check_text_name("--manifest", "x.txt", {".json"}));
  for (const char* name : {"x.d", "x.txt", "x.fish", "x"}) EXPECT_TRUE(check_text_name("--depfile", name, {})) << name;
  for (const char* name : {"x.json", "x.png"}) EXPECT_FALSE(check_text_name("--depfile", name, {})) << name;
}

TEST(OptionParser, ListsItsOptionsInsteadOfParsing) {
  OptionTable table;
  Verb verb = kTestVerb;
  verb.listed_options = &table;
  std::string file, choice = "b";
  double size = 0.25;
  std::vector<std::string> files;
  std::optional<std::string> maybe;
  bool flag = false;
  OptionParser parser(verb);
  parser.add_positional("file", file, "a file");
  parser.group("Some");
  parser.add_value("-c,--choice", choice, "one of two", {"a", "b"});
  parser.add_value("--size WxH", size, "both");
  parser.add_flag("--flag", flag, "on");
  parser.add_positional("maybe", maybe, "or none", {"x"});
  parser.add_positionals("more", files, "files");
  EXPECT_EQ(parser.parse({}), 0) << "nothing is missed";
  ASSERT_EQ(table.size(), 8U);
  EXPECT_EQ(table[0].names, (std::vector<std::string>{"-h", "--help"}));
  EXPECT_EQ(table[0].value, "");
  EXPECT_EQ(table[1].names, std::vector<std::string>{"--color"});
  EXPECT_EQ(table[1].group, kGeneral);
  EXPECT_EQ(table[2].names, std::vector<std::string>{"file"});
  EXPECT_TRUE(table[2].is_positional && table[2].is_required && !table[2].is_many);
  EXPECT_EQ(table[2].group, kArguments);
  EXPECT_EQ(table[3].names, (std::vector<std::string>{"-c", "--choice"}));
  EXPECT_EQ(table[3].value, "a|b");
  EXPECT_EQ(table[3].choices, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(table[3].help, "one of two");
  EXPECT_EQ(table[3].group, "Some");
  EXPECT_EQ(table[3].usual, "b");
  EXPECT_EQ(table[4].value, "WxH");
  EXPECT_EQ(table[4].usual, "0.25");
  EXPECT_EQ(help_with_default(table[4]), "both (default: 0.25)");
  EXPECT_EQ(table[5].value, "") << "a flag";
  EXPECT_TRUE(table[6].is_positional && !table[6].is_required);
  EXPECT_EQ(table[6].choices, std::vector<std::string>{"x"});
  EXPECT_TRUE(table[7].is_positional && table[7].is_many);
}

TEST(JobLimit, RunsTheWorkOnce) {
  for (const std::uint32_t jobs : {0U, 1U, 2U, 4U, 4'000'000'000U}) {
    int runs = 0;
    JobLimit limit(jobs);
    limit.run([&] { ++runs; });
    EXPECT_EQ(runs, 1) << jobs;
  }
}

}  // namespace
}  // namespace meshlode::cli
