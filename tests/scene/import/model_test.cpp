// SPDX-License-Identifier: GPL-3.0-or-later
// tinygltf's model of a checked tree says what the tree says: what tinygltf alone would refuse, cut to 32 bits, open or
// leave out does not get lost on the way.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "scene/import/gltf/gltf.h"

namespace meshlode::testing {
namespace {

scene::tinygltf::Model model_of(const std::string& members) {
  const auto root = scene::parse_json("{\"asset\":{\"version\":\"2.0\"}," + members + "}");
  EXPECT_TRUE(root) << members;
  const auto status = scene::check_gltf(*root, "scene.gltf");
  EXPECT_TRUE(status) << members << "\n" << status.error().message();
  auto model = scene::read_gltf_model(*root);
  EXPECT_TRUE(model) << members << "\n" << (model ? "" : model.error().message());
  return model ? std::move(*model) : scene::tinygltf::Model{};
}

TEST(GltfModel, KeepsOffsetsAndLengthsThatNeedMoreThan32Bits) {
  for (const std::uint64_t large : {std::uint64_t{1} << 31U, std::uint64_t{1} << 32U, std::uint64_t{1} << 46U}) {
    const auto model = model_of(
        with_number("\"buffers\":[{\"byteLength\":281474976710655}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":#,"
                    "\"byteLength\":#},{\"buffer\":0,\"byteLength\":281474976710655}],\"accessors\":[{\"bufferView\":1,"
                    "\"byteOffset\":#,\"componentType\":5126,\"count\":1,\"type\":\"VEC3\"}]",
                    std::to_string(large)));
    ASSERT_EQ(model.bufferViews.size(), 2U);
    EXPECT_EQ(model.bufferViews[0].byteOffset, large);
    EXPECT_EQ(model.bufferViews[0].byteLength, large);
    EXPECT_EQ(model.bufferViews[1].byteLength, 281474976710655U);
    ASSERT_EQ(model.accessors.size(), 1U);
    EXPECT_EQ(model.accessors[0].byteOffset, large);
  }
}

TEST(GltfModel, KeepsTheLargestSparseOffsetsAndCounts) {
  const auto model = model_of(
      "\"buffers\":[{\"byteLength\":281474976710655}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":281474976710655}],"
      "\"accessors\":[{\"componentType\":5126,\"count\":2147483647,\"type\":\"SCALAR\",\"sparse\":{\"count\":"
      "2147483647,"
      "\"indices\":{\"bufferView\":0,\"byteOffset\":2147483647,\"componentType\":5125},"
      "\"values\":{\"bufferView\":0,\"byteOffset\":2147483646}}}]");
  ASSERT_EQ(model.accessors.size(), 1U);
  EXPECT_EQ(model.accessors[0].count, 2147483647U);
  EXPECT_EQ(model.accessors[0].sparse.count, 2147483647);
  EXPECT_EQ(model.accessors[0].sparse.indices.byteOffset, 2147483647);
  EXPECT_EQ(model.accessors[0].sparse.values.byteOffset, 2147483646);
}

TEST(GltfModel, ReadsWholeNumbersHoweverTheyAreSpelt) {
  const auto model = model_of(
      "\"buffers\":[{\"byteLength\":100}],\"bufferViews\":[{\"buffer\":-0,\"byteOffset\":4.0,\"byteLength\":4.8e1,"
      "\"byteStride\":12.0}],\"accessors\":[{\"bufferView\":0.0,\"byteOffset\":12.0,\"componentType\":5126.0,"
      "\"count\":3e0,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0.0},\"mode\":5.0}]"
      "}],"
      "\"nodes\":[{\"mesh\":0.0,\"children\":[1.0]},{\"translation\":[1,2.5,3.0]}],\"scenes\":[{\"nodes\":[0.0]},{}],"
      "\"scene\":1.0");
  ASSERT_EQ(model.bufferViews.size(), 1U);
  EXPECT_EQ(model.bufferViews[0].buffer, 0);
  EXPECT_EQ(model.bufferViews[0].byteOffset, 4U);
  EXPECT_EQ(model.bufferViews[0].byteLength, 48U);
  EXPECT_EQ(model.bufferViews[0].byteStride, 12U);
  ASSERT_EQ(model.accessors.size(), 1U);
  EXPECT_EQ(model.accessors[0].bufferView, 0);
  EXPECT_EQ(model.accessors[0].byteOffset, 12U);
  EXPECT_EQ(model.accessors[0].componentType, 5126);
  EXPECT_EQ(model.accessors[0].count, 3U);
  ASSERT_EQ(model.meshes.at(0).primitives.size(), 1U);
  EXPECT_EQ(model.meshes[0].primitives[0].attributes.at("POSITION"), 0);
  EXPECT_EQ(model.meshes[0].primitives[0].mode, 5);
  ASSERT_EQ(model.nodes.size(), 2U);
  EXPECT_EQ(model.nodes[0].mesh, 0);
  EXPECT_EQ(model.nodes[0].children, std::vector<int>{1});
  EXPECT_EQ(model.nodes[1].translation, (std::vector<double>{1.0, 2.5, 3.0}));
  EXPECT_EQ(model.scenes.at(0).nodes, std::vector<int>{0});
  EXPECT_EQ(model.defaultScene, 1);
}

TEST(GltfModel, WhatIsAbsentIsMinusOne) {
  const auto model = model_of(
      "\"accessors\":[{\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}],"
      "\"meshes\":[{\"primitives\":[{\"attributes\":{},\"indices\":0},{\"attributes\":{}}]}],\"nodes\":[{}],"
      "\"skins\":[{}],\"animations\":[{\"samplers\":[{\"input\":0,\"output\":0}],"
      "\"channels\":[{\"sampler\":0,\"target\":{\"path\":\"scale\"}},"
      "{\"sampler\":0,\"target\":{\"path\":\"rotation\",\"node\":0}}]}]");
  EXPECT_TRUE(model.bufferViews.empty());
  ASSERT_EQ(model.accessors.size(), 1U);
  EXPECT_EQ(model.accessors[0].bufferView, -1) << "as of indices that Draco holds";
  ASSERT_EQ(model.meshes.at(0).primitives.size(), 2U);
  EXPECT_EQ(model.meshes[0].primitives[0].indices, 0);
  EXPECT_EQ(model.meshes[0].primitives[1].indices, -1);
  EXPECT_EQ(model.meshes[0].primitives[1].material, -1);
  EXPECT_EQ(model.meshes[0].primitives[1].mode, 4) << "triangles";
  EXPECT_EQ(model.nodes.at(0).mesh, -1);
  EXPECT_TRUE(model.skins.at(0).joints.empty());
  ASSERT_EQ(model.animations.at(0).channels.size(), 2U);
  EXPECT_EQ(model.animations[0].channels[0].target_node, -1);
  EXPECT_EQ(model.animations[0].channels[0].target_path, "scale");
  EXPECT_EQ(model.animations[0].channels[1].target_node, 0);
  EXPECT_EQ(model.defaultScene, -1);
}

TEST(GltfModel, NamesNoFilesAndKnowsNoExtensions) {
  const auto model = model_of(
      "\"buffers\":[{\"byteLength\":4,\"uri\":\"/etc/hostname\"}],\"images\":[{\"uri\":\"/etc/hostname\"}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteLength\":4,\"extensions\":{\"ACME_x\":{\"n\":4294967297}}}],"
      "\"nodes\":[{\"extras\":{\"n\":4294967297}}],\"extensions\":{\"ACME_x\":{}}");
  EXPECT_TRUE(model.buffers.empty());
  EXPECT_TRUE(model.images.empty());
  EXPECT_TRUE(model.extensions.empty());
  EXPECT_TRUE(model.bufferViews.at(0).extensions.empty());
  EXPECT_FALSE(model.nodes.at(0).extras.IsObject());
}

TEST(GltfModel, KeepsAttributesOfAnyName) {
  const auto model = model_of(
      "\"accessors\":[{\"componentType\":5126,\"count\":1,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{"
      "\"attributes\":{\"extras\":0,\"extensions\":0},\"targets\":[{\"extras\":0}],\"extras\":7}]}]");
  ASSERT_EQ(model.meshes.at(0).primitives.size(), 1U);
  EXPECT_EQ(model.meshes[0].primitives[0].attributes.size(), 2U);
  EXPECT_EQ(model.meshes[0].primitives[0].targets.at(0).size(), 1U);
  EXPECT_FALSE(model.meshes[0].primitives[0].extras.IsNumber());
}

}  // namespace
}  // namespace meshlode::testing
