// SPDX-License-Identifier: GPL-3.0-or-later
// A batch is cut into shards of about equal cost, one a machine. Each machine cuts for itself and finds the same: what
// decides is the list of jobs, their weights and the number of shards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/batch/jobs/jobs.h"
#include "base/hash.h"

namespace meshlode::app {

/// Shard `index` of `count`, from 1 on.
struct Shard {
  std::uint32_t index = 1, count = 1;
};
constexpr std::uint32_t kMaxShards = 100'000;

/// What a batch is known by: inputs and outputs of all its jobs, in their order.
[[nodiscard]] Hash128 hash_jobs(const std::vector<Job>& jobs);

/// "3/8". Errors: kUsage for what is no such pair, 1 to kMaxShards.
[[nodiscard]] Result<Shard> parse_shard(std::string_view text);

/// The shard of each job, 1 to `count`: the heaviest first, each into the shard that has least so far, the first of
/// equals. So no shard has more than another by more than its lightest job weighs, nor more than 4/3 of what the
/// heaviest one of the best partition has (Graham 1969). A weight of 0 counts as 1.
/// \pre 1 <= count
[[nodiscard]] std::vector<std::uint32_t> assign_shards(std::span<const std::uint64_t> weights, std::uint32_t count);

/// A share of a batch, and what it is a share of.
struct ShardPlan {
  Shard shard;
  std::uint64_t batch_jobs = 0;          ///< of all shards
  Hash128 batch{};                       ///< hash_jobs() of all
  std::vector<std::uint64_t> positions;  ///< of this shard's jobs among all, ascending
};

/// \pre as many weights as jobs
[[nodiscard]] ShardPlan plan_shard(const std::vector<Job>& jobs, std::span<const std::uint64_t> weights, Shard shard);

}  // namespace meshlode::app
