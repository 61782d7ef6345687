// SPDX-License-Identifier: GPL-3.0-or-later
// EXT_meshopt_compression, against meshoptimizer's own encoders: what was put in comes out, and whatever else the bytes
// or the text say is an error with its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/random.h"
#include "gltf_builder.h"
#include "meshopt_samples.h"
#include "scene/import/gltf/meshopt_decode.h"

namespace meshlode::testing {
namespace {

using scene::decode_meshopt;
using scene::MeshoptFilter;
using scene::MeshoptLayout;
using scene::MeshoptMode;

std::vector<std::uint8_t> random_bytes(std::size_t size, std::uint64_t seed) {
  SplitMix64 random(seed);
  std::vector<std::uint8_t> out(size);
  // Small steps from byte to byte and runs without any: every width of the codec's groups.
  std::uint8_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (i / 64 % 3 != 0) value = static_cast<std::uint8_t>(value + random.below(i / 64 % 3 == 1 ? 3 : 256));
    out[i] = value;
  }
  return out;
}

std::vector<std::uint32_t> random_indices(std::size_t count, std::uint32_t limit, std::uint64_t seed) {
  SplitMix64 random(seed);
  std::vector<std::uint32_t> out(count);
  for (std::uint32_t& index : out) index = static_cast<std::uint32_t>(random.below(limit));
  return out;
}

template <class T>
std::vector<T> values_of(const std::vector<std::uint8_t>& bytes) {
  std::vector<T> out(bytes.size() / sizeof(T));
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

/// Each triangle as the least of its three turns: the codec may turn it.
std::vector<std::array<std::uint32_t, 3>> turned(const std::vector<std::uint32_t>& indices) {
  std::vector<std::array<std::uint32_t, 3>> out;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
    out.push_back(std::min({std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}));
  }
  return out;
}

TEST(ImportMeshopt, AttributesOfEveryStrideComeBack) {
  for (std::uint32_t stride = 4; stride <= 256; stride += 4) {
    for (const std::size_t count : {1U, 15U, 16U, 33U, 300U}) {
      const auto elements = random_bytes(count * stride, stride + count);
      const Stream stream = encode_meshopt_attributes(elements, stride);
      const auto decoded = decode_meshopt(stream, {MeshoptMode::kAttributes, MeshoptFilter::kNone, count, stride});
      ASSERT_TRUE(decoded) << decoded.error().message();
      ASSERT_EQ(*decoded, elements) << "stride " << stride << ", " << count << " elements";
    }
  }
}

TEST(ImportMeshopt, TrianglesAndIndicesOfBothVersionsAndWidthsComeBack) {
  for (const int version : {0, 1}) {
    for (const std::uint32_t limit : {3U, 200U, 60000U}) {
      const auto indices = random_indices(999, limit, limit);
      const Stream triangles = encode_meshopt_triangles(indices, version);
      const Stream sequence = encode_meshopt_indices(indices, version);
      for (const std::uint32_t stride : {2U, 4U}) {
        const auto as_indices = [&](const std::vector<std::uint8_t>& bytes) {
          if (stride == 4) return values_of<std::uint32_t>(bytes);
          const auto small = values_of<std::uint16_t>(bytes);
          return std::vector<std::uint32_t>(small.begin(), small.end());
        };
        const auto a = decode_meshopt(triangles, {MeshoptMode::kTriangles, MeshoptFilter::kNone, 999, stride});
        ASSERT_TRUE(a) << a.error().message();
        EXPECT_EQ(turned(as_indices(*a)), turned(indices));
        const auto b = decode_meshopt(sequence, {MeshoptMode::kIndices, MeshoptFilter::kNone, 999, stride});
        ASSERT_TRUE(b) << b.error().message();
        EXPECT_EQ(as_indices(*b), indices);
      }
    }
  }
}

// The library would cut the index off and name another vertex.
TEST(ImportMeshopt, AnIndexThatDoesNotFitIsRefused) {
  const std::vector<std::uint32_t> indices = {0, 65535, 65536};
  for (const bool is_triangles : {true, false}) {
    const Stream stream = is_triangles ? encode_meshopt_triangles(indices) : encode_meshopt_indices(indices);
    MeshoptLayout layout{is_triangles ? MeshoptMode::kTriangles : MeshoptMode::kIndices, MeshoptFilter::kNone, 3, 4};
    EXPECT_TRUE(decode_meshopt(stream, layout));
    layout.stride = 2;
    const auto cut = decode_meshopt(stream, layout);
    ASSERT_FALSE(cut);
    EXPECT_NE(cut.error().detail.find("65536"), std::string::npos) << cut.error().detail;
  }
}

struct FilterCase {
  MeshoptFilter filter;
  const char* name;
  std::uint32_t stride;
  int bits;
};

/// Unit vectors with a fourth component, or unit quaternions; every eighth lies along an axis.
std::vector<float> unit_values(std::size_t count, int dimensions) {
  SplitMix64 random(dimensions);
  std::vector<float> out;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 4> v{};
    double length = 0.0;
    for (int c = 0; c < dimensions; ++c) {
      v[c] = i % 8 == 0 ? (static_cast<int>(i / 8) % dimensions == c ? 1.0 : 0.0)
                        : static_cast<double>(random.below(2001)) / 1000.0 - 1.0;
      length += v[c] * v[c];
    }
    length = std::sqrt(length);
    for (int c = 0; c < dimensions; ++c) v[c] = length > 0.0 ? v[c] / length : (c == 0 ? 1.0 : 0.0);
    for (const double c : v) out.push_back(static_cast<float>(c));
  }
  return out;
}

TEST(ImportMeshopt, FiltersGiveUnitVectorsWithinTheBitsStored) {
  constexpr std::size_t kCount = 1001;
  for (const FilterCase& c : {FilterCase{MeshoptFilter::kOctahedral, "OCTAHEDRAL", 4, 8},
                              FilterCase{MeshoptFilter::kOctahedral, "OCTAHEDRAL", 8, 16},
                              FilterCase{MeshoptFilter::kOctahedral, "OCTAHEDRAL", 8, 10},
                              FilterCase{MeshoptFilter::kQuaternion, "QUATERNION", 8, 16},
                              FilterCase{MeshoptFilter::kQuaternion, "QUATERNION", 8, 11}}) {
    SCOPED_TRACE(std::string(c.name) + ", stride " + std::to_string(c.stride) + ", " + std::to_string(c.bits) +
                 " bits");
    const bool is_quaternion = c.filter == MeshoptFilter::kQuaternion;
    const auto values = unit_values(kCount, is_quaternion ? 4 : 3);
    const Stream stored =
        is_quaternion ? filter_quaternion(values, c.bits) : filter_octahedral(values, c.stride, c.bits);
    const auto decoded = decode_meshopt(encode_meshopt_attributes(stored, c.stride),
                                        {MeshoptMode::kAttributes, c.filter, kCount, c.stride});
    ASSERT_TRUE(decoded) << decoded.error().message();
    Stream theirs = stored;
    undo_filter_by_library(c.name, theirs, c.stride);
    const auto components = [&](const std::vector<std::uint8_t>& bytes) {
      std::vector<int> out;
      if (c.stride == 4) {
        for (const std::int8_t v : values_of<std::int8_t>(bytes)) out.push_back(v);
      } else {
        for (const std::int16_t v : values_of<std::int16_t>(bytes)) out.push_back(v);
      }
      return out;
    };
    const auto ours = components(*decoded), oracle = components(theirs);
    const double largest = c.stride == 4 ? 127.0 : 32767.0;
    const double step = 4.0 / (std::exp2(c.bits - 1) - 1.0) + 2.0 / largest;
    for (std::size_t i = 0; i < kCount; ++i) {
      double dot = 0.0;
      double worst = 0.0;
      for (std::size_t k = 0; k < 4; ++k) {
        ASSERT_LE(std::abs(ours[4 * i + k] - oracle[4 * i + k]), 1) << i << " component " << k;
        dot += ours[4 * i + k] / largest * static_cast<double>(values[4 * i + k]);
      }
      const double sign = is_quaternion && dot < 0.0 ? -1.0 : 1.0;  // q and -q turn alike
      for (std::size_t k = 0; k < (is_quaternion ? 4U : 3U); ++k) {
        worst = std::max(worst, std::fabs(sign * ours[4 * i + k] / largest - static_cast<double>(values[4 * i + k])));
      }
      ASSERT_LE(worst, step) << i;
    }
  }
}

TEST(ImportMeshopt, ExponentialFloatsComeBackWithinTheirBits) {
  std::vector<float> values;
  for (int i = 0; i < 300; ++i) values.push_back(std::ldexp(static_cast<float>(i * 37 % 101 - 50), i % 40 - 20));
  for (const std::uint32_t stride : {4U, 12U}) {
    const Stream stored = filter_exponential(values, stride, 24);
    const std::uint64_t count = stored.size() / stride;
    const auto decoded = decode_meshopt(encode_meshopt_attributes(stored, stride),
                                        {MeshoptMode::kAttributes, MeshoptFilter::kExponential, count, stride});
    ASSERT_TRUE(decoded) << decoded.error().message();
    Stream theirs = stored;
    undo_filter_by_library("EXPONENTIAL", theirs, stride);
    EXPECT_EQ(*decoded, theirs);
    if (stride == 4) {
      EXPECT_EQ(values_of<float>(*decoded), values);  // 7 bits each: nothing is lost
    }
  }
}

TEST(ImportMeshopt, AnyBitsLeaveTheFiltersDefined) {
  for (const MeshoptLayout layout : {MeshoptLayout{MeshoptMode::kAttributes, MeshoptFilter::kOctahedral, 4096, 4},
                                     MeshoptLayout{MeshoptMode::kAttributes, MeshoptFilter::kOctahedral, 4096, 8},
                                     MeshoptLayout{MeshoptMode::kAttributes, MeshoptFilter::kQuaternion, 4096, 8},
                                     MeshoptLayout{MeshoptMode::kAttributes, MeshoptFilter::kExponential, 4096, 8}}) {
    SplitMix64 random(layout.stride);
    std::vector<std::uint8_t> elements(layout.size_bytes());
    for (std::uint8_t& byte : elements) {
      const std::uint64_t pick = random.below(4);
      byte = static_cast<std::uint8_t>(pick == 0 ? 0 : pick == 1 ? 0x80 : pick == 2 ? 0xFF : random.next());
    }
    const auto decoded = decode_meshopt(encode_meshopt_attributes(elements, layout.stride), layout);
    ASSERT_TRUE(decoded);  // under sanitizers: without undefined behaviour
    EXPECT_EQ(decoded->size(), elements.size());
  }
}

void expect_same(const scene::Primitive& a, const scene::Primitive& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.uvs[0], b.uvs[0]);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.indices, b.indices);
}

TEST(ImportMeshopt, ACompressedSceneIsThePlainOne) {
  const TempFolder folder;
  for (const int n : {1, 5, 40}) {
    const MeshoptPair pair = make_meshopt_pair(n);
    const auto plain = scene::import_scene(folder.write("plain.glb", pair.plain_glb), {});
    const auto packed = scene::import_scene(folder.write("packed.glb", pair.meshopt_glb), {});
    ASSERT_TRUE(plain) << describe(plain);
    ASSERT_TRUE(packed) << describe(packed);
    expect_same(packed->meshes[0].primitives[0], plain->meshes[0].primitives[0]);
    EXPECT_EQ(packed->document, plain->document);  // no word of the extension is left
    EXPECT_TRUE(packed->left_out.empty());
  }
}

TEST(ImportMeshopt, AFilteredSceneIsThePlainOneWithinItsBits) {
  const TempFolder folder;
  const auto plain = scene::import_scene(folder.write("plain.glb", make_meshopt_pair(9).plain_glb), {});
  const auto packed = scene::import_scene(folder.write("packed.glb", make_filtered_glb(9)), {});
  ASSERT_TRUE(plain && packed) << describe(packed);
  const scene::Primitive& a = plain->meshes[0].primitives[0];
  const scene::Primitive& b = packed->meshes[0].primitives[0];
  ASSERT_EQ(a.positions.size(), b.positions.size());
  EXPECT_EQ(turned(a.indices), turned(b.indices));
  EXPECT_EQ(a.colors, b.colors);
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    EXPECT_LT(glm::length(a.positions[i] - b.positions[i]), 9.0 / (1 << 13)) << i;
    EXPECT_LT(glm::length(a.normals[i] - b.normals[i]), 0.02F) << i;
    EXPECT_LT(glm::length(a.uvs[0][i] - b.uvs[0][i]), 1.0F / (1 << 10)) << i;
  }
}

/// One triangle, its positions a stream; what a test changes is changed in the text.
struct OneTriangle {
  OneTriangle() {
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    Stream elements(36);
    std::memcpy(elements.data(), positions.data(), 36);
    b.accessor(b.meshopt_view(encode_meshopt_attributes(elements, 12), 3, 12, "ATTRIBUTES"), 5126, 3, "VEC3");
  }
  Result<scene::Scene> with(const std::string& from, const std::string& to, const std::string& more = "") {
    GltfBuilder changed = b;
    const std::size_t at = changed.views[0].find(from);
    EXPECT_NE(at, std::string::npos) << from;
    changed.views[0].replace(at, from.size(), to);
    return changed.import(mesh_text("\"POSITION\":0") + more);
  }
  GltfBuilder b;
};

void expect_error(const Result<scene::Scene>& scene, ErrorCode code, const std::string& text) {
  ASSERT_FALSE(scene) << text;
  EXPECT_EQ(scene.error().code, code) << describe(scene);
  EXPECT_NE(scene.error().message().find(text), std::string::npos) << describe(scene);
}

TEST(ImportMeshopt, WhatTheTextSaysIsCheckedBeforeAnythingIsDecoded) {
  OneTriangle t;
  ASSERT_TRUE(t.with("ATTRIBUTES", "ATTRIBUTES"));
  const std::string here = "/bufferViews/0/extensions/EXT_meshopt_compression";
  const struct {
    const char *from, *to;
    std::string place;
  } cases[] = {
      {"\"buffer\":0,", "", here + "/buffer"},
      {"\"buffer\":0,", "\"buffer\":7,", here + "/buffer"},
      {"\"buffer\":0,", "\"buffer\":1,", here + "/buffer"},  // the fallback itself
      {"\"count\":3", "\"count\":4", "/bufferViews/0/byteLength"},
      {"\"count\":3", "\"count\":281474976710655", "/bufferViews/0/byteLength"},
      {"\"count\":3", "\"count\":-3", here + "/count"},
      {"\"byteStride\":12,\"count\"", "\"byteStride\":16,\"count\"", here + "/byteStride"},
      {"\"byteStride\":12,\"count\"", "\"byteStride\":260,\"count\"", here + "/byteStride"},
      {"\"byteStride\":12,\"count\"", "\"byteStride\":0,\"count\"", here},
      {"\"filter\":\"NONE\"", "\"filter\":\"OCTAHEDRAL\"", here},
      {"\"filter\":\"NONE\"", "\"filter\":\"QUATERNION\"", here},
      {"\"filter\":\"NONE\"", "\"filter\":5", here + "/filter"},
      {"\"mode\":\"ATTRIBUTES\"", "\"mode\":\"TRIANGLES\"", here},
      {"\"mode\":\"ATTRIBUTES\",", "", here + "/mode"},
      {"{\"EXT_meshopt_compression\":{", "{\"EXT_meshopt_compression\":5,\"x\":{", here},
      {"\"byteOffset\":0,\"byteLength\":36", "\"byteOffset\":4,\"byteLength\":36", "/bufferViews/0"},
  };
  for (const auto& c : cases) expect_error(t.with(c.from, c.to), ErrorCode::kInvalid, c.place + ":");
  const std::string length = std::to_string(t.b.bin.size());
  expect_error(t.with("\"byteLength\":" + length, "\"byteLength\":" + std::to_string(t.b.bin.size() + 1)),
               ErrorCode::kInvalid, here + ":");
  expect_error(t.with("\"byteLength\":" + length, "\"byteLength\":" + std::to_string(t.b.bin.size() - 1)),
               ErrorCode::kInvalid, here + ":");
}

TEST(ImportMeshopt, WhatIsNewerThanTheLibraryIsRefusedByName) {
  OneTriangle t;
  expect_error(t.with("\"mode\":\"ATTRIBUTES\"", "\"mode\":\"MESHLETS\""), ErrorCode::kUnsupported, "MESHLETS");
  expect_error(t.with("\"filter\":\"NONE\"", "\"filter\":\"COLOR\""), ErrorCode::kUnsupported, "COLOR");
  t.b.bin[0] = 0xA1;
  expect_error(t.with("ATTRIBUTES", "ATTRIBUTES"), ErrorCode::kUnsupported, "version 1 of the vertex codec");
  t.b.bin[0] = 0xB0;
  expect_error(t.with("ATTRIBUTES", "ATTRIBUTES"), ErrorCode::kInvalid, "no vertex stream");
  for (const bool is_triangles : {true, false}) {
    Stream stream = is_triangles ? encode_meshopt_triangles({0, 1, 2}) : encode_meshopt_indices({0, 1, 2});
    stream[0] = static_cast<std::uint8_t>((stream[0] & 0xF0U) | 2U);
    const auto decoded = decode_meshopt(
        stream, {is_triangles ? MeshoptMode::kTriangles : MeshoptMode::kIndices, MeshoptFilter::kNone, 3, 4});
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(decoded.error().detail.find(is_triangles ? "version 2 of the triangle" : "version 2 of the index"),
              std::string::npos)
        << decoded.error().detail;
  }
}

TEST(ImportMeshopt, TheKhronosNameIsReadAndRequiredOnesAreHonoured) {
  for (const std::string name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    OneTriangle t;
    t.b.meshopt_name = name;
    const auto scene =
        t.with("\"EXT_meshopt_compression\"", "\"" + name + "\"", ",\"extensionsRequired\":[\"" + name + "\"]");
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(scene->meshes[0].primitives[0].indices.size(), 3U);
    EXPECT_EQ(scene->document.find("meshopt"), std::string::npos);
  }
}

// The extension is decoded where it is there, required or not; a fallback is for those who cannot, and is not opened.
TEST(ImportMeshopt, TheFallbackIsNotRead) {
  const TempFolder folder;
  OneTriangle t;
  const std::string whole = t.b.json(mesh_text("\"POSITION\":0"), ",\"uri\":\"streams.bin\"");
  folder.write("streams.bin", std::string(t.b.bin.begin(), t.b.bin.end()));
  const auto absent = scene::import_scene(folder.write("scene.gltf", whole), {});
  ASSERT_TRUE(absent) << describe(absent);
  std::string named = whole;
  named.replace(named.find("{\"byteLength\":36,"), 17, "{\"uri\":\"no-such-file.bin\",\"byteLength\":36,");
  const auto unopened = scene::import_scene(folder.write("scene.gltf", named), {});
  ASSERT_TRUE(unopened) << describe(unopened);
  expect_same(unopened->meshes[0].primitives[0], absent->meshes[0].primitives[0]);
  // A view that is not compressed has nothing to read there.
  std::string plain = whole;
  plain.replace(plain.find("],\"accessors\""), 1, ",{\"buffer\":1,\"byteLength\":4}]");
  expect_error(scene::import_scene(folder.write("scene.gltf", plain), {}), ErrorCode::kInvalid,
               "/bufferViews/1/buffer");
}

TEST(ImportMeshopt, EveryTruncationIsAnErrorAndEveryChangedByteIsHarmless) {
  const auto elements = random_bytes(40 * 12, 1);
  const auto indices = random_indices(60, 40, 2);
  const std::pair<Stream, MeshoptLayout> samples[] = {
      {encode_meshopt_attributes(elements, 12), {MeshoptMode::kAttributes, MeshoptFilter::kNone, 40, 12}},
      {encode_meshopt_triangles(indices), {MeshoptMode::kTriangles, MeshoptFilter::kNone, 60, 2}},
      {encode_meshopt_indices(indices), {MeshoptMode::kIndices, MeshoptFilter::kNone, 60, 4}}};
  for (const auto& [stream, layout] : samples) {
    for (std::size_t size = 0; size < stream.size(); ++size) {
      const Stream cut(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(decode_meshopt(cut, layout)) << size;
    }
    for (std::size_t at = 0; at < stream.size(); ++at) {
      for (const int value : {0, 1, 127, 128, 254, 255}) {
        Stream changed = stream;
        changed[at] = static_cast<std::uint8_t>(value);
        const auto decoded = decode_meshopt(changed, layout);
        EXPECT_TRUE(!decoded || decoded->size() == layout.size_bytes());
      }
    }
  }
}

// 64 bytes of a stream that says "as before" for each byte, named again and again.
TEST(ImportMeshopt, WhatIsDecodedGrowsWithTheFile) {
  const Stream stream = encode_meshopt_attributes(Stream(std::size_t{1} << 20U), 16);
  ASSERT_LT(stream.size(), 40000U);
  const auto huge =
      decode_meshopt(stream, {MeshoptMode::kAttributes, MeshoptFilter::kNone, std::uint64_t{1} << 40U, 16});
  ASSERT_FALSE(huge);
  EXPECT_NE(huge.error().detail.find("too few"), std::string::npos);
  for (const int times : {1, 4}) {
    GltfBuilder b;
    b.meshopt_view(stream, std::size_t{1} << 16U, 16, "ATTRIBUTES");
    for (int i = 1; i < times; ++i) {
      b.views.push_back(b.views[0]);
    }
    const auto scene = b.import("\"scenes\":[]");
    EXPECT_EQ(scene.ok(), times == 1) << describe(scene);
    if (!scene) {
      EXPECT_NE(scene.error().detail.find("justify"), std::string::npos) << describe(scene);
    }
  }
}

}  // namespace
}  // namespace meshlode::testing
