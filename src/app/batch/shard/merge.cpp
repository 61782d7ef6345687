// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/shard/merge.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "app/batch/batch.h"
#include "base/file.h"
#include "base/try.h"
#include "base/version.h"

namespace meshlode::app {

namespace {

std::string text_of(const Shard& shard) {
  return "shard " + std::to_string(shard.index) + "/" + std::to_string(shard.count);
}

/// Whether two shards are of one batch that one program built with one command line. Empty: they are.
std::string difference(const ShardManifest& a, const ShardManifest& b) {
  const Manifest &x = a.manifest, &y = b.manifest;
  const std::string other = a.path.string();
  if (x.program != y.program) return "built by another program than " + other + ", or with other libraries";
  if (x.settings != y.settings) return "built with other settings than " + other;
  if (x.shard->shard.count != y.shard->shard.count) return "one of another number of shards than " + other;
  if (x.shard->batch != y.shard->batch || x.shard->batch_jobs != y.shard->batch_jobs) {
    return "of another batch than " + other + ", or files came or went between the two";
  }
  return {};
}

Status check_each(const std::vector<ShardManifest>& shards) {
  for (const ShardManifest& shard : shards) {
    if (!shard.manifest.shard) {
      return Error{ErrorCode::kInvalid, shard.path.string(), "no shard's manifest: build wrote it without --shard"};
    }
    if (shard.manifest.generator != program_version()) {
      return Error{ErrorCode::kCheckFailed, shard.path.string(),
                   "written by " + shard.manifest.generator + ", and this is " + program_version()};
    }
    if (!shard.manifest.is_complete) {
      return Error{ErrorCode::kCheckFailed, shard.path.string(),
                   text_of(shard.manifest.shard->shard) + " was interrupted, or is still at work: build it again"};
    }
    const std::string words = difference(shards.front(), shard);
    if (!words.empty()) return Error{ErrorCode::kCheckFailed, shard.path.string(), words};
  }
  return Ok{};
}

/// Shards that nobody gave, in words: "shards 2, 5 of 8 are missing".
std::string missing_words(const std::vector<ShardManifest>& shards, std::uint32_t count) {
  constexpr std::size_t kNamed = 20;
  std::set<std::uint32_t> there;
  for (const ShardManifest& shard : shards) there.insert(shard.manifest.shard->shard.index);
  const std::size_t missing = count - there.size();
  if (missing == 0) return {};
  std::string text = missing == 1 ? "shard" : "shards";
  std::size_t named = 0;
  for (std::uint32_t i = 1; i <= count && named < kNamed; ++i) {
    if (there.contains(i)) continue;
    text += (named == 0 ? " " : ", ") + std::to_string(i);
    ++named;
  }
  if (missing > named) text += " and " + std::to_string(missing - named) + " more";
  return text + " of " + std::to_string(count) + (missing == 1 ? " is" : " are") + " missing";
}

/// Sorted by index. \pre all of one batch
Status check_all_there(std::vector<ShardManifest>& shards) {
  std::stable_sort(shards.begin(), shards.end(), [](const ShardManifest& a, const ShardManifest& b) {
    return a.manifest.shard->shard.index < b.manifest.shard->shard.index;
  });
  for (std::size_t i = 1; i < shards.size(); ++i) {
    const Shard& shard = shards[i].manifest.shard->shard;
    if (shard.index != shards[i - 1].manifest.shard->shard.index) continue;
    return Error{ErrorCode::kCheckFailed, shards[i].path.string(),
                 text_of(shard) + " is there twice: " + shards[i - 1].path.string()};
  }
  std::string missing = missing_words(shards, shards.front().manifest.shard->shard.count);
  if (!missing.empty()) return Error{ErrorCode::kCheckFailed, "", std::move(missing)};
  return Ok{};
}

}  // namespace

Result<Manifest> merge_shards(std::vector<ShardManifest> shards) {
  if (shards.empty()) return Error{ErrorCode::kUsage, "", "no shards to merge"};
  TRY(check_each(shards));
  TRY(check_all_there(shards));

  std::vector<std::tuple<std::uint64_t, std::size_t, std::size_t>> places;  // position, shard, file of it
  for (std::size_t s = 0; s < shards.size(); ++s) {
    const std::vector<std::uint64_t>& positions = shards[s].manifest.shard->positions;
    for (std::size_t i = 0; i < positions.size(); ++i) places.emplace_back(positions[i], s, i);
  }
  std::sort(places.begin(), places.end());
  const Manifest& first = shards.front().manifest;
  const std::uint64_t batch_jobs = first.shard->batch_jobs;
  Manifest merged{
      first.generator, kManifestVersion, first.program, first.versions, first.settings, 0, true, std::nullopt, {}};
  constexpr const char* kAgain = "; inputs or --shard-costs changed between shards: build all of them again";
  for (const auto& [position, s, i] : places) {
    JobResult& result = shards[s].manifest.results[i];
    if (position < merged.results.size()) {
      return Error{ErrorCode::kCheckFailed, result.job.input.string(), std::string("is in two shards") + kAgain};
    }
    if (position > merged.results.size()) break;
    merged.results.push_back(std::move(result));
  }
  if (merged.results.size() != batch_jobs) {
    return Error{ErrorCode::kCheckFailed, "",
                 "file " + std::to_string(merged.results.size() + 1) + " of " + std::to_string(batch_jobs) +
                     " is in no shard" + kAgain};
  }
  std::vector<Job> jobs;
  for (const JobResult& result : merged.results) jobs.push_back(result.job);
  if (hash_jobs(jobs) != first.shard->batch) {
    return Error{ErrorCode::kCheckFailed, "",
                 "the files of the shards are not those of their batch: a manifest was edited, or a name is not UTF-8"};
  }
  merged.exit_code = worst_exit_code(merged.results);
  return merged;
}

Status check_assets(const std::vector<JobResult>& results) {
  for (const JobResult& r : results) {
    if (!r.has_asset()) continue;
    const auto file = MappedFile::open(r.job.output);
    if (!file) return Error{ErrorCode::kCheckFailed, file.error().where, file.error().detail};
    if (file->bytes().size() != r.facts.bytes || hash128(file->bytes()) != r.asset_hash) {
      return Error{ErrorCode::kCheckFailed, r.job.output.string(),
                   "is not the asset that the manifest of its shard lists; build that shard again"};
    }
  }
  return Ok{};
}

}  // namespace meshlode::app
