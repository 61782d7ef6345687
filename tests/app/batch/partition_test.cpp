// SPDX-License-Identifier: GPL-3.0-or-later
// Which shard builds which file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "app/batch/jobs/weigh.h"
#include "app/batch/shard/costs.h"
#include "app/batch/shard/partition.h"
#include "batch_folder.h"

namespace meshlode::app {
namespace {

std::vector<std::uint64_t> loads_of(const std::vector<std::uint64_t>& weights, const std::vector<std::uint32_t>& shards,
                                    std::uint32_t count) {
  std::vector<std::uint64_t> loads(count);
  for (std::size_t i = 0; i < weights.size(); ++i) loads.at(shards.at(i) - 1) += weights[i];
  return loads;
}

std::uint64_t heaviest(const std::vector<std::uint64_t>& loads) {
  return *std::max_element(loads.begin(), loads.end());
}

/// The least that the heaviest of `count` shards can have: all partitions are tried.
std::uint64_t best_of_all(const std::vector<std::uint64_t>& weights, std::uint32_t count) {
  std::vector<std::uint32_t> shards(weights.size(), 1);
  std::uint64_t best = std::numeric_limits<std::uint64_t>::max();
  while (true) {
    best = std::min(best, heaviest(loads_of(weights, shards, count)));
    std::size_t digit = 0;
    while (digit < shards.size() && shards[digit] == count) shards[digit++] = 1;
    if (digit == shards.size()) return best;
    ++shards[digit];
  }
}

std::vector<std::uint64_t> draw_weights(std::mt19937& random, std::size_t count) {
  std::vector<std::uint64_t> weights;
  for (std::size_t i = 0; i < count; ++i) {
    const auto shift = static_cast<unsigned>(random() % 24);  // most are small, and some much larger than all others
    weights.push_back(1 + (random() & ((1U << shift) - 1U)));
  }
  return weights;
}

// The bounds of the header. The seed is that of the loop.
TEST(Partition, EveryJobIsInOneShardAndLoadsAreWithinTheBound) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto weights = draw_weights(random, random() % 60);
    const auto count = static_cast<std::uint32_t>(1 + random() % 12);
    const auto shards = assign_shards(weights, count);
    ASSERT_EQ(shards.size(), weights.size());
    std::vector<std::uint64_t> lightest(count, std::numeric_limits<std::uint64_t>::max());
    for (std::size_t i = 0; i < shards.size(); ++i) {
      ASSERT_GE(shards[i], 1U);
      ASSERT_LE(shards[i], count);
      lightest[shards[i] - 1] = std::min(lightest[shards[i] - 1], weights[i]);
    }
    const auto loads = loads_of(weights, shards, count);
    const std::uint64_t least = *std::min_element(loads.begin(), loads.end());
    for (std::uint32_t s = 0; s < count; ++s) {
      if (loads[s] == 0) continue;
      EXPECT_LE(loads[s] - lightest[s], least) << "shard " << s + 1;
    }
  }
}

TEST(Partition, TheHeaviestShardIsAtMostAThirdAboveTheBestPossible) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto weights = draw_weights(random, 1 + random() % 8);
    const auto count = static_cast<std::uint32_t>(2 + random() % 2);
    EXPECT_LE(3 * heaviest(loads_of(weights, assign_shards(weights, count), count)), 4 * best_of_all(weights, count));
  }
}

// Worked by hand: 9 to 1, 7 to 2, 6 to 3, 5 to 3 (11), 5 to 2 (12), 4 to 1 (13), 3 to 3 (14), 1 to 2 (13).
TEST(Partition, IsTheSameEverywhere) {
  const std::vector<std::uint64_t> weights{5, 1, 9, 7, 6, 5, 4, 3};
  EXPECT_EQ(assign_shards(weights, 3), (std::vector<std::uint32_t>{3, 2, 1, 2, 3, 2, 1, 3}));
  EXPECT_EQ(assign_shards(weights, 1), std::vector<std::uint32_t>(8, 1));
  EXPECT_EQ(assign_shards({}, 5), std::vector<std::uint32_t>{});
}

TEST(Partition, HoldsForWeightsOfNothingAndOfMoreThanCanBeAdded) {
  EXPECT_EQ(assign_shards(std::vector<std::uint64_t>{0, 0, 0}, 3), (std::vector<std::uint32_t>{1, 2, 3}));
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(assign_shards(std::vector<std::uint64_t>{most, most, 1, most}, 2),
            (std::vector<std::uint32_t>{1, 2, 1, 1}));
  EXPECT_EQ(assign_shards(std::vector<std::uint64_t>{3, 4}, kMaxShards), (std::vector<std::uint32_t>{2, 1}));
}

TEST(Partition, TheSharesOfAllShardsAreTheBatch) {
  const std::vector<Job> jobs{{"a", "A"}, {"b", "B"}, {"c", "C"}, {"d", "D"}, {"e", "E"}};
  const std::vector<std::uint64_t> weights{5, 4, 3, 2, 1};
  std::vector<std::uint64_t> all;
  for (std::uint32_t index = 1; index <= 3; ++index) {
    const ShardPlan plan = plan_shard(jobs, weights, {index, 3});
    EXPECT_EQ(plan.batch_jobs, 5U);
    EXPECT_TRUE(std::is_sorted(plan.positions.begin(), plan.positions.end()));
    all.insert(all.end(), plan.positions.begin(), plan.positions.end());
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all, (std::vector<std::uint64_t>{0, 1, 2, 3, 4}));
}

TEST(Partition, ABatchIsKnownByItsFilesAndTheirOrder) {
  const auto hash_of = [](const std::vector<Job>& jobs) {
    return plan_shard(jobs, std::vector<std::uint64_t>(jobs.size(), 1), {1, 2}).batch;
  };
  EXPECT_EQ(hash_of({{"a", "A"}, {"b", "B"}}), hash_of({{"a", "A"}, {"b", "B"}}));
  EXPECT_NE(hash_of({{"a", "A"}, {"b", "B"}}), hash_of({{"b", "B"}, {"a", "A"}}));
  EXPECT_NE(hash_of({{"a", "A"}, {"b", "B"}}), hash_of({{"a", "A"}}));
  EXPECT_NE(hash_of({{"a", "A"}}), hash_of({{"aA", ""}}));
}

TEST(Shard, IsReadFromTwoNumbersAndNothingElse) {
  const auto shard = parse_shard("3/8");
  ASSERT_TRUE(shard);
  EXPECT_EQ(shard->index, 3U);
  EXPECT_EQ(shard->count, 8U);
  EXPECT_TRUE(parse_shard("100000/100000"));
  for (const char* text : {"", "/", "3", "3/", "/8", "0/8", "9/8", "0/0", "-1/8", "+1/8", " 1/8", "1/8 ", "1/2/3",
                           "1/x", "1/100001", "1/99999999999999999999"}) {
    const auto none = parse_shard(text);
    ASSERT_FALSE(none) << text;
    EXPECT_EQ(none.error().code, ErrorCode::kUsage) << text;
  }
}

TEST(Weight, IsOfTheSceneAndOfWhatAGltfNames) {
  const BatchFolder folder;
  const auto scene = folder.write_scene("a", 1);
  const auto size = [&](const char* name) { return BatchFolder::text_of(folder.path(name)).size(); };
  EXPECT_EQ(weigh_scene(scene), 1 + size("a.gltf") + size("a.bin") + size("a.png"));
  std::filesystem::remove(folder.path("a.png"));
  EXPECT_EQ(weigh_scene(scene), 1 + size("a.gltf") + size("a.bin"));
  EXPECT_EQ(weigh_scene(folder.write("b.gltf", "broken")), 1U + 6U);
  EXPECT_EQ(weigh_scene(folder.write("b.ply", "ply")), 1U + 3U);
  EXPECT_EQ(weigh_scene(folder.path("missing.glb")), 1U);
}

JobResult built_in(const char* input, double processor_seconds, JobStatus status = JobStatus::kBuilt) {
  JobResult result;
  result.job.input = input;
  result.status = status;
  result.processor_seconds = processor_seconds;
  return result;
}

std::vector<Job> jobs_of(std::initializer_list<const char*> inputs) {
  std::vector<Job> jobs;
  for (const char* input : inputs) jobs.emplace_back().input = input;
  return jobs;
}

TEST(Partition, MeasuredCostsWeighAndTheOthersAreEstimatedAtTheirRate) {
  const auto jobs = jobs_of({"a", "b", "new", "cached", "failed"});
  const std::vector<std::uint64_t> bytes{100, 300, 50, 200, 400};
  // 8 s for 400 bytes: 20 ms a byte. What a cache gave or what failed was no build.
  const std::vector<JobResult> last{built_in("gone", 500.0), built_in("b", 2.0), built_in("a", 6.0),
                                    built_in("cached", 0.01, JobStatus::kCached),
                                    built_in("failed", 0.02, JobStatus::kFailed)};
  EXPECT_EQ(weigh_by_costs(jobs, bytes, last),
            (std::vector<std::uint64_t>{6'000'000, 2'000'000, 1'000'000, 4'000'000, 8'000'000}));
}

TEST(Partition, WithoutMeasuredCostsBytesWeigh) {
  const auto jobs = jobs_of({"a", "b"});
  const std::vector<std::uint64_t> bytes{7, 9};
  EXPECT_EQ(weigh_by_costs(jobs, bytes, {}), bytes);
  EXPECT_EQ(weigh_by_costs(jobs, bytes, {built_in("a", 0.0), built_in("b", 1.0, JobStatus::kUnchanged)}), bytes);
  EXPECT_EQ(weigh_by_costs(jobs, bytes, {built_in("other", 3.0)}), bytes);
}

TEST(Partition, CostsBeyondAnyRangeStayNumbers) {
  const auto jobs = jobs_of({"a", "sparse"});
  const std::vector<std::uint64_t> bytes{1, std::numeric_limits<std::uint64_t>::max()};
  const auto weights = weigh_by_costs(jobs, bytes, {built_in("a", 1e12)});
  EXPECT_EQ(weights, (std::vector<std::uint64_t>{1'000'000'000'000'000'000U, 1'000'000'000'000'000'000U}));
  EXPECT_EQ(assign_shards(weights, 2), (std::vector<std::uint32_t>{1, 2}));
}

}  // namespace
}  // namespace meshlode::app
