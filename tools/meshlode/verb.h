// SPDX-License-Identifier: GPL-3.0-or-later
// The table of verbs: `meshlode VERB …`. One verb = one file verb_<name>.cpp that defines `const Verb k<Name>Verb`.
// How to add one: CONTRIBUTING.md.
// Third-party headers stay out of verb files: CLI11 is in options.cpp, JSON output is base/json_writer.h.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "option_table.h"

namespace meshlode::cli {

struct Verb {
  const char* name;
  const char* summary;      ///< one line, shown in the list of verbs and at the top of the verb's help
  const char* description;  ///< what it does, for the manual page; an empty line between paragraphs
  const char* example;      ///< one or more command lines
  /// Runs the verb on the arguments after its name and returns the exit code.
  int (*run)(const Verb& verb, std::span<char* const> args);
  /// Not null: run() puts its options here when it parses, and does nothing else.
  OptionTable* listed_options = nullptr;
};

/// The verb of that name, also one that help does not list; null: there is none.
[[nodiscard]] const Verb* find_verb(std::string_view name);
/// Every verb that help, completion and man pages have, in the order of the help.
[[nodiscard]] std::span<const Verb* const> all_verbs();

/// The same with the options of each, asked of the verbs themselves.
[[nodiscard]] std::vector<VerbHelp> all_verb_help();

extern const Verb kBuildVerb;
extern const Verb kMergeVerb;
extern const Verb kPlanVerb;
extern const Verb kDoctorVerb;
extern const Verb kInfoVerb;
extern const Verb kCompareVerb;
extern const Verb kSweepVerb;
extern const Verb kStreamVerb;
extern const Verb kValidateVerb;
extern const Verb kVerifyVerb;
extern const Verb kRenderVerb;
extern const Verb kExtractVerb;
extern const Verb kRepackVerb;
extern const Verb kMeasureVerb;
extern const Verb kReportVerb;
extern const Verb kCacheVerb;
extern const Verb kCompletionVerb;
extern const Verb kManVerb;
extern const Verb kStudyVerb;  ///< listed nowhere: for studies (docs/guides/sweep.md)

}  // namespace meshlode::cli
