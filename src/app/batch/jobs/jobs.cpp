// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/jobs/jobs.h"

#include <algorithm>
#include <set>
#include <system_error>

#include "app/batch/jobs/find_inputs.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;

fs::path with_lode_extension(const fs::path& path) {
  fs::path out = path;
  return out.replace_extension(".lode");
}

/// Two outputs of one name keep their inputs' extensions; those that are still one are refused.
Status tell_apart(std::vector<Job>& jobs) {
  std::set<fs::path> seen, twice;
  for (const Job& job : jobs) {
    if (!seen.insert(job.output.lexically_normal()).second) twice.insert(job.output.lexically_normal());
  }
  std::set<fs::path> final_names;
  for (Job& job : jobs) {
    if (twice.contains(job.output.lexically_normal())) {
      job.output.replace_filename(job.input.filename().string() + ".lode");
    }
    if (!final_names.insert(job.output.lexically_normal()).second) {
      return Error{ErrorCode::kUsage, job.input.string(), "two inputs would both become " + job.output.string()};
    }
  }
  return Ok{};
}

}  // namespace

Result<std::vector<Job>> plan_jobs(const std::vector<std::string>& inputs, const std::string& output,
                                   const std::string& output_folder) {
  std::vector<Job> jobs;
  std::error_code ec;
  for (const std::string& input : inputs) {
    const bool is_folder = fs::is_directory(input, ec);
    if (!is_folder && !is_pattern(input)) {
      const fs::path name = with_lode_extension(fs::path(input).filename());
      jobs.push_back({input, !output.empty()         ? fs::path(output)
                             : output_folder.empty() ? with_lode_extension(input)
                                                     : output_folder / name});
      continue;
    }
    if (is_folder && output_folder.empty()) {
      return Error{ErrorCode::kUsage, input, "a folder as input needs -O FOLDER for the output"};
    }
    TRY_LET(found, find_inputs(input, InputKind::kScenes));
    for (const fs::path& path : found->files) {
      const fs::path inner = found->base.empty() ? path : path.lexically_relative(found->base);
      jobs.push_back({path,
                      !output.empty()         ? fs::path(output)
                      : output_folder.empty() ? with_lode_extension(path)
                                              : output_folder / with_lode_extension(inner),
                      found->base});
    }
  }
  if (!output.empty() && (jobs.size() != 1 || inputs.size() != 1)) {
    return Error{ErrorCode::kUsage, "-o", "one output for several inputs; give -O FOLDER"};
  }
  TRY(tell_apart(jobs));
  return jobs;
}

}  // namespace meshlode::app
