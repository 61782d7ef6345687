// SPDX-License-Identifier: GPL-3.0-or-later
// Which files a batch is made of, and what they become.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/batch/jobs/glob.h"
#include "app/batch/jobs/jobs.h"
#include "batch_folder.h"

namespace meshlode::app {
namespace {

TEST(Glob, MatchesNamesAsShellsDo) {
  for (const auto& [pattern, name] : std::vector<std::pair<std::string, std::string>>{{"*", "a.glb"},
                                                                                      {"a*b*c", "aXXbYYc"},
                                                                                      {"?.glb", "a.glb"},
                                                                                      {"[a-c]x", "bx"},
                                                                                      {"[!a-c]x", "dx"},
                                                                                      {"[]]", "]"},
                                                                                      {"a[", "a["},
                                                                                      {"**", "abc"},
                                                                                      {".*", ".hidden"},
                                                                                      {"*a*", "a"},
                                                                                      {"[a-]", "-"},
                                                                                      {"", ""}}) {
    EXPECT_TRUE(matches_name(pattern, name)) << pattern << " " << name;
  }
  for (const auto& [pattern, name] : std::vector<std::pair<std::string, std::string>>{{"*", ".hidden"},
                                                                                      {"a*b", "ab "},
                                                                                      {"?", ""},
                                                                                      {"[a-c]", "d"},
                                                                                      {"[!a]", "a"},
                                                                                      {"a", "A"},
                                                                                      {"*.glb", "a.gltf"},
                                                                                      {"", "a"},
                                                                                      {"a*b*c", "acb"},
                                                                                      {"?", "ab"}}) {
    EXPECT_FALSE(matches_name(pattern, name)) << pattern << " " << name;
  }
}

// Two stars in front of each letter would take a matcher that goes back further than the last one 2^40 steps.
TEST(Glob, TakesNoLongerForPatternsThatAlmostMatch) {
  std::string pattern;
  for (int i = 0; i < 40; ++i) pattern += "*a";
  EXPECT_FALSE(matches_name(pattern + "b", std::string(4000, 'a')));
}

class JobsTest : public testing::Test {
 protected:
  JobsTest() {
    for (const char* name : {"in/b.glb", "in/a.gltf", "in/deep/er/c.GLB", "in/deep/a.obj", "in/readme.txt",
                             "in/.hidden/d.glb", "in/odd[1].glb"}) {
      folder_.write(name, "");
    }
  }
  [[nodiscard]] std::vector<std::string> plan(const std::vector<std::string>& inputs, const std::string& out) const {
    std::vector<std::string> absolute, lines;
    for (const std::string& input : inputs) absolute.push_back(folder_.path(input).string());
    const auto jobs = plan_jobs(absolute, "", out);
    if (!jobs) return {jobs.error().detail};
    for (const Job& job : *jobs) {
      lines.push_back(job.input.lexically_relative(folder_.path()).string() + " " + job.output.string());
    }
    return lines;
  }
  BatchFolder folder_;
};

TEST_F(JobsTest, AFolderKeepsItsInnerStructureAndTheOrderOfBytes) {
  EXPECT_EQ(plan({"in"}, "out"),
            (std::vector<std::string>{"in/.hidden/d.glb out/.hidden/d.lode", "in/a.gltf out/a.lode",
                                      "in/b.glb out/b.lode", "in/deep/a.obj out/deep/a.lode",
                                      "in/deep/er/c.GLB out/deep/er/c.lode", "in/odd[1].glb out/odd[1].lode"}));
}

TEST_F(JobsTest, APatternKeepsWhatIsBehindItsFirstWildcard) {
  EXPECT_EQ(plan({"in/*.gl*"}, "out"),
            (std::vector<std::string>{"in/a.gltf out/a.lode", "in/b.glb out/b.lode", "in/odd[1].glb out/odd[1].lode"}));
  EXPECT_EQ(plan({"in/**/[ac].*"}, "out"),
            (std::vector<std::string>{"in/a.gltf out/a.lode", "in/deep/a.obj out/deep/a.lode",
                                      "in/deep/er/c.GLB out/deep/er/c.lode"}));
  EXPECT_EQ(plan({"in/de*/**"}, "out"),
            (std::vector<std::string>{"in/deep/a.obj out/deep/a.lode", "in/deep/er/c.GLB out/deep/er/c.lode"}));
  EXPECT_EQ(plan({"in/*.txt"}, "out"), std::vector<std::string>{"no scene matches this pattern"});
}

TEST_F(JobsTest, APathThatExistsIsNoPattern) {
  EXPECT_EQ(plan({"in/odd[1].glb"}, "out"), std::vector<std::string>{"in/odd[1].glb out/odd[1].lode"});
}

TEST_F(JobsTest, InputsKeepTheirOrder) {
  EXPECT_EQ(plan({"in/b.glb", "in/a.gltf"}, "out"),
            (std::vector<std::string>{"in/b.glb out/b.lode", "in/a.gltf out/a.lode"}));
}

TEST_F(JobsTest, OutputsOfOneNameKeepExtensionsOrAreRefused) {
  folder_.write("in/b.obj", "");
  EXPECT_EQ(plan({"in/b.*"}, "out"), (std::vector<std::string>{"in/b.glb out/b.glb.lode", "in/b.obj out/b.obj.lode"}));
  EXPECT_EQ(plan({"in/b.glb", "in/*.glb"}, "out"),
            std::vector<std::string>{"two inputs would both become out/b.glb.lode"});
}

}  // namespace
}  // namespace meshlode::app
