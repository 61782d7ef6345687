// SPDX-License-Identifier: GPL-3.0-or-later
// KHR_draco_mesh_compression: right where it is right, and never believed where the counts disagree.
#include "draco_samples.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>

#include "gltf_builder.h"
#include "import/draco_decode.h"

namespace meshlode::testing {
namespace {

DracoExpectation expectation(const DracoSample& s) {
  return {s.point_count, s.face_count, true, {s.position_id, s.normal_id, s.uv_id}};
}

TEST(ImportDraco, BothMethodsDecodeToWhatDracosOwnDecoderGives) {
  const TempFolder folder;
  for (const bool edgebreaker : {true, false}) {
    for (const int speed : {0, 5, 10}) {
      for (const int bits : {0, 11}) {
        const DracoSample sample = make_draco_sample(6, edgebreaker, speed, bits);
        const auto scene = import_scene(folder.write("scene.glb", make_draco_glb(sample)), {});
        ASSERT_TRUE(scene) << describe(scene);
        const Primitive& p = scene->meshes[0].primitives[0];
        ASSERT_EQ(p.positions.size(), sample.point_count);
        EXPECT_EQ(p.indices.size(), 3U * sample.face_count);
        for (std::size_t i = 0; i < p.positions.size(); ++i) {
          ASSERT_EQ(p.positions[i],
                    Vec3d(sample.positions[3 * i], sample.positions[3 * i + 1], sample.positions[3 * i + 2]));
        }
        EXPECT_NEAR(p.normals[0].z, 1.0F, 0.02F);
        EXPECT_EQ(p.uvs[0].size(), p.positions.size());
      }
    }
  }
}

TEST(ImportDraco, CountsThatDisagreeWithTheAccessorsAreRefusedBeforeDecoding) {
  const DracoSample sample = make_draco_sample(4, true, 5, 11);
  ASSERT_TRUE(decode_draco(sample.bytes, expectation(sample)));
  DracoExpectation wrong = expectation(sample);
  wrong.point_count -= 1;
  EXPECT_FALSE(decode_draco(sample.bytes, wrong));
  wrong = expectation(sample);
  wrong.max_face_count -= 1;
  EXPECT_FALSE(decode_draco(sample.bytes, wrong));
  wrong = expectation(sample);
  wrong.attribute_ids = {77};
  EXPECT_FALSE(decode_draco(sample.bytes, wrong));
}

TEST(ImportDraco, EveryTruncationIsAnError) {
  for (const bool edgebreaker : {true, false}) {
    const DracoSample sample = make_draco_sample(3, edgebreaker, 5, 11);
    for (std::size_t size = 0; size + 1 < sample.bytes.size(); ++size) {
      const auto mesh = decode_draco(std::span(sample.bytes).first(size), expectation(sample));
      if (mesh) {
        // Draco may not read its last bytes; what it gives must still be whole.
        EXPECT_EQ(mesh->indices.size(), 3U * sample.face_count);
      }
    }
  }
}

// Guards against Draco 1.5.5 believing the count of texture coordinate flags: four bytes made it loop for seconds.
TEST(ImportDraco, AHugeCountAtAnyPlaceIsRefusedAtOnce) {
  const DracoSample sample = make_draco_sample(4, true, 0, 11);
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t at = 11; at + 4 <= sample.bytes.size(); ++at) {
    auto bytes = sample.bytes;
    const std::uint32_t huge = 0x7FFFFFFFu;
    std::memcpy(bytes.data() + at, &huge, 4);
    const auto mesh = decode_draco(bytes, expectation(sample));
    if (mesh) {
      EXPECT_EQ(mesh->point_count, sample.point_count);
    }
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
}

TEST(ImportDraco, AForeignVersionMethodOrTypeIsRefused) {
  const DracoSample sample = make_draco_sample(3, true, 5, 11);
  for (const std::size_t at : {0U, 5U, 6U, 7U, 8U}) {
    for (const int value : {0, 1, 2, 3, 255}) {
      auto bytes = sample.bytes;
      if (bytes[at] == value) continue;
      if (at == 8 && value == 0) continue;  // the sequential decoder reads other counts there
      bytes[at] = static_cast<std::uint8_t>(value);
      EXPECT_FALSE(decode_draco(bytes, expectation(sample))) << at << " " << value;
    }
  }
}

}  // namespace
}  // namespace meshlode::testing
