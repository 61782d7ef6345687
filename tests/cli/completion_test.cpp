// SPDX-License-Identifier: GPL-3.0-or-later
// Scripts and pages from a table whose texts have every character that one of the languages takes for its own.
#include "meshlode/completion.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "meshlode/help_text.h"
#include "meshlode/man_page.h"

namespace meshlode::cli {
namespace {

std::vector<VerbHelp> verbs() {
  const OptionInfo help{.names = {"-h", "--help"}, .help = "print this", .group = kGeneral};
  const OptionInfo output{
      .names = {"-o", "--output"}, .value = "FILE", .help = "it's [the] \"file\": 5\\6", .group = "Out"};
  const OptionInfo choice{.names = {"--way"},
                          .value = "left|right",
                          .choices = {"left", "right"},
                          .help = "which",
                          .usual = "left",
                          .group = "Out"};
  const OptionInfo input{.names = {"input"},
                         .value = "TEXT",
                         .help = ".hidden files too",
                         .group = kArguments,
                         .is_positional = true,
                         .is_required = true,
                         .is_many = true};
  const OptionInfo shell{.names = {"shell"},
                         .value = "TEXT",
                         .choices = {"one", "two"},
                         .help = "'quoted'",
                         .group = kArguments,
                         .is_positional = true};
  return {{"make",
           "what's made: all",
           "Makes.\n\n.More",
           "meshlode make a-b\n  meshlode make c",
           {help, output, choice, input}},
          {"say", "one of two", "Says.", "meshlode say one", {help, shell}}};
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
  EXPECT_TRUE(has(script, R"('(-o --output)--output=[it'\''s \[the\] "file"\: 5\\6]:FILE:_files')")) << script;
  EXPECT_TRUE(has(script, R"('(-o --output)-o+[it)")) << script;
  EXPECT_TRUE(has(script, "'--way=[which]:left|right:(left right)'")) << script;
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
  EXPECT_TRUE(has(page, "\\fBmeshlode make\\fR [\\fIOPTIONS\\fR] \\fIinput\\fR ...\n")) << page;
  EXPECT_TRUE(has(page, "\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fIFILE\\fR\nit\\(aqs [the] \"file\": 5\\e6\n")) << page;
  EXPECT_TRUE(has(page, "\\fB\\-\\-way\\fR \\fIleft|right\\fR\nwhich (default: left)\n")) << page;
  EXPECT_TRUE(has(page, ".SH DESCRIPTION\nMakes.\n.PP\n\\&.More\n.SH ARGUMENTS\n")) << page;
  EXPECT_LT(page.find(".SS Out\n"), page.find(".SS General\n")) << page;
  EXPECT_TRUE(has(page, "\n\\&.hidden files too\n")) << "no request of roff: " << page;
  EXPECT_TRUE(has(page, ".nf\nmeshlode make a\\-b\nmeshlode make c\n.fi\n")) << page;
  EXPECT_TRUE(has(page, ".BR meshlode (1),\n.BR meshlode\\-say (1)\n")) << page;
  EXPECT_TRUE(has(verb_man_page(verbs()[1], verbs(), ""), "\n\\&\\(aqquoted\\(aq\n"));
}

TEST(HelpText, ListsExamplesThenGroupsAndFillsLines) {
  VerbHelp verb = verbs()[0];
  verb.options[1].help = std::string(60, 'x') + " " + std::string(60, 'y');
  EXPECT_EQ(help_text(verb),
            "What's made: all.\n\nUsage: meshlode make [OPTIONS] input...\n\nExamples:\n  meshlode make a-b\n"
            "  meshlode make c\n\nArguments:\n  input...                   .hidden files too\n\nOut:\n"
            "  -o, --output FILE          " +
                std::string(60, 'x') + "\n" + std::string(29, ' ') + std::string(60, 'y') +
                "\n      --way left|right       which (default: left)\n\nGeneral:\n"
                "  -h, --help                 print this\n\n"
                "Exit status: 0 ok, 1 usage, 2 input or output failed (an interrupt too), 3 invalid input, 4 build\n"
                "  failed, 5 unsupported, 6 a check failed\nManual: man meshlode-make, docs/reference/cli/make.md\n");
}

TEST(HelpText, KeepsADefaultInOneLine) {
  EXPECT_EQ(fill_lines("a b (default: c)", "", 2, 13), "a b\n  (default: c)\n");
  EXPECT_EQ(fill_lines("longer  than\nall", "", 0, 4), "longer\nthan\nall\n");
  EXPECT_EQ(fill_lines("", "", 0, 4), "\n");
}

TEST(ReferencePage, QuotesMarkup) {
  const std::string page = reference_page(verbs()[0]);
  EXPECT_TRUE(has(page, "- `-o, --output FILE`: it's \\[the] \"file\": 5\\\\6\n")) << page;
  EXPECT_TRUE(has(page, "\n## Out\n\n")) << page;
  EXPECT_TRUE(has(reference_index(verbs()), "| [say](say.md) | one of two |\n"));
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
