// SPDX-License-Identifier: GPL-3.0-or-later
// Layers through the whole build: what is seen stays in front, and nothing else changes.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "base/parallel.h"
#include "builder/builder.h"
#include "builder/store/mesh_store.h"
#include "judge/verify/id_rule.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"
#include "run/unpack/content_hash.h"
#include "scene/import/gltf_builder.h"

namespace meshlode::testing {
namespace {

using builder::PipelineOptions;

scene::Scene import_bytes(const std::vector<std::uint8_t>& glb) {
  const TempFolder folder;
  auto scene = scene::import_scene(folder.write("scene.glb", std::string(glb.begin(), glb.end())), {});
  EXPECT_TRUE(scene) << describe(scene);
  return scene ? std::move(*scene) : scene::Scene{};
}

scene::Scene layered(const std::string& kind, std::uint64_t seed) {
  return import_bytes(lab::make_layered_file(kind, seed, 40).bytes);
}

std::vector<std::uint8_t> build(const scene::Scene& scene, const PipelineOptions& options = {}) {
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes) << (bytes ? "" : bytes.error().message());
  return bytes ? std::move(*bytes) : std::vector<std::uint8_t>{};
}

PipelineOptions without_layers() {
  PipelineOptions options;
  options.keep_layers = false;
  return options;
}

judge::IdTotals ids_of(const scene::Scene& scene, const PipelineOptions& options) {
  const std::vector<std::uint8_t> bytes = build(scene, options);
  const auto asset = run::Asset::from_bytes(bytes);
  if (!asset) return {};
  judge::RuleLog log;
  return judge::check_ids(*asset, scene, 2, 7, log);
}

TEST(KeepLayers, ATenthAtMostOfThePixelsAndPicturesStillShowsAnotherSurface) {
  std::uint64_t without = 0, with = 0, pictures_without = 0, pictures_with = 0;
  for (const std::string& kind : lab::layered_kinds()) {
    for (const std::uint64_t seed : {101U, 102U}) {  // constants were chosen on others
      const scene::Scene scene = layered(kind, seed);
      const judge::IdTotals before = ids_of(scene, without_layers()), after = ids_of(scene, {});
      without += before.all.astray;
      with += after.all.astray;
      pictures_without += before.beyond_limit;
      pictures_with += after.beyond_limit;
      RecordProperty(kind + std::to_string(seed),
                     std::to_string(before.all.astray) + " > " + std::to_string(after.all.astray));
    }
  }
  EXPECT_GT(pictures_without, 10U);  // else there is nothing to keep
  EXPECT_LE(10 * with, without);
  EXPECT_LE(10 * pictures_with, pictures_without);
}

TEST(KeepLayers, WithoutGapsNoByteChanges) {
  for (const char* name : {"rock.glb", "foliage.glb"}) {
    const scene::Scene scene = import_bytes(lab::make_sample_file(name).bytes);
    const std::vector<std::uint8_t> with = build(scene), without = build(scene, without_layers());
    const auto a = run::Asset::from_bytes(with), b = run::Asset::from_bytes(without);
    ASSERT_TRUE(a && b);
    // All but META, which names the setting where it is off.
    EXPECT_EQ(run::stated_hash(*a), run::stated_hash(*b)) << name;
    EXPECT_EQ(a->meta_json().find("keep_layers"), std::string_view::npos);
    EXPECT_NE(b->meta_json().find("\"keep_layers\":false"), std::string_view::npos);
  }
}

TEST(KeepLayers, NeitherThreadsNorMemoryNorWhoOwnsTheSceneChangesAByte) {
  const scene::Scene scene = layered("coins", 4);
  const std::vector<std::uint8_t> bytes = build(scene);
  EXPECT_EQ(with_threads_at_most(1, [&] { return build(scene); }), bytes);
  PipelineOptions tight;
  for (tight.max_memory = std::uint64_t{1} << 20U; tight.max_memory < (std::uint64_t{1} << 40U);
       tight.max_memory *= 2) {
    builder::PipelineReport report;
    const auto built = builder::build_lode(scene, tight, {}, report);
    if (!built) continue;  // until one mesh at a time has room
    EXPECT_EQ(*built, bytes) << tight.max_memory;
    break;
  }
  scene::Scene owned = scene;
  builder::PipelineReport report;
  const auto freed = builder::build_lode(std::move(owned), {}, {}, report);
  ASSERT_TRUE(freed);
  EXPECT_EQ(*freed, bytes);
}

/// Meshes that were built before, and how often one was found.
class Kept : public builder::MeshStore {
 public:
  [[nodiscard]] bool wants(std::uint64_t) const override { return true; }
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> find(const Hash128& key) override {
    for (const auto& [known, bytes] : entries_) {
      if (known == key) return ++found, bytes;
    }
    return std::nullopt;
  }
  void keep(const Hash128& key, std::vector<std::uint8_t> bytes) override {
    entries_.emplace_back(key, std::move(bytes));
  }
  int found = 0;

 private:
  std::vector<std::pair<Hash128, std::vector<std::uint8_t>>> entries_;
};

TEST(KeepLayers, AMeshIsNotTakenFromACacheWhereItsNeighbourHasMoved) {
  const scene::Scene scene = layered("plate", 5);
  Kept kept;
  PipelineOptions options;
  options.mesh_store = &kept;
  const auto in_turn = [&](const scene::Scene& of) {
    return with_threads_at_most(1, [&] { return build(of, options); });
  };
  const std::vector<std::uint8_t> first = in_turn(scene);
  EXPECT_EQ(kept.found, 0);
  EXPECT_EQ(in_turn(scene), first);
  EXPECT_EQ(kept.found, 2);
  scene::Scene moved = scene;
  for (scene::SceneInstance& instance : moved.instances) {
    if (instance.mesh.value == 1) instance.transform[3].z += 10.0;
  }
  kept.found = 0;
  const std::vector<std::uint8_t> apart = in_turn(moved);
  EXPECT_EQ(kept.found, 0);  // both had a gap to the other
  EXPECT_EQ(apart, build(moved));
}

TEST(KeepLayers, TheAssetSaysWhichGapsItKeeps) {
  const std::vector<std::uint8_t> bytes = build(layered("decal", 6));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset);
  EXPECT_NE(asset->meta_json().find(": layers"), std::string_view::npos);
}

}  // namespace
}  // namespace meshlode::testing
