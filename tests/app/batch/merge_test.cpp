// SPDX-License-Identifier: GPL-3.0-or-later
// Manifests of shards are read again and become the one of the whole batch, or are refused.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "app/batch/batch.h"
#include "app/batch/shard/merge.h"
#include "app/batch/shard/partition.h"
#include "app/batch/shard/read_manifest.h"
#include "app/batch/tell/tell.h"
#include "app/settings/effective.h"
#include "batch_folder.h"
#include "scene/import/json.h"

namespace meshlode::app {
namespace {

constexpr std::uint32_t kShards = 3;
const std::vector<std::uint64_t> kWeights{7, 6, 5, 4, 3, 2, 1};
const std::string kSettings = "codec strips\npreset fast\nscene the first\n";

Hash128 hash_of(std::uint8_t number) {
  Hash128 hash{};
  hash.fill(number);
  return hash;
}

/// Of every type, from every place.
EffectiveSettings settings_of(std::uint8_t i) {
  SettingLayer file{"in/meshlode.json", ErrorCode::kInvalid, {}, {}},
      line{"the command line", ErrorCode::kUsage, {}, {}};
  file[Setting::kKeep] = "NORMAL,COLOR_0";
  file[Setting::kUvError] = "0.25px";
  file.mesh_rules.push_back({"rock*", {}});
  file.mesh_rules.back().words[static_cast<std::size_t>(Setting::kPositionError)] = "1e-05";
  line[Setting::kClusterTriangles] = std::to_string(64 + i);
  line[Setting::kRepair] = "true";
  line[Setting::kPreset] = "fast";
  const std::vector<SettingLayer> layers{file, line};
  return effective_settings(*settle(layers), layers);
}

/// File `i` of the batch, each of another kind.
JobResult result_of(std::uint8_t i) {
  const std::string name(1, static_cast<char>('a' + i));
  JobResult r;
  r.job = {"in/" + name + " \"x\"\\.gltf", "out/" + name + ".lode"};
  r.seconds = 0.25 * i;
  r.processor_seconds = 0.5 * i;
  r.peak_memory = i == 4 ? 0 : 1000U * i;
  r.cache = i == 1 ? CacheUse::kHit : i == 2 ? CacheUse::kNone : CacheUse::kMiss;
  if (r.cache == CacheUse::kMiss) r.reason = "image \"x\" changed";
  r.meshes_from_cache = i;
  if (i != 5) r.settings = settings_of(i);
  if (i == 3) {
    r.status = JobStatus::kFailed;
    r.exit_code = 3;
    r.error = "in/d: /accessors: broken\nin two lines";
    return r;
  }
  r.status = i == 1 ? JobStatus::kCached : i == 2 ? JobStatus::kUnchanged : JobStatus::kBuilt;
  r.asset_hash = hash_of(static_cast<std::uint8_t>(i * 17));
  r.facts.bytes = 1000 + i;
  const FileStamp stamp{{}, std::uint64_t{1} << 40U, 0, 0};
  r.files = {{FileKind::kScene, "", r.job.input, stamp, hash_of(i)},
             {FileKind::kBuffer, "", "in/x.bin", stamp, hash_of(9)}};
  r.files.push_back({FileKind::kImage, "", "in/missing.png", std::nullopt, {}});
  r.files.push_back({FileKind::kMaterials, "", "in/x.mtl", stamp, hash_of(7)});
  r.files.push_back({FileKind::kSettings, "", "in/meshlode.json", stamp, hash_of(8)});
  return r;
}

/// A batch of seven files, as one manifest and as those of three shards.
class MergeTest : public testing::Test {
 protected:
  MergeTest() {
    for (std::uint8_t i = 0; i < 7; ++i) results_.push_back(result_of(i));
    for (const JobResult& r : results_) jobs_.push_back(r.job);
  }
  [[nodiscard]] std::string whole() const {
    return manifest_json(results_, hash_of(1), kSettings, worst_exit_code(results_));
  }
  /// The text of one shard's manifest; `weights` decide what is in it.
  [[nodiscard]] std::string shard(std::uint32_t index, const std::vector<std::uint64_t>& weights, std::uint32_t count,
                                  std::uint8_t program = 1, const std::string& settings = kSettings) const {
    const ShardPlan plan = plan_shard(jobs_, weights, {index, count});
    std::vector<JobResult> mine;
    for (const std::uint64_t position : plan.positions) mine.push_back(results_[position]);
    return manifest_json(mine, hash_of(program), settings, worst_exit_code(mine), &plan);
  }
  [[nodiscard]] std::string shard(std::uint32_t index) const { return shard(index, kWeights, kShards); }

  /// What merging these texts says, or writes.
  static std::string merged(const std::vector<std::string>& texts) {
    std::vector<ShardManifest> shards;
    for (const std::string& text : texts) {
      auto manifest = parse_manifest(text);
      if (!manifest) return manifest.error().message();
      shards.push_back({"shard-" + std::to_string(shards.size()), std::move(*manifest)});
    }
    const auto all = merge_shards(std::move(shards));
    if (!all) return all.error().message();
    return manifest_json(all->results, all->program, all->settings, all->exit_code);
  }

  std::vector<JobResult> results_;
  std::vector<Job> jobs_;
};

TEST_F(MergeTest, AllShardsInAnyOrderAreTheWholeBatchToTheByte) {
  EXPECT_EQ(merged({shard(1), shard(2), shard(3)}), whole());
  EXPECT_EQ(merged({shard(3), shard(1), shard(2)}), whole());
  EXPECT_EQ(merged({shard(1, kWeights, 1)}), whole());
  std::vector<std::string> many;  // most of them with no file
  for (std::uint32_t i = 1; i <= 20; ++i) many.push_back(shard(i, kWeights, 20));
  EXPECT_EQ(merged(many), whole());
}

TEST_F(MergeTest, AManifestReadAgainIsTheOneThatWasWritten) {
  const auto manifest = parse_manifest(whole());
  ASSERT_TRUE(manifest) << manifest.error().message();
  EXPECT_FALSE(manifest->shard);
  EXPECT_EQ(manifest->exit_code, 3);
  EXPECT_EQ(manifest_json(manifest->results, manifest->program, manifest->settings, manifest->exit_code), whole());
  const auto part = parse_manifest(shard(2));
  ASSERT_TRUE(part && part->shard);
  EXPECT_EQ(part->shard->shard.index, 2U);
  EXPECT_EQ(manifest_json(part->results, part->program, part->settings, part->exit_code, &*part->shard), shard(2));
}

TEST_F(MergeTest, AnAssetTellsItsSettingsTypedAndWhoSaidThem) {
  const auto root = scene::parse_json(whole());
  ASSERT_TRUE(root) << root.error().message();
  EXPECT_EQ(root->find("version")->index(), 2U);
  const scene::Json& asset = root->items("assets")[0];
  const scene::Json& values = *asset.find("settings")->find("values");
  EXPECT_EQ(values.object()->size(), kSettingCount);
  EXPECT_EQ(values.find("cluster-triangles")->index(), 64U);
  EXPECT_EQ(std::get<bool>(values.find("repair")->value), true);
  EXPECT_EQ(values.find("keep")->array()->size(), 2U);
  EXPECT_EQ(*values.find("uv-error")->string(), "0.25px");
  EXPECT_EQ(*values.find("error-tier")->string(), "qem") << "what the preset makes of auto";
  const scene::Json& from = *asset.find("settings")->find("from");
  EXPECT_EQ(*from.find("keep")->string(), "in/meshlode.json");
  EXPECT_EQ(*from.find("error-tier")->string(), "the command line");
  EXPECT_EQ(from.find("codec"), nullptr);
  EXPECT_EQ(asset.find("settings")->items("mesh_rules")[0].find("values")->find("position-error")->number(), 1e-5);
}

TEST_F(MergeTest, VersionOneIsReadAndALaterOneIsNot) {
  const std::string hash = "\"0123456789abcdef0123456789abcdef\"";
  const std::string asset = R"({"input": "a.glb", "output": "a.lode", "status": "built", "exit_code": 0, "error": null,
    "hash": )" + hash + R"(, "bytes": 7, "seconds": 1.5, "warnings": [], "files": []})";
  const std::string head = R"({"generator": "meshlode 0.1.0", "program": )" + hash;
  const std::string tail = R"(, "settings": {"codec": "strips"}, "exit_code": 0, "complete": true, "assets": [)";
  const auto read = parse_manifest(head + tail + asset + "]}");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->version, 1U);
  ASSERT_EQ(read->results.size(), 1U);
  EXPECT_FALSE(read->results[0].settings);
  EXPECT_EQ(read->results[0].cache, CacheUse::kNone);
  EXPECT_EQ(read->results[0].seconds, 1.5);
  const std::string two = head + R"(, "version": 2, "versions": {})" + tail + asset + "]}";
  EXPECT_EQ(parse_manifest(two).error().where, "/assets/0/settings");
  std::string later = whole();
  later.replace(later.find("\"version\": 2"), 12, "\"version\": 3");
  EXPECT_EQ(parse_manifest(later).error().code, ErrorCode::kUnsupported);
}

TEST_F(MergeTest, WhatIsMissingIsNamed) {
  EXPECT_EQ(merged({shard(1), shard(3)}), "shard 2 of 3 is missing");
  EXPECT_EQ(merged({shard(2)}), "shards 1, 3 of 3 are missing");
  EXPECT_EQ(
      merged({shard(40, kWeights, 100)}),
      "shards 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20 and 79 more of 100 are missing");
  EXPECT_EQ(merged({shard(1), shard(2), shard(3), shard(2)}), "shard-3: shard 2/3 is there twice: shard-1");
}

TEST_F(MergeTest, ShardsOfDifferentBatchesAreNoBatch) {
  EXPECT_EQ(merged({shard(1), shard(2, kWeights, kShards, 2), shard(3)}),
            "shard-1: built by another program than shard-0, or with other libraries");
  EXPECT_EQ(merged({shard(1), shard(2), shard(3, kWeights, kShards, 1, "codec zstd\n")}),
            "shard-2: built with other settings than shard-0");
  EXPECT_EQ(merged({shard(1), shard(2, kWeights, 4), shard(3)}),
            "shard-1: one of another number of shards than shard-0");
  EXPECT_EQ(merged({shard(1), whole()}), "shard-1: no shard's manifest: build wrote it without --shard");
  const std::string first = shard(1);
  jobs_[6].input = "in/another.gltf";
  EXPECT_EQ(merged({first, shard(2), shard(3)}),
            "shard-1: of another batch than shard-0, or files came or went between the two");
}

// A file grew between two shards, so that each cut the batch in its own way.
TEST_F(MergeTest, AFileInTwoShardsOrInNoneIsFound) {
  const std::vector<std::uint64_t> grown{7, 6, 5, 4, 3, 2, 100};
  std::size_t refused = 0;
  for (std::uint32_t i = 1; i <= kShards; ++i) {
    std::vector<std::string> texts{shard(1), shard(2), shard(3)};
    texts[i - 1] = shard(i, grown, kShards);
    const std::string said = merged(texts);
    refused += said.ends_with("; inputs or --shard-costs changed between shards: build all of them again") ? 1 : 0;
  }
  EXPECT_EQ(refused, kShards);
}

TEST_F(MergeTest, WhatNamesOtherFilesThanTheBatchHadIsRefused) {
  std::string text = shard(2);
  const std::size_t at = text.find("\"output\": \"out/") + 15;
  text[at] = 'z';
  EXPECT_EQ(merged({shard(1), text, shard(3)}),
            "the files of the shards are not those of their batch: a manifest was edited, or a name is not UTF-8");
}

TEST_F(MergeTest, WhatAnotherVersionWroteIsNotRewritten) {
  std::string text = shard(1, kWeights, 1);
  const std::size_t at = text.find("\"generator\": \"") + 14;
  text.insert(at, "not ");
  EXPECT_NE(merged({text}).find("shard-0: written by not "), std::string::npos) << merged({text});
}

TEST_F(MergeTest, ContradictionsAreRefusedWithTheirPlace) {
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = shard(1);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const auto manifest = parse_manifest(text);
    return manifest ? std::string() : manifest.error().where;
  };
  EXPECT_EQ(refused("\"status\": \"built\"", "\"status\": \"would_build\""), "/assets/0/status");
  EXPECT_EQ(refused("\"status\": \"built\"", "\"status\": \"failed\""), "/assets/0/exit_code");
  EXPECT_EQ(refused("\"position\": 0", "\"position\": 7"), "/assets/0/position");
  EXPECT_EQ(refused("\"position\": 5", "\"position\": 0"), "/assets/1/position");
  EXPECT_EQ(refused("\"index\": 1", "\"index\": 4"), "/shard/index");
  EXPECT_EQ(refused("\"index\": 1", "\"index\": 0"), "/shard/index");
  EXPECT_EQ(refused("\"count\": 3", "\"count\": 1e300"), "/shard/count");
  EXPECT_EQ(refused("\"files\": 7", "\"files\": -7"), "/shard/files");
  EXPECT_EQ(refused("\"kind\": \"image\"", "\"kind\": \"picture\""), "/assets/0/kind");
  EXPECT_EQ(refused("\"codec\": \"strips\"", "\"codec\": 5"), "/settings");
  EXPECT_EQ(refused("\"assets\": [", "\"assets\": [1,"), "/assets");
  EXPECT_EQ(refused("\"exit_code\": 0", "\"exit_code\": 6"), "/exit_code");
}

// Any bytes: an error or a manifest, under sanitizers in tools/test.sh.
TEST_F(MergeTest, HostileBytesAreAnErrorOrAManifest) {
  const std::string sound = shard(1, kWeights, 1);
  ASSERT_EQ(merged({sound}), whole());
  for (std::size_t length = 0; length + 1 < sound.size(); length += 7) {
    EXPECT_FALSE(parse_manifest(std::string_view(sound).substr(0, length))) << length;
  }
  std::mt19937 random(20);
  std::size_t refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string text = sound;
    for (auto n = 1 + random() % 3; n > 0; --n) text[random() % text.size()] = static_cast<char>(random());
    const auto manifest = parse_manifest(text);
    if (!manifest) {
      ++refused;
    } else {
      static_cast<void>(merge_shards({{"one", *manifest}}));
    }
  }
  EXPECT_GT(refused, 1000U);
  EXPECT_FALSE(parse_manifest("[]"));
  EXPECT_FALSE(parse_manifest("{\"assets\": {}}"));
}

TEST(Assets, AreWhatTheirManifestTells) {
  const BatchFolder folder;
  const std::string bytes = "an asset";
  JobResult r;
  r.job = {"in/a.gltf", folder.write("a.lode", bytes)};
  r.status = JobStatus::kBuilt;
  r.facts.bytes = bytes.size();
  r.asset_hash = hash128({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  EXPECT_TRUE(check_assets({r}));
  folder.write("a.lode", "AN ASSET");
  EXPECT_FALSE(check_assets({r}));
  std::filesystem::remove(folder.path("a.lode"));
  const auto gone = check_assets({r});
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::kCheckFailed);
  r.status = JobStatus::kFailed;
  EXPECT_TRUE(check_assets({r}));
}

TEST_F(MergeTest, AShardThatWasInterruptedIsRefused) {
  const ShardPlan plan = plan_shard(jobs_, kWeights, {2, kShards});
  std::vector<JobResult> mine;
  for (const std::uint64_t position : plan.positions) {
    JobResult& r = mine.emplace_back();
    r.job = jobs_[position];
    r.error = "interrupted";
  }
  const std::string text = manifest_json(mine, hash_of(1), kSettings, 2, &plan, false);
  const auto manifest = parse_manifest(text);
  ASSERT_TRUE(manifest) << manifest.error().message();
  EXPECT_FALSE(manifest->is_complete);
  EXPECT_EQ(manifest->exit_code, 2);
  EXPECT_NE(merged({shard(1), text, shard(3)}).find("shard 2/3 was interrupted"), std::string::npos);
}

}  // namespace
}  // namespace meshlode::app
