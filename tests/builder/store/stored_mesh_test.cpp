// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that were built before: the same bytes as without, and no bytes that are trusted further than they go.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "builder/builder.h"
#include "builder/hooks.h"
#include "builder/store/mesh_key.h"
#include "builder/store/mesh_store.h"
#include "builder/store/stored_mesh.h"
#include "format/names.h"
#include "lab/samples/samples.h"
#include "support/random.h"
#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

class MemoryStore : public MeshStore {
 public:
  [[nodiscard]] bool wants(std::uint64_t /*triangles*/) const override { return true; }
  std::optional<std::vector<std::uint8_t>> find(const Hash128& key) override {
    const std::lock_guard lock(mutex_);
    const auto found = entries.find(key);
    return found == entries.end() ? std::nullopt : std::optional(found->second);
  }
  void keep(const Hash128& key, std::vector<std::uint8_t> bytes) override {
    const std::lock_guard lock(mutex_);
    const auto [entry, is_new] = entries.try_emplace(key, bytes);
    EXPECT_TRUE(is_new || entry->second == bytes);  // equal meshes of a scene are built side by side
  }
  std::map<Hash128, std::vector<std::uint8_t>> entries;

 private:
  std::mutex mutex_;
};

scene::Primitive random_shape(test::Random& random) {
  switch (random.below(5)) {
    case 0: return lab::make_sphere(8);
    case 1: return lab::make_terrain(9, 8, 1 + random.below(3));
    case 2: return lab::make_crystal(3, 2, 1 + random.below(3));
    case 3: return lab::make_foliage(80, 1 + random.below(3));
    default: return lab::make_torus(12, 7);
  }
}

void add_mesh(scene::Scene& scene, test::Random& random) {
  scene::SourceMesh mesh;
  mesh.name = "shape" + std::to_string(scene.meshes.size());
  for (std::uint64_t i = 0; i <= random.below(2); ++i) {
    mesh.primitives.push_back(random_shape(random));
    mesh.primitives.back().material = MaterialId(static_cast<std::uint32_t>(random.below(2)));
  }
  scene.instances.push_back({mesh.name, 0, MeshId(static_cast<std::uint32_t>(scene.meshes.size())), Mat4d(1.0)});
  scene.meshes.push_back(std::move(mesh));
}

/// Three meshes and two materials, one of them textured.
scene::Scene make_scene(test::Random& random) {
  scene::Scene scene;
  scene.materials.resize(2);
  scene.materials[0].uv_sets_used = 1;
  scene.materials[0].textures.push_back({scene::TextureRole::kBaseColor, 0, 0, 0});
  scene.blobs.push_back({scene::SceneBlob::Kind::kImage, "picture", "image/png", 0, {1, 2, 3}});
  for (int i = 0; i < 3; ++i) add_mesh(scene, random);
  return scene;
}

/// One edit of a scene or of the options, as people make them.
void edit(scene::Scene& scene, PipelineOptions& options, test::Random& random) {
  scene::SourceMesh& mesh = scene.meshes[random.below(scene.meshes.size())];
  scene::Primitive& primitive = mesh.primitives[random.below(mesh.primitives.size())];
  switch (random.below(14)) {
    case 0: primitive.positions[random.below(primitive.positions.size())].x += 1e-3; break;
    case 1: primitive.positions[random.below(primitive.positions.size())].y *= -1.0; break;
    case 2: primitive.indices.resize(primitive.indices.size() - 3 * (primitive.indices.size() > 30 ? 1 : 0)); break;
    case 3: primitive.material = MaterialId(static_cast<std::uint32_t>(random.below(scene.materials.size()))); break;
    case 4: primitive.normals.clear(); break;
    case 5: primitive.uvs[0].clear(); break;
    case 6: mesh.name += "'"; break;
    case 7: scene.materials[random.below(2)].base_color.x *= 0.5F; break;
    case 8: scene.materials[random.below(2)].uv_sets_used ^= 1U; break;
    case 9: scene.blobs[0].bytes.push_back(7); break;
    case 10: scene.instances[random.below(scene.instances.size())].transform[3][0] += 1.0; break;
    case 11: options.normal_error = 0.1 * static_cast<double>(1 + random.below(2)); break;
    case 12: options.attributes = random.below(2) == 0 ? AttributeChoice::kAuto : AttributeChoice::kAll; break;
    default:
      if (scene.meshes.size() < 5) add_mesh(scene, random);
  }
}

std::vector<std::uint8_t> build(const scene::Scene& scene, const PipelineOptions& options, std::uint64_t* stored) {
  PipelineReport report;
  const auto bytes = build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes) << bytes.error().message();
  if (stored != nullptr) *stored += report.stored_meshes;
  return bytes ? *bytes : std::vector<std::uint8_t>{};
}

/// Two hundred in all; a sanitized build, ten times slower, tries fewer.
constexpr int kEditsOfASeed = test::kIsSanitized ? 5 : 50;

TEST(StoredMesh, RandomEditsGiveTheBytesOfCleanBuilds) {
  std::uint64_t stored = 0, meshes = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    scene::Scene scene = make_scene(random);
    PipelineOptions options;
    if (seed != 1) options.preset = Preset::kFast, options.error_tier = format::ErrorTier::kQem;
    MemoryStore store;
    for (int i = 0; i < kEditsOfASeed; ++i) {
      PipelineOptions with_store = options;
      with_store.mesh_store = &store;
      const auto with = build(scene, with_store, &stored);
      ASSERT_EQ(with, build(scene, options, nullptr)) << "edit " << i;
      meshes += scene.meshes.size();
      edit(scene, options, random);
    }
  }
  EXPECT_GT(stored, meshes / 2);  // most edits leave most meshes alone
  EXPECT_LT(stored, meshes);
}

TEST(StoredMesh, OnlyTheMeshThatChangedIsBuiltAgain) {
  test::Random random(1);
  scene::Scene scene = make_scene(random);
  MemoryStore store;
  PipelineOptions options;
  options.mesh_store = &store;
  options.keep_layers = false;  // else what stands close to the one that changed may have other gaps: keep_layers_test
  std::uint64_t stored = 0;
  build(scene, options, &stored);
  EXPECT_EQ(stored, 0U);
  EXPECT_EQ(store.entries.size(), 3U);
  scene.meshes[1].primitives[0].positions[0].x += 0.5;
  scene.materials[0].base_color.x = 0.25F;
  scene.blobs[0].bytes = {9, 9};
  scene.instances[0].transform[3][1] = 4.0;
  scene.meshes[2].name = "another";
  build(scene, options, &stored);
  EXPECT_EQ(stored, 2U);
  EXPECT_EQ(store.entries.size(), 4U);
}

TEST(StoredMesh, EveryPartOfAMeshIsInItsKey) {
  scene::SourceMesh mesh;
  mesh.primitives.push_back(lab::make_terrain(4, 4));
  mesh.primitives[0].material = MaterialId(0U);
  mesh.primitives[0].colors.assign(mesh.primitives[0].positions.size(), Vec4f(0.5F));
  std::vector<scene::SourceMesh> meshes(11, mesh);
  meshes[1].primitives[0].positions[3].z = std::nextafter(mesh.primitives[0].positions[3].z, 9.0);
  meshes[2].primitives[0].normals[3].x += 0.1F;
  meshes[3].primitives[0].uvs[0][3].x += 0.1F;
  meshes[4].primitives[0].colors[3].x += 0.1F;
  std::swap(meshes[5].primitives[0].indices[0], meshes[5].primitives[0].indices[1]);
  meshes[6].primitives[0].material = MaterialId(1U);
  meshes[7].primitives.emplace_back();
  meshes[8].drops.repaired = 1;
  std::swap(meshes[9].primitives[0].uvs[0], meshes[9].primitives[0].uvs[1]);
  meshes[10].primitives[0].positions.pop_back();
  std::map<Hash128, std::size_t> keys;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    EXPECT_TRUE(keys.emplace(mesh_key(meshes[i], {}, {}, {}, {}), i).second) << i;
  }
  AttributeLayout layout;
  layout.uv_set_source[1] = 1;
  EXPECT_TRUE(keys.emplace(mesh_key(mesh, layout, {}, {}, {}), 0).second);
  EncodeOptions encode;
  encode.uv_error[3] = 0.5;
  EXPECT_TRUE(keys.emplace(mesh_key(mesh, {}, encode, {}, {}), 0).second);
  PipelineOptions options;
  options.partition_seed = 2;
  EXPECT_TRUE(keys.emplace(mesh_key(mesh, {}, {}, options, options), 0).second);
  options.partition_seed = 1;
  options.keep_topology = true;
  EXPECT_TRUE(keys.emplace(mesh_key(mesh, {}, {}, options, options), 0).second);
  options.keep_topology = false;
  options.lock_borders = true;
  EXPECT_TRUE(keys.emplace(mesh_key(mesh, {}, {}, options, options), 0).second);
  options.lock_borders = false;
  options.aggregate = AggregateChoice::kAlways;
  EXPECT_TRUE(keys.emplace(mesh_key(mesh, {}, {}, options, options), 0).second);
  options.aggregate = AggregateChoice::kNever;
  options.promise = format::Promise::kTexels;
  EXPECT_TRUE(keys.emplace(mesh_key(mesh, {}, {}, options, options), 0).second);
  std::vector<TexelExtents> extents(1);
  extents[0][1] = {1024.0, 512.0};
  EXPECT_TRUE(keys.emplace(mesh_key(mesh, {}, {}, options, options, extents), 0).second);
  options.promise = format::Promise::kPosition;
  BuildHooks hooks;
  options.hooks = &hooks;
  for (const char* record : {"{}", "[]"}) {
    hooks.record = record;
    EXPECT_TRUE(keys.emplace(mesh_key(mesh, {}, {}, options, options), 0).second) << record;
  }
  meshes[0].name = "renamed";
  EXPECT_FALSE(keys.emplace(mesh_key(meshes[0], {}, {}, {}, {}), 0).second);
}

// An entry is hashed before it gets here, but whoever can write into a cache can hash too.
TEST(StoredMesh, HostileBytesAreRefusedOrBuildSomethingWithoutACrash) {
  test::Random random(3);
  scene::Scene scene = make_scene(random);
  MemoryStore store;
  PipelineOptions options;
  options.mesh_store = &store;
  build(scene, options, nullptr);
  const std::vector<std::uint8_t> sound = store.entries.begin()->second;
  const auto whole = read_stored_mesh(sound, "mesh 0");
  ASSERT_TRUE(whole);
  for (std::size_t i = 0; i < sound.size(); i += 1 + i / 64) {
    EXPECT_FALSE(read_stored_mesh(std::span(sound).first(i), "mesh 0")) << i;
  }
  std::uint64_t refused = 0;
  constexpr std::size_t kHeadBytes = sizeof(std::uint32_t) + sizeof(format::MeshRecord);
  for (int i = 0; i < 4000; ++i) {
    std::vector<std::uint8_t> changed = sound;
    // Near the front lie the tables, which ids and counts are in.
    const std::size_t reach = i % 2 == 0 ? std::min<std::size_t>(changed.size(), kHeadBytes + 4096) : changed.size();
    for (std::uint64_t k = 0; k <= random.below(3); ++k) {
      changed[random.below(reach)] = static_cast<std::uint8_t>(random.below(256));
    }
    const auto mesh = read_stored_mesh(changed, "mesh 0");
    refused += mesh ? 0 : 1;
    if (!mesh || i % 8 != 0) continue;
    MemoryStore hostile;
    hostile.entries = store.entries;
    hostile.entries.begin()->second = changed;
    options.mesh_store = &hostile;
    options.codec = format::kWrittenCodecNames[random.below(format::kWrittenCodecNames.size())].value;
    PipelineReport report;
    static_cast<void>(build_lode(scene, options, {}, report));
  }
  EXPECT_GT(refused, 200U) << "most bytes are vertices, of which any are as good";
  std::vector<std::uint8_t> longer = sound;
  longer.push_back(0);
  EXPECT_FALSE(read_stored_mesh(longer, "mesh 0"));
}

TEST(StoredMesh, IdsOutsideTheirTablesAreRefused) {
  test::Random random(4);
  scene::Scene scene = make_scene(random);
  MemoryStore store;
  PipelineOptions options;
  options.mesh_store = &store;
  build(scene, options, nullptr);
  const StoredMesh sound = read_stored_mesh(store.entries.begin()->second, "m").value();
  const auto is_refused = [&](const auto& change) {
    EncodedMesh mesh = sound.encoded;
    change(mesh);
    return !read_stored_mesh(stored_mesh_bytes(mesh, {}, "m"), "m");
  };
  static constexpr std::uint32_t kMax = std::numeric_limits<std::uint32_t>::max();
  EXPECT_FALSE(is_refused([](EncodedMesh&) {}));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.groups[0].page = static_cast<std::uint32_t>(m.pages.size()); }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.groups[0].first_cluster = kMax; }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.groups.back().cluster_count += 1; }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.clusters[0].coarser_group = kMax; }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.clusters[0].own_group = kMax - 1; }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.nodes[0].first = kMax; }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.pages[0].bytes.resize(4); }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.pages[0].bytes.resize(format::kMaxPageBytes + 4); }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.pages[0].bytes.pop_back(); }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.pages[0].cluster_count += 1; }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.pages[0].dependencies.push_back(kMax); }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.record.uv_set_count = 5; }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.record.node_count += 1; }));
  EXPECT_TRUE(is_refused([](EncodedMesh& m) { m.pages.clear(); }));
  // Whose first group would be the one behind the last.
  EXPECT_TRUE(is_refused([](EncodedMesh& m) {
    EncodedMesh::Page page = m.pages.back();
    page.first_group += page.group_count, page.first_cluster += page.cluster_count;
    page.group_count = page.cluster_count = 0;
    m.pages.push_back(page);
  }));
}

}  // namespace
}  // namespace meshlode::builder
