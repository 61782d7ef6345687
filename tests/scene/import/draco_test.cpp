// SPDX-License-Identifier: GPL-3.0-or-later
// KHR_draco_mesh_compression: right where it is right, and never believed where the counts disagree.
#include "draco_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <string>

#include "gltf_builder.h"
#include "scene/import/gltf/draco_decode.h"

namespace meshlode::testing {
namespace {

scene::DracoExpectation expectation(const DracoSample& s) {
  return {s.point_count, s.face_count, true, {s.position_id, s.normal_id, s.uv_id}};
}

/// Corners by their places, rotated so that the smallest comes first.
using Places = std::array<std::array<long, 2>, 3>;

std::map<Places, std::array<std::uint32_t, 3>> triangles_by_place(const scene::Primitive& p) {
  std::map<Places, std::array<std::uint32_t, 3>> out;
  for (std::size_t t = 0; t < p.indices.size(); t += 3) {
    std::array<std::uint32_t, 3> corners{p.indices[t], p.indices[t + 1], p.indices[t + 2]};
    const auto place = [&](std::uint32_t v) {
      return std::array{std::lround(p.positions[v].x), std::lround(p.positions[v].y)};
    };
    std::rotate(corners.begin(),
                std::min_element(corners.begin(), corners.end(),
                                 [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); }),
                corners.end());
    EXPECT_TRUE(out.try_emplace({place(corners[0]), place(corners[1]), place(corners[2])}, corners).second);
  }
  return out;
}

void expect_same_triangles(const scene::Primitive& packed, const scene::Primitive& plain, int bits,
                           std::size_t face_count) {
  // A value moves by half a step of (largest - smallest) / (2^bits - 1); a little is added for floats.
  const double step = bits == 0 ? 0.0 : 1.0 / ((1 << bits) - 1);
  const double positions = 0.51 * 20.0 * step;
  const double uvs = 0.51 * 2.0 * step;
  const double normals = bits == 0 ? 1e-6 : 4.0 * step;  // octahedral: both coordinates of -1 … 1, stretched
  const auto ours = triangles_by_place(packed);
  const auto theirs = triangles_by_place(plain);
  ASSERT_EQ(ours.size(), face_count);
  ASSERT_EQ(theirs.size(), face_count);
  for (const auto& [place, corners] : ours) {
    const auto found = theirs.find(place);
    ASSERT_NE(found, theirs.end()) << place[0][0] << " " << place[0][1];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[k];
      const std::uint32_t b = found->second[k];
      ASSERT_LE(glm::length(packed.positions[a] - plain.positions[b]), 1.8 * positions);
      ASSERT_LE(glm::length(Vec3d(packed.normals[a]) - Vec3d(plain.normals[b])), normals);
      for (const std::size_t set : {0U, 1U}) {
        ASSERT_LE(glm::length(glm::dvec2(packed.uvs[set][a]) - glm::dvec2(plain.uvs[set][b])), 1.5 * uvs) << set;
      }
      ASSERT_EQ(packed.colors[a], plain.colors[b]);
    }
  }
}

TEST(ImportDraco, BothMethodsDecodeToWhatDracosOwnDecoderGives) {
  const TempFolder folder;
  for (const bool edgebreaker : {true, false}) {
    for (const int speed : {0, 5, 10}) {
      for (const int bits : {0, 11}) {
        const DracoSample sample = make_draco_sample(6, edgebreaker, speed, bits);
        const auto scene = scene::import_scene(folder.write("scene.glb", make_draco_glb(sample)), {});
        ASSERT_TRUE(scene) << describe(scene);
        const scene::Primitive& p = scene->meshes[0].primitives[0];
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

// The second opinion: the plain file of the same mesh, read without Draco. A triangle is found by its corners' places,
// which are whole numbers, and every attribute of its corners must be the plain one within what quantization may move.
TEST(ImportDraco, TheTrianglesAndAllTheirAttributesAreThoseOfTheSameMeshStoredPlain) {
  const TempFolder folder;
  for (const bool edgebreaker : {true, false}) {
    for (const int speed : {0, 3, 5, 8, 10}) {
      for (const int bits : {0, 8, 14}) {
        SCOPED_TRACE(std::string(edgebreaker ? "edgebreaker" : "sequential") + ", speed " + std::to_string(speed) +
                     ", " + std::to_string(bits) + " bits");
        const DracoPair pair = make_draco_pair(9, edgebreaker, speed, bits);
        const auto plain = scene::import_scene(folder.write("plain.glb", pair.plain_glb), {});
        const auto packed = scene::import_scene(folder.write("packed.glb", pair.draco_glb), {});
        ASSERT_TRUE(plain) << describe(plain);
        ASSERT_TRUE(packed) << describe(packed);
        EXPECT_LT(packed->meshes[0].primitives[0].positions.size(), plain->meshes[0].primitives[0].positions.size());
        expect_same_triangles(packed->meshes[0].primitives[0], plain->meshes[0].primitives[0], bits, pair.face_count);
      }
    }
  }
}

TEST(ImportDraco, CountsThatDisagreeWithTheAccessorsAreRefusedBeforeDecoding) {
  const DracoSample sample = make_draco_sample(4, true, 5, 11);
  ASSERT_TRUE(scene::decode_draco(sample.bytes, expectation(sample)));
  scene::DracoExpectation wrong = expectation(sample);
  wrong.point_count -= 1;
  EXPECT_FALSE(scene::decode_draco(sample.bytes, wrong));
  wrong = expectation(sample);
  wrong.max_face_count -= 1;
  EXPECT_FALSE(scene::decode_draco(sample.bytes, wrong));
  wrong = expectation(sample);
  wrong.attribute_ids = {77};
  EXPECT_FALSE(scene::decode_draco(sample.bytes, wrong));
}

TEST(ImportDraco, EveryTruncationIsAnError) {
  for (const bool edgebreaker : {true, false}) {
    const DracoSample sample = make_draco_sample(3, edgebreaker, 5, 11);
    for (std::size_t size = 0; size + 1 < sample.bytes.size(); ++size) {
      const auto mesh = scene::decode_draco(std::span(sample.bytes).first(size), expectation(sample));
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
    const auto mesh = scene::decode_draco(bytes, expectation(sample));
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
      EXPECT_FALSE(scene::decode_draco(bytes, expectation(sample))) << at << " " << value;
    }
  }
}

// An attribute beside the compressed ones is checked once a primitive; many primitives may name the same one.
TEST(ImportDraco, SparseAttributesBesideItCountAgainstTheBudget) {
  const DracoSample sample = make_draco_sample(3, true, 5, 11);
  constexpr std::uint32_t kSparse = 100000;
  std::vector<std::uint32_t> indices(kSparse);
  std::iota(indices.begin(), indices.end(), 0U);
  GltfBuilder b;
  b.view(sample.bytes);
  const int sparse_indices = b.view(indices);
  const int sparse_values = b.view(std::vector<std::uint8_t>(kSparse));
  b.accessor(-1, 5126, sample.point_count, "VEC3");
  b.accessor(-1, 5125, 3 * std::size_t{sample.face_count}, "SCALAR");
  b.accessor(-1, 5121, kSparse, "SCALAR",
             ",\"sparse\":{\"count\":100000,\"indices\":{\"componentType\":5125,\"bufferView\":" +
                 std::to_string(sparse_indices) + "},\"values\":{\"bufferView\":" + std::to_string(sparse_values) +
                 "}}");
  for (const int count : {1, 60}) {
    std::string primitives;
    for (int i = 0; i < count; ++i) {
      primitives += std::string(i == 0 ? "" : ",") +
                    "{\"attributes\":{\"POSITION\":0,\"_X\":2},\"indices\":1,\"extensions\":{"
                    "\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":" +
                    std::to_string(sample.position_id) + "}}}}";
    }
    const auto scene = b.import("\"meshes\":[{\"primitives\":[" + primitives + "]}]");
    EXPECT_EQ(scene.ok(), count == 1) << describe(scene);
    if (!scene) {
      EXPECT_NE(scene.error().detail.find("size of the file"), std::string::npos) << describe(scene);
    }
  }
}

}  // namespace
}  // namespace meshlode::testing
