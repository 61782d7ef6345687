// SPDX-License-Identifier: GPL-3.0-or-later
#include "stored_seeds.h"

#include <array>
#include <map>
#include <mutex>
#include <optional>

#include "app/batch/cache/ingredients.h"
#include "app/batch/cache/record.h"
#include "app/batch/shard/partition.h"
#include "app/batch/tell/tell.h"
#include "builder/builder.h"
#include "builder/store/mesh_store.h"
#include "support/sample_asset.h"

namespace meshlode::fuzz {

namespace {

using Bytes = std::vector<std::uint8_t>;

class MemoryStore : public builder::MeshStore {
 public:
  [[nodiscard]] bool wants(std::uint64_t /*triangles*/) const override { return true; }
  std::optional<Bytes> find(const Hash128& /*key*/) override { return std::nullopt; }
  void keep(const Hash128& key, Bytes bytes) override {
    const std::lock_guard lock(mutex_);
    entries[key] = std::move(bytes);
  }
  std::map<Hash128, Bytes> entries;

 private:
  std::mutex mutex_;
};

std::map<Hash128, Bytes> stored_meshes() {
  MemoryStore store;
  builder::PipelineOptions options;
  options.mesh_store = &store;
  builder::PipelineReport report;
  static_cast<void>(builder::build_lode(test::sample_scene(), options, {}, report));
  return store.entries;
}

Bytes behind(Bytes prefix, const std::string& text) {
  prefix.insert(prefix.end(), text.begin(), text.end());
  return prefix;
}

std::vector<app::Dependency> sample_files() {
  const app::FileStamp stamp{{}, 100, 0, 0};
  return {{app::FileKind::kScene, "", "in/a.gltf", stamp, {1}},
          {app::FileKind::kBuffer, "a.bin", "in/a.bin", stamp, {2}},
          {app::FileKind::kImage, "a.png", "in/a.png", std::nullopt, {}}};
}

std::vector<app::JobResult> sample_results() {
  std::vector<app::JobResult> results(2);
  results[0].job = {"in/a.gltf", "out/a.lode"};
  results[0].status = app::JobStatus::kBuilt;
  results[0].facts.bytes = 1000;
  results[0].asset_hash.fill(7);
  results[0].files = sample_files();
  app::SettingLayer layer{"meshlode.json", ErrorCode::kInvalid, {}, {}};
  layer[app::Setting::kKeep] = "NORMAL,COLOR_0";
  layer.mesh_rules.push_back({"rock*", layer.words});
  results[0].settings = app::effective_settings(*app::settle({&layer, 1}), {&layer, 1});
  results[0].cache = app::CacheUse::kMiss;
  results[0].reason = "not built before";
  results[1].job = {"in/b.gltf", "out/b.lode"};
  results[1].status = app::JobStatus::kFailed;
  results[1].exit_code = 3;
  results[1].error = "in/b.gltf: /accessors/0: broken";
  return results;
}

std::string manifest_of(std::vector<app::JobResult> results, std::uint32_t shards) {
  const std::string settings = "codec strips\npreset fast\n";
  if (shards == 0) return app::manifest_json(results, {1}, settings, 3);
  const std::vector<app::Job> jobs{results[0].job, results[1].job};
  const app::ShardPlan plan = app::plan_shard(jobs, std::array<std::uint64_t, 2>{2, 1}, {1, shards});
  results.resize(plan.positions.size());
  return app::manifest_json(results, {1}, settings, results.size() == 2 ? 3 : 0, &plan);
}

}  // namespace

std::vector<std::pair<std::string, Bytes>> make_stored_seeds() {
  std::vector<std::pair<std::string, Bytes>> seeds;
  const auto files = sample_files();
  const std::string ingredients = app::ingredients_text({1}, "codec strips\npreset fast\n", files);
  app::AssetRecord record{ingredients, {3}, {}};
  record.facts.bytes = 1000;
  record.facts.left_out = {{"image 0", "cannot be opened"}};
  record.facts.losses = {{"uv set 1", "nothing uses it"}};
  Bytes bytes{0};
  const Bytes stored = app::record_bytes(record);
  bytes.insert(bytes.end(), stored.begin(), stored.end());
  seeds.emplace_back("record", bytes);

  std::uint8_t codec = 0;
  for (const auto& [key, mesh] : stored_meshes()) {
    Bytes seed{1, codec};
    seed.insert(seed.end(), mesh.begin(), mesh.end());
    seeds.emplace_back("mesh-" + std::to_string(codec++), seed);
  }
  for (std::uint32_t shards = 0; shards < 3; ++shards) {
    seeds.emplace_back("manifest-" + std::to_string(shards), behind({2}, manifest_of(sample_results(), shards)));
  }
  seeds.emplace_back("settings", behind({3}, R"({"codec": "zstd", "preset": "fast", "keep": ["NORMAL"], "grid": 0.001,
 "meshes": {"rock*": {"normal-error": 0.5, "drop": "COLOR_0"}, "*": {"uv-error": 0.01}}})"));
  const std::string other = app::ingredients_text({2}, "codec none\n", std::span(files).first(2));
  seeds.emplace_back("changes", behind({4, static_cast<std::uint8_t>(ingredients.size()),
                                        static_cast<std::uint8_t>(ingredients.size() >> 8U)},
                                       ingredients + other));
  return seeds;
}

}  // namespace meshlode::fuzz
