// SPDX-License-Identifier: GPL-3.0-or-later
// Scripts and pages from a table whose texts have every character that one of the languages takes for its own.
#include "meshlode/completion.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "meshlode/man_page.h"

namespace meshlode::cli {
namespace {

std::vector<VerbHelp> verbs() {
  OptionInfo help{{"-h", "--help"}, "", {}, "print this", false, false, false};
  OptionInfo output{{"-o", "--output"}, "TEXT", {}, "it's [the] \"file\": 5\\6", false, false, false};
  OptionInfo choice{{"--way"}, "TEXT", {"left", "right"}, "which", false, false, false};
  OptionInfo input{{"input"}, "TEXT", {}, ".hidden files too", true, true, true};
  OptionInfo shell{{"shell"}, "TEXT", {"one", "two"}, "'quoted'", true, false, false};
  return {{"make", "what's made: all", "meshlode make a-b\n  meshlode make c", {help, output, choice, input}},
          {"say", "one of two", "meshlode say one", {help, shell}}};
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Completion, BashKnowsVerbsOptionsAndChoices) {
  const std::string script = bash_completion(verbs());
  EXPECT_TRUE(has(script, "compgen -W 'make say --help --version'")) << script;
  EXPECT_TRUE(has(script, "options='-h --help -o --output --way'")) << script;
  EXPECT_TRUE(has(script, "--way) values='left right' ;;")) << script;
  EXPECT_TRUE(has(script, "-o|--output) return ;;")) << script;
  EXPECT_TRUE(has(script, "words='one two'")) << script;
}

TEST(Completion, ZshQuotesWhatIsMarkupThere) {
  const std::string script = zsh_completion(verbs());
  EXPECT_TRUE(has(script, R"('make:what'\''s made\: all')")) << script;
  EXPECT_TRUE(has(script, R"('(-o --output)--output=[it'\''s \[the\] "file"\: 5\\6]:TEXT:_files')")) << script;
  EXPECT_TRUE(has(script, R"('(-o --output)-o+[it)")) << script;
  EXPECT_TRUE(has(script, "'--way=[which]:TEXT:(left right)'")) << script;
  EXPECT_TRUE(has(script, "'*:input:_files'")) << script;
  EXPECT_TRUE(has(script, "'::shell:(one two)'")) << script;
}

TEST(Completion, FishQuotesWhatIsMarkupThere) {
  const std::string script = fish_completion(verbs());
  EXPECT_TRUE(has(script, R"(-a make -d 'what\'s made: all')")) << script;
  EXPECT_TRUE(has(script, R"( -s o -l output -r -F -d 'it\'s [the] "file": 5\\6')")) << script;
  EXPECT_TRUE(has(script, "'__meshlode_verb_is make' -l way -x -a 'left right' -d 'which'")) << script;
  EXPECT_TRUE(has(script, "'__meshlode_verb_is say' -f -a 'one two'")) << script;
}

TEST(ManPage, ShowsOptionsAsTheyAreTyped) {
  const std::string page = verb_man_page(verbs()[0], verbs(), "meshlode 9");
  EXPECT_TRUE(page.starts_with(".TH MESHLODE\\-MAKE 1 \"\" \"meshlode 9\"")) << page;
  EXPECT_TRUE(has(page, "\\fBmeshlode make\\fR [\\fIoptions\\fR] \\fIinput\\fR ...\n")) << page;
  EXPECT_TRUE(has(page, "\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fITEXT\\fR\nit\\(aqs [the] \"file\": 5\\e6\n")) << page;
  EXPECT_TRUE(has(page, "One of \\fBleft\\fR, \\fBright\\fR.\n")) << page;
  EXPECT_TRUE(has(page, "\n\\&.hidden files too\n")) << "no request of roff: " << page;
  EXPECT_TRUE(has(page, ".nf\nmeshlode make a\\-b\nmeshlode make c\n.fi\n")) << page;
  EXPECT_TRUE(has(page, ".BR meshlode (1),\n.BR meshlode\\-say (1)\n")) << page;
  EXPECT_TRUE(has(verb_man_page(verbs()[1], verbs(), ""), "\n\\&\\(aqquoted\\(aq\n"));
}

TEST(ManPage, OfTheProgramHasEveryVerb) {
  const std::string page = program_man_page(verbs(), "meshlode 9");
  EXPECT_TRUE(has(page, ".TP\n\\fBmake\\fR\nwhat\\(aqs made: all\n")) << page;
  EXPECT_TRUE(has(page, ".BR meshlode\\-make (1),\n.BR meshlode\\-say (1)\n")) << page;
  EXPECT_EQ(man_page_name({}), "meshlode.1");
  EXPECT_EQ(man_page_name("say"), "meshlode-say.1");
}

}  // namespace
}  // namespace meshlode::cli
