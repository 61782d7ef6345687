// SPDX-License-Identifier: GPL-3.0-or-later
// What a batch says of itself when it is over, each as one text.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "app/batch/jobs/job_result.h"
#include "app/batch/shard/partition.h"
#include "base/hash.h"

namespace meshlode::app {

/// docs/schemas/report.schema.json. Times and paths live here and never in an asset. `jobs`: threads asked for.
[[nodiscard]] std::string report_json(const std::vector<JobResult>& results, std::uint32_t jobs, int exit_code);

/// Of manifests as they are written. Version 1, which said nothing of it, had neither versions nor an asset's settings,
/// use of the cache, processor time and memory; it is read.
constexpr std::uint64_t kManifestVersion = 2;
/// Of the libraries that the program stands on, by name.
using Versions = std::vector<std::pair<std::string, std::string>>;

/// docs/schemas/manifest.schema.json: every file with its status, what it was made of and what came of it.
/// `settings`: settings_text(). `program`: find_program_id(). `shard`: what the results are a share of, where they are:
/// then it has as many positions as there are results. `is_complete`: the batch is over, and was not interrupted.
[[nodiscard]] std::string manifest_json(const std::vector<JobResult>& results, const Hash128& program,
                                        const std::string& settings, int exit_code, const ShardPlan* shard = nullptr,
                                        bool is_complete = true, const Versions& versions = {});

/// One file of a batch of any verb, as build servers show it.
struct TestCase {
  std::string name;
  double seconds = 0.0;
  int exit_code = 0;  ///< not 0: it failed
  std::string text;   ///< why, or what else there is to say
  bool is_skipped = false;
};
/// A test case a file: a failure with its line, a skipped one as skipped.
[[nodiscard]] std::string junit_xml(const std::string& verb, const std::vector<TestCase>& tests);
[[nodiscard]] std::string junit_xml(const std::vector<JobResult>& results);

/// How often a batch asked its cache, and what it got.
struct CacheCounts {
  std::uint64_t hits = 0, misses = 0;
  std::uint64_t meshes = 0;  ///< that assets which were built took from it
};
[[nodiscard]] CacheCounts count_cache_use(const std::vector<JobResult>& results);

/// summary_line(), the use of the cache where there is one, and the sums of triangles, bytes and seconds.
[[nodiscard]] std::string summary_text(const std::vector<JobResult>& results);
/// "3 files: 1 built, 1 unchanged, 1 failed", kinds that occur alone; "nothing to do …" where all are unchanged; how
/// many have warnings.
[[nodiscard]] std::string summary_line(const std::vector<JobResult>& results);

}  // namespace meshlode::app
