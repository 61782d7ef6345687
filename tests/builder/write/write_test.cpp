// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/write/write.h"

#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "base/hash.h"
#include "builder/pack/pack.h"
#include "format/section_columns.h"
#include "run/decode/decode.h"
#include "run/unpack/content_hash.h"
#include "support/random.h"
#include "support/sample_asset.h"

namespace meshlode::builder {
namespace {

constexpr format::Codec kCodecs[] = {format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd,
                                     format::Codec::kStrips, format::Codec::kDraco};

WriteInput patch_input(const scene::Scene& scene) {
  const test::SampleMesh sample = test::sample_patch();
  WriteInput input;
  input.meshes.push_back(*encode_mesh(sample.mesh, sample.dag, sample.hierarchy, {}));
  input.mesh_names.emplace_back("patch");
  input.scene = &scene;
  input.meta_json = "{}";
  return input;
}

scene::Scene one_instance_scene() {
  scene::Scene scene = test::sample_scene();
  scene.instances.resize(1);
  return scene;
}

Hash128 content_hash(const std::vector<std::uint8_t>& bytes) {
  Hash128 hash{};
  std::memcpy(hash.data(), reinterpret_cast<const format::FileHeader*>(bytes.data())->content_hash, hash.size());
  return hash;
}

TEST(Write, CarriesTheSceneThrough) {
  const scene::Scene scene = test::sample_scene();
  for (const format::Codec codec : kCodecs) {
    const auto asset = run::Asset::from_vector(test::sample_asset_bytes(codec));
    ASSERT_TRUE(asset.ok()) << asset.error().message();
    EXPECT_EQ(asset->scene_json(), scene.document);
    EXPECT_EQ(asset->meta_json(), R"({"source":{"file":"sample.glb"},"settings":{}})");
    ASSERT_EQ(asset->materials().size(), scene.materials.size());
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
      const format::MaterialRecord& material = asset->materials()[i];
      EXPECT_EQ(asset->string(material.name), scene.materials[i].name);
      EXPECT_EQ(material.alpha_cutoff, scene.materials[i].alpha_cutoff);
      EXPECT_EQ(static_cast<int>(material.alpha_mode), static_cast<int>(scene.materials[i].alpha_mode));
      EXPECT_EQ(material.double_sided != 0, scene.materials[i].double_sided);
      EXPECT_EQ(material.base_color_texture, scene.materials[i].base_color_texture);
    }
    ASSERT_EQ(asset->instances().size(), scene.instances.size());
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const format::InstanceRecord& instance = asset->instances()[i];
      EXPECT_EQ(asset->string(instance.name), scene.instances[i].name);
      EXPECT_EQ(instance.mesh, scene.instances[i].mesh.value);
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
          EXPECT_EQ(instance.transform[4 * row + column], scene.instances[i].transform[column][row]);
        }
      }
    }
    ASSERT_EQ(asset->blobs().size(), scene.blobs.size());
    for (std::size_t i = 0; i < scene.blobs.size(); ++i) {
      const auto bytes = asset->blob_bytes(asset->blobs()[i]);
      EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), scene.blobs[i].bytes.begin(), scene.blobs[i].bytes.end()));
      EXPECT_EQ(asset->string(asset->blobs()[i].mime_type), scene.blobs[i].mime_type);
      EXPECT_EQ(asset->blobs()[i].checksum, hash64(scene.blobs[i].bytes));
    }
  }
}

TEST(Write, StoresEqualStringsOnce) {
  const auto asset = run::Asset::from_vector(test::sample_asset_bytes());
  ASSERT_TRUE(asset.ok());
  EXPECT_EQ(asset->blobs()[0].name.offset, asset->blobs()[1].name.offset);
}

TEST(Write, SameBytesForAnyNumberOfThreads) {  // I10
  for (const format::Codec codec : kCodecs) {
    std::vector<std::vector<std::uint8_t>> files;
    for (const int threads : {1, 2, 4}) {
      tbb::task_arena arena(threads);
      arena.execute([&] { files.push_back(test::sample_asset_bytes(codec)); });
    }
    EXPECT_EQ(files[0], files[1]);
    EXPECT_EQ(files[0], files[2]);
  }
}

TEST(Write, ContentHashKnowsTheContentAndNotTheCodec) {
  const auto plain = test::sample_asset_bytes();
  for (const format::Codec codec : kCodecs) {
    const auto bytes = test::sample_asset_bytes(codec);
    EXPECT_EQ(content_hash(bytes), content_hash(plain));
    const auto asset = run::Asset::from_vector(bytes);
    ASSERT_TRUE(asset.ok()) << asset.error().message();
    const auto again = run::hash_asset_content(*asset);
    ASSERT_TRUE(again.ok()) << again.error().message();
    EXPECT_EQ(*again, content_hash(bytes)) << "reader and writer agree on the definition";
  }
}

TEST(Write, ContentHashSeesEveryPartOfTheContent) {
  const scene::Scene base = one_instance_scene();
  const Hash128 hash = content_hash(*write_asset(patch_input(base)));
  {
    WriteInput input = patch_input(base);
    input.meta_json = R"({"settings":{"grid":"auto"}})";
    EXPECT_EQ(content_hash(*write_asset(std::move(input))), hash) << "META is about the making, not the content";
  }
  const auto changed = [&](void (*change)(scene::Scene&)) {
    scene::Scene scene = base;
    change(scene);
    return content_hash(*write_asset(patch_input(scene)));
  };
  EXPECT_NE(changed([](scene::Scene& s) { s.document = "{}"; }), hash);
  EXPECT_NE(changed([](scene::Scene& s) { s.materials[1].alpha_cutoff = 0.75F; }), hash);
  EXPECT_NE(changed([](scene::Scene& s) { s.instances[0].name = "another"; }), hash);
  EXPECT_NE(changed([](scene::Scene& s) { s.instances[0].transform[3][0] += 1.0; }), hash);
  EXPECT_NE(changed([](scene::Scene& s) { s.blobs[0].bytes[3] ^= 1U; }), hash);
  WriteInput input = patch_input(base);
  input.meshes[0].groups.back().error *= 2.0F;
  EXPECT_NE(content_hash(*write_asset(std::move(input))), hash);
  input = patch_input(base);
  input.meshes[0].pages[0].bytes.back() ^= 1U;
  EXPECT_NE(content_hash(*write_asset(std::move(input))), hash);
}

/// Tables of a packed file are stored by columns where that is shorter, and say the same.
TEST(Write, TablesShrinkWhereACodecIsChosen) {
  const auto plain = run::Asset::from_vector(test::sample_asset_bytes());
  ASSERT_TRUE(plain.ok());
  for (const format::SectionEntry& entry : plain->sections()) {
    EXPECT_EQ(entry.codec, static_cast<std::uint32_t>(format::SectionCodec::kPlain));
  }
  const auto packed = run::Asset::from_vector(test::sample_asset_bytes(format::Codec::kZstd));
  ASSERT_TRUE(packed.ok()) << packed.error().message();
  std::size_t packed_count = 0;
  ASSERT_EQ(packed->sections().size(), plain->sections().size());
  for (std::size_t s = 0; s < packed->sections().size(); ++s) {
    const format::SectionEntry& entry = packed->sections()[s];
    const format::SectionEntry& twin = plain->sections()[s];
    if (entry.codec == static_cast<std::uint32_t>(format::SectionCodec::kPlain)) continue;
    ++packed_count;
    EXPECT_LT(entry.bytes, entry.decoded_bytes);
    const auto a = packed->section_bytes(entry);
    const auto b = plain->section_bytes(twin);
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << s;
  }
  EXPECT_GE(packed_count, 3U) << "at least clusters, nodes and the scene";
}

/// A section without bytes begins where the next one does, which may be stored by columns.
TEST(Write, ASectionWithoutBytesIsEmptyWhateverLiesBehindIt) {
  scene::Scene scene;  // no instance, no name
  scene.materials.resize(test::sample_scene().materials.size());
  for (const format::Codec codec : kCodecs) {
    WriteInput input = patch_input(scene);
    input.mesh_names.clear();
    while (input.meshes.size() < 64) input.meshes.push_back(input.meshes[0]);
    input.mesh_names.resize(input.meshes.size());
    const auto bytes = test::write_by(std::move(input), codec);
    const auto asset = run::Asset::from_vector(bytes);
    ASSERT_TRUE(asset.ok()) << asset.error().message();
    EXPECT_TRUE(asset->instances().empty());
    for (const format::SectionEntry& entry : asset->sections()) {
      EXPECT_EQ(asset->section_bytes(entry).size(), entry.decoded_bytes);
    }
    const auto hash = run::hash_asset_content(*asset);
    ASSERT_TRUE(hash.ok());
    EXPECT_EQ(*hash, content_hash(bytes));
  }
}

TEST(Write, AnInstanceOfNoMeshIsRefused) {
  scene::Scene scene = one_instance_scene();
  scene.instances[0].mesh = MeshId{1U};
  const auto bytes = write_asset(patch_input(scene));
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().code, ErrorCode::kBuildFailed);
}

TEST(Write, ASceneWithoutMeshesIsAnAsset) {
  scene::Scene scene;
  WriteInput input;
  input.scene = &scene;
  const auto bytes = write_asset(std::move(input));
  ASSERT_TRUE(bytes.ok());
  const auto asset = run::Asset::from_vector(*bytes);
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  EXPECT_TRUE(asset->meshes().empty() && asset->pages().empty());
}

TEST(Write, SectionsLieAtMultiplesOfSixteenWithZerosBetween) {
  const auto bytes = test::sample_asset_bytes(format::Codec::kZstd);
  const auto asset = run::Asset::from_vector(bytes);
  ASSERT_TRUE(asset.ok());
  EXPECT_EQ(asset->sections().size(), 14U);
  for (const format::SectionEntry& entry : asset->sections()) EXPECT_EQ(entry.offset % 16, 0U);
  for (const format::PageRecord& page : asset->pages()) EXPECT_EQ(page.offset % 16, 0U);
  EXPECT_EQ(asset->header().file_bytes, bytes.size());
}

}  // namespace
}  // namespace meshlode::builder
