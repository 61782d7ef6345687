// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/jobs/jobs.h"

#include <algorithm>
#include <set>
#include <system_error>

#include "app/batch/jobs/glob.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;

bool is_scene_file(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (const char* known : {".gltf", ".glb", ".ply", ".obj", ".stl"}) {
    if (extension == known) return true;
  }
  return false;
}

fs::path with_lode_extension(const fs::path& path) {
  fs::path out = path;
  return out.replace_extension(".lode");
}

/// Every scene below a folder, in byte order of the paths so that a batch runs the same way everywhere.
Result<std::vector<fs::path>> scan_folder(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code ec;
  for (fs::recursive_directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
    std::error_code type_error;
    if (it->is_regular_file(type_error) && is_scene_file(it->path())) found.push_back(it->path());
  }
  if (ec) return Error{ErrorCode::kIo, folder.string(), ec.message()};
  std::sort(found.begin(), found.end(), [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
  return found;
}

/// The scenes that a folder or a pattern means, and what their names below the output folder are relative to.
struct Found {
  fs::path base;
  std::vector<fs::path> files;
};

Result<Found> find_scenes(const std::string& input, bool is_folder) {
  if (is_folder) {
    TRY_LET(files, scan_folder(input));
    return Found{input, std::move(*files)};
  }
  TRY_LET(matches, find_matches(input));
  Found found{matches->base, {}};
  for (const fs::path& file : matches->files) {
    if (is_scene_file(file)) found.files.push_back(file);
  }
  if (found.files.empty()) return Error{ErrorCode::kIo, input, "no scene matches this pattern"};
  return found;
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
    const bool is_pattern = !is_folder && has_wildcards(input) && !fs::exists(input, ec);
    if (!is_folder && !is_pattern) {
      const fs::path name = with_lode_extension(fs::path(input).filename());
      jobs.push_back({input, !output.empty()         ? fs::path(output)
                             : output_folder.empty() ? with_lode_extension(input)
                                                     : output_folder / name});
      continue;
    }
    if (is_folder && output_folder.empty()) {
      return Error{ErrorCode::kUsage, input, "a folder as input needs -O FOLDER for the output"};
    }
    TRY_LET(found, find_scenes(input, is_folder));
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
