// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/json_writer.h"
#include "file_kind.h"
#include "findings.h"
#include "judge/validate/rules.h"
#include "judge/validate/validate.h"
#include "options.h"
#include "streams.h"
#include "terminal.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

constexpr int kInvalid = static_cast<int>(ErrorCode::kInvalid);
constexpr int kCheckFailed = static_cast<int>(ErrorCode::kCheckFailed);

bool is_no_asset(const judge::ValidationReport& report) {
  return std::any_of(report.findings.begin(), report.findings.end(),
                     [](const judge::Finding& f) { return f.id == judge::info_of(judge::Rule::kL001).id; });
}

std::string describe(const std::string& path, const judge::ValidationReport& report, bool quiet) {
  std::string text;
  for (const judge::Finding& finding : report.findings) {
    text += path + ": " + colored(Stream::kOut, Color::kRed, finding.id) +
            (finding.invariant.empty() ? "" : " (" + finding.invariant + ")") + ": " + finding.where + ": " +
            finding.detail + "\n";
  }
  if (report.finding_count > report.findings.size()) {
    text += path + ": and " + std::to_string(report.finding_count - report.findings.size()) + " more findings\n";
  }
  if (report.finding_count == 0 && !quiet) {
    text += path + ": " + colored(Stream::kOut, Color::kGreen, "valid") + ", " + std::to_string(report.checked.size()) +
            " rules hold\n";
  }
  return text;
}

int run_validate(const Verb& verb, std::span<char* const> args) {
  std::vector<std::string> paths;
  OutputOptions output;
  OptionParser parser(verb);
  parser.add_positionals("FILE", paths, "one or more .lode assets, or - for stdin");
  parser.group("Output");
  add_output_options(parser, output);
  if (const auto exit_code = parser.parse(args)) return *exit_code;

  int worst = 0;
  std::string text;
  JsonWriter json;
  json.begin_object();
  json.key("files");
  json.begin_array();
  for (const std::string& word : paths) {
    const std::string path = input_name(word);
    const Result<std::string> place = input_path(word);
    if (!place) {
      worst = std::max(worst, print_error(place.error()));
      continue;
    }
    const Result<MappedFile> file = MappedFile::open(*place);
    if (!file) {
      worst = std::max(worst, print_error(file.error()));
      continue;
    }
    const judge::ValidationReport report = judge::validate_asset(file->bytes());
    if (report.finding_count > 0) worst = std::max(worst, is_no_asset(report) ? kInvalid : kCheckFailed);
    if (is_no_asset(report)) {
      if (const Status named = check_may_be_asset(*place); !named) print_error(named.error());
    }
    text += describe(path, report, output.quiet);
    json.begin_object();
    json.field("file", path);
    json.field("valid", report.finding_count == 0);
    json.field("finding_count", report.finding_count);
    write_findings(json, report.findings);
    json.key("checked");
    json.begin_array();
    for (const std::string& id : report.checked) json.value(id);
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.end_object();
  if (!print_out(output.json() ? json.text() : text)) return static_cast<int>(ErrorCode::kIo);
  return worst;
}

}  // namespace

const Verb kValidateVerb{"validate", "check every structural rule of an asset; each finding has an id",
                         "Checks the file's structure without its source: sections, tables, pages, the DAG, spheres, "
                         "errors and borders. Each finding names the rule by its id, and the place in the file.",
                         "meshlode validate scene.lode\n"
                         "  meshlode validate out/*.lode --format json",
                         run_validate};

}  // namespace meshlode::cli
