// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/shard/partition.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <string>
#include <utility>

#include "base/printable.h"

namespace meshlode::app {

namespace {

std::optional<std::uint32_t> parse_count(std::string_view text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Sparse files may say that they have any number of bytes.
std::uint64_t saturated_sum(std::uint64_t a, std::uint64_t b) {
  return a > std::numeric_limits<std::uint64_t>::max() - b ? std::numeric_limits<std::uint64_t>::max() : a + b;
}

}  // namespace

Hash128 hash_jobs(const std::vector<Job>& jobs) {
  Hasher hasher;
  const auto add = [&](const std::string& path) {  // with the zero behind it, which no path has
    hasher.update({reinterpret_cast<const std::uint8_t*>(path.c_str()), path.size() + 1});
  };
  for (const Job& job : jobs) {
    add(job.input.native());
    add(job.output.native());
  }
  return hasher.digest();
}

Result<Shard> parse_shard(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto index = parse_count(text.substr(0, slash));
  const auto count = parse_count(slash == std::string_view::npos ? std::string_view() : text.substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count || *count > kMaxShards) {
    return Error{
        ErrorCode::kUsage, "--shard",
        "expected I/N, such as 3/8: share I of N, 1 to N; N is at most " + std::to_string(kMaxShards) + got_text(text)};
  }
  return Shard{*index, *count};
}

std::vector<std::uint32_t> assign_shards(std::span<const std::uint64_t> weights, std::uint32_t count) {
  assert(count >= 1);
  std::vector<std::size_t> order(weights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return weights[a] != weights[b] ? weights[a] > weights[b] : a < b; });
  using Load = std::pair<std::uint64_t, std::uint32_t>;  // weight so far, shard
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  // Of more shards than jobs the first alone get any, because one that has a job never has least.
  const auto used = static_cast<std::uint32_t>(std::min<std::uint64_t>(count, weights.size()));
  for (std::uint32_t shard = 1; shard <= used; ++shard) loads.emplace(std::uint64_t{0}, shard);
  std::vector<std::uint32_t> shards(weights.size());
  for (const std::size_t job : order) {
    const auto [load, shard] = loads.top();
    loads.pop();
    shards[job] = shard;
    loads.emplace(saturated_sum(load, std::max<std::uint64_t>(weights[job], 1)), shard);
  }
  return shards;
}

ShardPlan plan_shard(const std::vector<Job>& jobs, std::span<const std::uint64_t> weights, Shard shard) {
  assert(weights.size() == jobs.size());
  ShardPlan plan{shard, jobs.size(), hash_jobs(jobs), {}};
  const std::vector<std::uint32_t> shards = assign_shards(weights, shard.count);
  for (std::size_t i = 0; i < shards.size(); ++i) {
    if (shards[i] == shard.index) plan.positions.push_back(i);
  }
  return plan;
}

}  // namespace meshlode::app
