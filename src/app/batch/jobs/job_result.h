// SPDX-License-Identifier: GPL-3.0-or-later
// What became of one file of a batch: all that reports, manifests and tables are written from.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/batch/depend/dependencies.h"
#include "app/batch/jobs/jobs.h"
#include "app/settings/effective.h"
#include "base/enum_names.h"
#include "base/hash.h"
#include "builder/progress.h"
#include "scene/scene.h"

namespace meshlode::app {

enum class JobStatus : std::uint8_t {
  kBuilt,
  kCached,      ///< the output was written from the cache
  kUnchanged,   ///< the output already was what would have been written
  kFailed,      ///< no asset, or one that BatchOptions::check_asset refused
  kSkipped,     ///< after another one's failure, or after an interrupt, which `error` then says
  kWouldBuild,  ///< --dry-run
  kWouldCopy,   ///< --dry-run
};
constexpr std::size_t kJobStatusCount = 7;
inline constexpr std::array<EnumName<JobStatus>, kJobStatusCount> kJobStatusNames{
    {{JobStatus::kBuilt, "built"},
     {JobStatus::kCached, "cached"},
     {JobStatus::kUnchanged, "unchanged"},
     {JobStatus::kFailed, "failed"},
     {JobStatus::kSkipped, "skipped"},
     {JobStatus::kWouldBuild, "would_build"},
     {JobStatus::kWouldCopy, "would_copy"}}};
constexpr const char* name_of(JobStatus status) {
  return name_in(kJobStatusNames, status);
}

/// What the scene and its build were like; the cache keeps it beside the asset.
struct JobFacts {
  std::uint64_t triangles = 0, meshes = 0, instances = 0;
  std::uint64_t bytes = 0;                  ///< of the asset
  std::uint64_t dropped = 0;                ///< by --repair, of all kinds
  std::uint64_t file_triangles = 0;         ///< that the file plainly holds; 0: the format does not tell
  std::uint64_t missing = 0;                ///< of these the ones that are neither in the scene nor dropped
  bool draws_nothing = false;               ///< no triangle of the scene has an area: the asset has no cluster
  scene::MeshRepairs repairs;               ///< of all meshes
  std::vector<scene::LeftOut> left_out;     ///< by the importer
  std::vector<scene::LeftOut> planned_out;  ///< by the plan
  std::vector<scene::LeftOut> losses;       ///< those of them that can be seen
};

/// What is wrong with an asset that was built all the same.
struct JobWarning {
  std::string id;    ///< as doctor has it of the source: "nothing-to-draw", "triangles-missing"
  std::string text;  ///< one line
};

/// Whether a job asked the cache for its asset, and what it got.
enum class CacheUse : std::uint8_t {
  kNone,  ///< there is none, or the job did not come to it
  kHit,
  kMiss,  ///< the reason is the result's
};
constexpr std::size_t kCacheUseCount = 3;
inline constexpr std::array<EnumName<CacheUse>, kCacheUseCount> kCacheUseNames{
    {{CacheUse::kNone, "none"}, {CacheUse::kHit, "hit"}, {CacheUse::kMiss, "miss"}}};
constexpr const char* name_of(CacheUse use) {
  return name_in(kCacheUseNames, use);
}

struct JobResult {
  Job job;
  JobStatus status = JobStatus::kSkipped;
  int exit_code = 0;
  std::string error;
  std::string reason;  ///< why it was built, or would be; empty where nobody asked (no cache)
  JobFacts facts;
  std::vector<JobWarning> warnings;
  Hash128 asset_hash{};            ///< of the asset's bytes; zeros where there is none
  double seconds = 0.0;            ///< wall time
  double processor_seconds = 0.0;  ///< of all threads
  std::uint64_t peak_memory = 0;   ///< of the process while the job ran; 0: not known
  CacheUse cache = CacheUse::kNone;
  std::optional<EffectiveSettings> settings;  ///< nothing: they are not known, or wrong
  std::uint64_t memory_estimate = 0;          ///< 0: not reached
  std::uint64_t meshes_from_cache = 0;
  std::vector<builder::StageTime> stages;
  std::vector<builder::LevelTime> levels;
  std::string decided;                       ///< describe_decided(); empty where nothing was built
  std::vector<Dependency> files;             ///< where asked for
  std::vector<std::string> refused_outputs;  ///< of BatchOptions::side_outputs: they are files of the scene

  [[nodiscard]] bool has_asset() const {
    return status == JobStatus::kBuilt || status == JobStatus::kCached || status == JobStatus::kUnchanged;
  }
};

/// Each kind of repair with its count.
[[nodiscard]] inline std::vector<std::pair<const char*, std::uint64_t>> list_repairs(const JobFacts& facts) {
  return {{"unusable", facts.dropped - facts.repairs.degenerate - facts.repairs.duplicate},
          {"degenerate", facts.repairs.degenerate},
          {"duplicate", facts.repairs.duplicate},
          {"turned", facts.repairs.turned},
          {"stitched", facts.repairs.stitched},
          {"cut_edges", facts.repairs.cut_edges},
          {"split", facts.repairs.split}};
}

}  // namespace meshlode::app
