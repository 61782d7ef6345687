// SPDX-License-Identifier: GPL-3.0-or-later
#include "trial.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

namespace meshlode::test {

namespace {

using nlohmann::json;

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

StepResult run_step(const TrialOptions& options, std::vector<std::string> arguments) {
  const StepOutput output{options.folder / "stdout", options.folder / "stderr"};
  arguments.insert(arguments.begin(), options.program.string());
  return options.started != nullptr ? options.started->run(arguments, output, options.cpu_seconds)
                                    : run_process(arguments, output, options.cpu_seconds);
}

void note(TrialResult& result, const std::string& rule, const std::string& detail, std::uint64_t count = 1) {
  result.rules[rule] += count;
  if (result.detail.empty()) result.detail = detail;
}

/// True where the step ended by itself with one of the exit codes that mean something here.
bool ended_well(TrialResult& result, const std::string& step, const StepResult& ran, bool may_find) {
  result.total_seconds += ran.cpu_seconds;
  if (ran.timed_out) {
    note(result, step + ":time", step + " took longer than allowed");
  } else if (ran.exit_code < 0) {
    note(result, step + ":signal " + std::to_string(ran.signal), ran.err.substr(0, 300));
  } else if (ran.exit_code != 0 && !(may_find && ran.exit_code == 6)) {
    note(result, step + ":exit " + std::to_string(ran.exit_code), ran.err.substr(0, 300));
  } else {
    return true;
  }
  return false;
}

void note_findings(TrialResult& result, const TrialOptions& options, const json& findings) {
  for (const json& finding : findings) {
    if (!options.judges_seen_surfaces && finding.value("id", "") == "V211") continue;
    note(result, finding.value("id", "?"),
         finding.value("id", "") + " " + finding.value("where", "") + ": " + finding.value("detail", ""));
  }
}

void note_deviations(TrialResult& result, const json& cuts) {
  for (const json& cut : cuts) {
    ++result.cuts;
    const std::string verdict = cut.value("verdict", "");
    const bool is_above = verdict == "above";
    if (verdict == "undecided") ++result.cuts_undecided;
    if (is_above) ++result.cuts_above;
    const double stored = cut.value("stored", 0.0);
    const double lower = cut.contains("lower") && cut["lower"].is_number() ? cut["lower"].get<double>() : HUGE_VAL;
    const double ratio = stored > 0.0 ? lower / stored : HUGE_VAL;
    result.largest_ratio = std::max(result.largest_ratio, is_above ? ratio : std::min(ratio, 1.0));
  }
}

/// The line without the paths of this trial and without numbers, so that equal refusals count as one.
std::string reason_of(const std::string& line) {
  std::string text = line.substr(0, line.find('\n'));
  if (const std::size_t at = text.find("scene.glb: "); at != std::string::npos) text = text.substr(at + 11);
  std::string out;
  for (const char c : text) {
    const bool is_digit =
        (c >= '0' && c <= '9') || (!out.empty() && out.back() == '#' && (c == '.' || c == 'e' || c == '-' || c == '+'));
    if (!is_digit) {
      out += c;
    } else if (out.empty() || out.back() != '#') {
      out += '#';
    }
  }
  return out;
}

bool build(TrialResult& result, const TrialOptions& options, const std::string& asset, const char* jobs) {
  std::vector<std::string> arguments = {
      "build", (options.folder / "scene.glb").string(), "-o", asset, "--quiet", "--jobs", jobs};
  arguments.insert(arguments.end(), options.build_options.begin(), options.build_options.end());
  const StepResult ran = run_step(options, arguments);
  result.build_seconds += ran.cpu_seconds;
  if (ran.exit_code >= 3 && ran.exit_code <= 5) {
    result.total_seconds += ran.cpu_seconds;
    result.refusal = "exit " + std::to_string(ran.exit_code) + ": " + reason_of(ran.err);
    return false;
  }
  return ended_well(result, "build", ran, false);
}

void validate(TrialResult& result, const TrialOptions& options, const std::string& asset) {
  const StepResult ran = run_step(options, {"validate", asset, "--format", "json"});
  if (!ended_well(result, "validate", ran, true)) return;
  const json report = json::parse(ran.out, nullptr, false);
  if (!report.is_object() || !report.contains("files")) return note(result, "validate:output", "no JSON of validate's");
  std::uint64_t before = result.rules.size();
  for (const json& file : report["files"]) note_findings(result, options, file.value("findings", json::array()));
  if (ran.exit_code == 6 && result.rules.size() == before) note(result, "validate:silent", "exit 6 without a finding");
}

void verify(TrialResult& result, const TrialOptions& options, const std::string& asset) {
  std::vector<std::string> arguments = {"verify",   asset,  "--source", (options.folder / "scene.glb").string(),
                                        "--format", "json", "--jobs",   "1"};
  if (options.depth == Depth::kVerifyWithoutDeviation) arguments.insert(arguments.end(), {"--deviation-cuts", "0"});
  if (options.samples) arguments.insert(arguments.end(), {"--samples", std::to_string(*options.samples)});
  const StepResult ran = run_step(options, arguments);
  if (!ended_well(result, "verify", ran, true)) return;
  const json report = json::parse(ran.out, nullptr, false);
  if (!report.is_object() || !report.contains("findings")) return note(result, "verify:output", "no JSON of verify's");
  note_findings(result, options, report["findings"]);
  note_deviations(result, report.value("deviations", json::array()));
  if (ran.exit_code == 6 && report["findings"].empty()) note(result, "verify:silent", "exit 6 without a finding");
}

}  // namespace

Depth depth_of(const std::string& rule) {
  if (rule.starts_with("build:")) return Depth::kBuild;
  if (rule.starts_with("L") || rule.starts_with("validate:")) return Depth::kValidate;
  if (rule.starts_with("V206") || rule.find(':') != std::string::npos) return Depth::kAll;
  return Depth::kVerifyWithoutDeviation;
}

TrialResult try_scene(const std::vector<std::uint8_t>& glb, const TrialOptions& options) {
  TrialResult result;
  const std::filesystem::path source = options.folder / "scene.glb";
  const std::string asset = (options.folder / "scene.lode").string(), again = (options.folder / "again.lode").string();
  const std::string cut = (options.folder / "cut.glb").string();
  {
    std::ofstream out(source, std::ios::binary);
    out.write(reinterpret_cast<const char*>(glb.data()), static_cast<std::streamsize>(glb.size()));
  }
  const bool is_built = build(result, options, asset, "1");
  if (is_built && options.other_jobs_too && options.depth <= Depth::kAll) {
    TrialResult other;
    if (!build(other, options, again, "3") || read_text(asset) != read_text(again)) {
      note(result, "build:jobs", "another number of threads, other bytes");
    }
  }
  if (is_built && options.depth >= Depth::kValidate) validate(result, options, asset);
  if (is_built && options.depth >= Depth::kVerifyWithoutDeviation) verify(result, options, asset);
  if (is_built && options.depth >= Depth::kAll) {
    const StepResult ran = run_step(options, {"extract", asset, "--error", "0.01", "--relative", "-o", cut, "--quiet"});
    ended_well(result, "extract", ran, false);
  }
  for (const std::filesystem::path& path :
       {source, std::filesystem::path(asset), std::filesystem::path(again), std::filesystem::path(cut),
        options.folder / "stdout", options.folder / "stderr"}) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  return result;
}

}  // namespace meshlode::test
