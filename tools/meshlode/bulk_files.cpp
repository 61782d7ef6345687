// SPDX-License-Identifier: GPL-3.0-or-later
// Which files a verb of bulk.h works on, and where its outputs go.
#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "app/batch/shard/read_manifest.h"
#include "base/try.h"
#include "bulk.h"
#include "kept_manifest.h"
#include "output_name.h"
#include "outputs.h"
#include "streams.h"

namespace meshlode::cli {

namespace {

BulkInput input_of(const app::JobResult& r, ManifestSide side) {
  if (side == ManifestSide::kScenes) return {r.job.input.string()};
  BulkInput input{r.job.output.string(), r.job.input.string()};
  if (r.has_asset()) {
    input.asset_hash = r.asset_hash;
    return input;
  }
  input.exit_code = r.exit_code != 0 ? r.exit_code : static_cast<int>(ErrorCode::kIo);
  input.error = r.job.output.string() + ": no asset was made: " + (r.error.empty() ? "skipped" : r.error);
  return input;
}

}  // namespace

void add_bulk_inputs(OptionParser& parser, BulkWords& words, const char* name, const char* help,
                     const char* manifest_help) {
  words.name = name;
  parser.add_positionals(name, words.files, help, false);
  parser.group("Input");
  parser.add_value("--manifest FILE", words.manifest, manifest_help);
}

void add_bulk_outputs(OptionParser& parser, BulkWords& words) {
  parser.add_value("--junit FILE", words.junit, "write a JUnit file with one test case per file (default: none)");
}

void add_bulk_targets(OptionParser& parser, BulkWords& words, const std::string& what) {
  parser.add_value("-o,--output FILE", words.output, (what + " to write; or give -O (default: none)").c_str());
  parser.add_value("-O FOLDER", words.folder,
                   "write one for each file into this folder, by the file's place below the folder or pattern that "
                   "it was found by (default: none)");
}

void add_bulk_resources(OptionParser& parser, BulkWords& words) {
  add_jobs_option(parser, words.jobs);
  parser.add_value("--max-memory SIZE", words.max_memory,
                   "of many files, work on fewer at a time where they would need more, such as 8GiB; auto: what the "
                   "machine has left");
}

std::string shared_folder(const std::vector<app::JobResult>& results) {
  std::optional<std::filesystem::path> shared;
  for (const app::JobResult& r : results) {
    const std::filesystem::path folder = r.job.output.parent_path();
    if (!shared) shared = folder;
    const auto [end, other] = std::mismatch(shared->begin(), shared->end(), folder.begin(), folder.end());
    std::filesystem::path common;
    for (auto part = shared->begin(); part != end; ++part) common /= *part;
    shared = std::move(common);
  }
  return shared ? shared->string() : "";
}

Status name_places(std::vector<BulkInput>& files) {
  namespace fs = std::filesystem;
  std::map<std::string, std::string> taken;
  for (BulkInput& input : files) {
    const fs::path path = input.path.empty() ? input.source : input.path;
    fs::path place = input.base.empty() ? path : path.lexically_relative(input.base);
    const bool is_below = place.is_relative() && std::find(place.begin(), place.end(), "..") == place.end();
    if (!is_below || (input.base.empty() && !input.is_found)) place = path.filename();
    if (place.extension() == ".lode") place.replace_extension();
    input.place = place.lexically_normal().string();
    const auto [first, is_new] = taken.emplace(input.place, path.string());
    if (is_new) continue;
    return Error{ErrorCode::kUsage, path.string(), "has the same outputs as " + first->second};
  }
  return Ok{};
}

Status plan_outputs(BulkInputs& inputs, const BulkWords& words, const std::string& what, const std::string& extension) {
  if (words.output && !words.folder.empty()) return Error{ErrorCode::kUsage, "-o", "cannot be combined with -O"};
  if (!words.output && words.folder.empty()) return Error{ErrorCode::kUsage, "-o", "name the " + what + " to write"};
  if (words.output && inputs.files.size() != 1) {
    return Error{ErrorCode::kUsage, "-o", "one output for several files; give -O FOLDER"};
  }
  if (words.output && *words.output == kStream && !inputs.is_single) {
    return Error{ErrorCode::kUsage, "-o", "- is for one file, whose rows would go to stdout too; name a file"};
  }
  if (words.output) {
    TRY(check_output_name("-o", *words.output, extension));
    inputs.files.front().output = *words.output;
  } else {
    TRY(name_places(inputs.files));
  }
  for (BulkInput& input : inputs.files) {
    if (!input.error.empty()) continue;
    if (input.output.empty()) input.output = (std::filesystem::path(words.folder) / (input.place + extension)).string();
    keep_file(input.path);
  }
  for (const BulkInput& input : inputs.files) {
    if (!input.output.empty()) TRY(claim_output(input.output));
  }
  return Ok{};
}

Result<BulkInputs> find_bulk_inputs(const Verb& verb, const BulkWords& words, app::InputKind kind, ManifestSide side) {
  if (words.files.empty() && words.manifest.empty()) {
    return Error{ErrorCode::kUsage, "",
                 std::string(words.name) + " is required; see meshlode " + verb.name + " --help"};
  }
  BulkInputs inputs;
  std::error_code error;
  const bool is_named = words.files.size() == 1 && words.manifest.empty();
  inputs.is_single =
      is_named && !std::filesystem::is_directory(words.files.front(), error) && !app::is_pattern(words.files.front());
  for (const std::string& word : words.files) {
    TRY_LET(found, app::find_inputs(word, kind));
    const bool is_folder = std::filesystem::is_directory(word, error);
    const bool is_found = is_folder || app::is_pattern(word);
    inputs.is_whole = inputs.is_whole && is_folder;
    for (const std::filesystem::path& file : found->files) {
      inputs.files.push_back({file.string(), {}, found->base.string(), is_found});
    }
  }
  if (!words.manifest.empty()) {
    TRY_LET(manifest, read_kept_manifest(words.manifest));
    inputs.is_whole = inputs.is_whole && manifest->is_complete && !manifest->shard;
    const std::string base = shared_folder(manifest->results);
    for (const app::JobResult& r : manifest->results) {
      inputs.files.push_back(input_of(r, side));
      if (side == ManifestSide::kAssets) inputs.files.back().base = base;
    }
  }
  if (inputs.files.empty()) {
    return Error{ErrorCode::kIo, words.manifest.empty() ? words.files.front() : words.manifest,
                 kind == app::InputKind::kScenes ? "no scene in it" : "no asset in it"};
  }
  if (inputs.is_single && words.junit.empty()) return inputs;
  if (inputs.is_single) {
    inputs.is_single = false;  // its rows beside it
    if (inputs.files.front().path == kStream) return inputs;
  }
  for (const BulkInput& input : inputs.files) {
    if (input.path == kStream) return Error{ErrorCode::kUsage, "", "stdin is one file: give it alone"};
    for (const std::string& path : {input.path, input.source}) {
      keep_file(path);
    }
  }
  return inputs;
}

}  // namespace meshlode::cli
