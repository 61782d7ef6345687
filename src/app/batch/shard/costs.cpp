// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/shard/costs.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "app/batch/shard/read_manifest.h"
#include "base/try.h"

namespace meshlode::app {

Result<std::vector<JobResult>> read_costs(const std::filesystem::path& manifest) {
  TRY_LET(read, read_manifest(manifest));
  if (read->shard) {
    return Error{ErrorCode::kInvalid, manifest.string(), "a shard's manifest: give that of the whole batch"};
  }
  if (!read->is_complete) {
    return Error{ErrorCode::kInvalid, manifest.string(), "the batch was interrupted, or is still at work"};
  }
  return std::move(read->results);
}

bool knows_any(const std::vector<JobResult>& last, const std::vector<Job>& jobs) {
  std::set<std::string> inputs;
  for (const JobResult& result : last) inputs.insert(result.job.input.native());
  return std::any_of(jobs.begin(), jobs.end(), [&](const Job& job) { return inputs.contains(job.input.native()); });
}

std::vector<std::uint64_t> weigh_by_costs(const std::vector<Job>& jobs, std::span<const std::uint64_t> bytes,
                                          const std::vector<JobResult>& last) {
  assert(bytes.size() == jobs.size());
  // A manifest's seconds are at most 10^12, so that neither this nor what is estimated below leaves 64 bits.
  constexpr double kMicroseconds = 1e6, kMost = 1e18;
  std::map<std::string, double> costs;
  for (const JobResult& result : last) {
    if (result.status != JobStatus::kBuilt || result.processor_seconds <= 0.0) continue;
    costs.emplace(result.job.input.native(), std::min(result.processor_seconds * kMicroseconds, kMost));
  }
  std::vector<double> known(jobs.size(), -1.0);
  double cost = 0.0, size = 0.0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto found = costs.find(jobs[i].input.native());
    if (found == costs.end()) continue;
    known[i] = found->second;
    cost += known[i];
    size += static_cast<double>(bytes[i]);
  }
  std::vector<std::uint64_t> weights(bytes.begin(), bytes.end());
  if (cost <= 0.0 || size <= 0.0) return weights;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const double weight = known[i] >= 0.0 ? known[i] : static_cast<double>(bytes[i]) * (cost / size);
    weights[i] = static_cast<std::uint64_t>(std::min(weight, kMost));
  }
  return weights;
}

}  // namespace meshlode::app
