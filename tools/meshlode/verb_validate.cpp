// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <vector>

#include "app/doctor/diagnosis.h"
#include "base/file.h"
#include "base/json_writer.h"
#include "bulk.h"
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
    text += path + ": and " + app::counted(report.finding_count - report.findings.size(), "more findings") + "\n";
  }
  if (report.finding_count == 0 && !quiet) {
    text += path + ": " + colored(Stream::kOut, Color::kGreen, "valid") + ", " + std::to_string(report.checked.size()) +
            " rules hold\n";
  }
  return text;
}

/// An entry of the document, which is a list for one file too.
std::string to_json(const std::string& path, const judge::ValidationReport& report) {
  JsonWriter json;
  json.begin_object();
  json.field("file", path);
  json.field("valid", report.finding_count == 0);
  json.field("finding_count", report.finding_count);
  write_findings(json, report.findings);
  json.array_field("checked", report.checked);
  json.end_object();
  return json.text();
}

FileOutcome validate_file(const BulkInput& input, const OutputOptions& output) {
  FileOutcome out;
  const std::string path = input_name(input.path);
  const Result<std::string> place = input_path(input.path);
  if (!place) {
    out.fail(place.error());
    return out;
  }
  const Result<MappedFile> file = MappedFile::open(*place);
  if (!file) {
    out.fail(file.error());
    return out;
  }
  const judge::ValidationReport report = judge::validate_asset(file->bytes());
  if (is_no_asset(report)) {
    if (const Status named = check_may_be_asset(*place); !named) out.errors.push_back(named.error());
  }
  if (report.finding_count > 0) out.exit_code = is_no_asset(report) ? kInvalid : kCheckFailed;
  out.text = output.json() ? to_json(path, report) : describe(path, report, output.quiet);
  out.cells = {std::to_string(report.checked.size()), std::to_string(report.finding_count)};
  for (const judge::Finding& finding : report.findings) {
    out.details.push_back(finding.id + (finding.invariant.empty() ? "" : " (" + finding.invariant + ")") + ": " +
                          finding.where + ": " + finding.detail);
  }
  return out;
}

int run_validate(const Verb& verb, std::span<char* const> args) {
  BulkWords bulk;
  OutputOptions output;
  OptionParser parser(verb);
  add_bulk_inputs(parser, bulk, "FILE",
                  ".lode assets, folders of them, or patterns such as 'out/**/*.lode'; - for stdin",
                  "check the assets of this manifest of a build (default: none)");
  parser.group("Output");
  add_output_options(parser, output);
  add_bulk_outputs(parser, bulk);
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  const auto inputs = find_bulk_inputs(verb, bulk, app::InputKind::kAssets, ManifestSide::kAssets);
  if (!inputs) return print_error(inputs.error());
  if (!inputs->is_single) {
    return run_bulk({"validate",
                     {{"rules", 5}, {"findings", 8}},
                     [&](const BulkInput& input) { return validate_file(input, output); },
                     true},
                    inputs->files, bulk, output);
  }
  const JobLimit limit(bulk.jobs);
  FileOutcome out = validate_file(inputs->files.front(), output);
  if (output.json()) {
    JsonWriter json;
    json.begin_object();
    json.key("files");
    json.begin_array();
    if (!out.text.empty()) write_document(json, out.text, 2);
    json.end_array();
    json.end_object();
    out.text = json.text();
  }
  return out.print();
}

}  // namespace

const Verb kValidateVerb{"validate", "check every structural rule of an asset; each finding has an id",
                         "Checks the file's structure without its source: sections, tables, pages, the DAG, spheres, "
                         "errors and borders. Each finding names the rule by its id, and the place in the file.",
                         "meshlode validate scene.lode\n"
                         "  meshlode validate out/*.lode --format json",
                         run_validate};

}  // namespace meshlode::cli
