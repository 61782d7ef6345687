// SPDX-License-Identifier: GPL-3.0-or-later
// Every bad file gets one error with the file, the place and the reason; nothing is read outside the bytes (I11).
#include <gtest/gtest.h>

#include <chrono>

#include "gltf_builder.h"
#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/uri.h"

namespace meshlode::testing {
namespace {

struct BadFile {
  std::string text;
  std::string place;
  ErrorCode code = ErrorCode::kInvalid;
};

void expect_refused(const Result<scene::Scene>& scene, const BadFile& bad) {
  ASSERT_FALSE(scene) << bad.text;
  EXPECT_EQ(scene.error().code, bad.code) << bad.text << "\n" << describe(scene);
  EXPECT_NE(scene.error().where.find(bad.place), std::string::npos) << bad.text << "\n" << describe(scene);
  EXPECT_NE(scene.error().where.find("scene.gl"), std::string::npos);
  EXPECT_FALSE(scene.error().detail.empty());
}

std::string gltf(const std::string& rest) {
  return "{\"asset\":{\"version\":\"2.0\"}," + rest + "}";
}

TEST(ImportRefuses, StructuralFaultsByTheirJsonPath) {
  const std::vector<BadFile> files = {
      {"", ""},
      {"[]", "/"},
      {"{\"a\":1,\"a\":2}", ""},
      {"{", ""},
      {"{}", "/asset/version"},
      {"{\"asset\":{\"version\":\"1.0\"}}", "/asset/version", ErrorCode::kUnsupported},
      {"{\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.1\"}}", "/asset/minVersion", ErrorCode::kUnsupported},
      {gltf("\"extensionsRequired\":[\"ACME_folded_space\"]"), "/extensionsRequired/0", ErrorCode::kUnsupported},
      {gltf("\"extensionsRequired\":[3]"), "/extensionsRequired/0"},
      {gltf("\"buffers\":3"), "/buffers"},
      {gltf("\"buffers\":[{}]"), "/buffers/0/byteLength"},
      {gltf("\"buffers\":[{\"byteLength\":-4}]"), "/buffers/0/byteLength"},
      {gltf("\"buffers\":[{\"byteLength\":4}],\"bufferViews\":[{\"buffer\":1,\"byteLength\":4}]"),
       "/bufferViews/0/buffer"},
      {gltf("\"buffers\":[{\"byteLength\":4}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":2,\"byteLength\":4}]"),
       "/bufferViews/0"},
      {gltf("\"buffers\":[{\"byteLength\":4}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":4,\"byteStride\":4097}]"),
       "/bufferViews/0/byteStride"},
      {gltf("\"buffers\":[{\"byteLength\":4}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":1e300}]"),
       "/bufferViews/0/byteLength"},
      {gltf("\"accessors\":[{\"componentType\":5124,\"count\":1,\"type\":\"SCALAR\"}]"), "/accessors/0/componentType"},
      {gltf("\"accessors\":[{\"componentType\":5126,\"count\":1,\"type\":\"VEC5\"}]"), "/accessors/0/type"},
      {gltf("\"accessors\":[{\"componentType\":5126,\"count\":4294967295,\"type\":\"VEC3\"}]"), "/accessors/0/count",
       ErrorCode::kUnsupported},
      {gltf("\"accessors\":[{\"componentType\":5126,\"count\":1.5,\"type\":\"VEC3\"}]"), "/accessors/0/count"},
      {gltf("\"meshes\":[{}]"), "/meshes/0/primitives"},
      {gltf("\"meshes\":[{\"primitives\":[{}]}]"), "/meshes/0/primitives/0/attributes"},
      {gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]"),
       "/meshes/0/primitives/0/attributes/POSITION"},
      {gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{},\"material\":0}]}]"), "/meshes/0/primitives/0/material"},
      {gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{},\"mode\":7}]}]"), "/meshes/0/primitives/0/mode"},
      {gltf("\"nodes\":[{\"mesh\":0}]"), "/nodes/0/mesh"},
      {gltf("\"nodes\":[{\"children\":[0]}]"), "/nodes/0"},
      {gltf("\"nodes\":[{\"children\":[1]},{\"children\":[2]},{\"children\":[1]}]"), "/nodes/2/children/0"},
      {gltf("\"nodes\":[{\"children\":[1]},{\"children\":[0]}]"), "/nodes/"},
      {gltf("\"nodes\":[{\"children\":[2]},{\"children\":[2]},{}]"), "/nodes/1/children/0"},
      {gltf("\"nodes\":[{\"matrix\":[1,2,3]}]"), "/nodes/0/matrix"},
      {gltf("\"nodes\":[{\"rotation\":[0,0,0,0]}]"), "/nodes/0/rotation"},
      {gltf("\"nodes\":[{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}]"), "/nodes/0/extensions"},
      {gltf("\"nodes\":[{\"children\":[1]},{}],\"scenes\":[{\"nodes\":[0,1]}]"), "/scenes/0/nodes/1"},
      {gltf("\"nodes\":[{}],\"scenes\":[{\"nodes\":[0,0]}]"), "/scenes/0/nodes/1"},
      {gltf("\"scene\":0"), "/scene"},
      {gltf("\"materials\":[{\"normalTexture\":{\"index\":0}}]"), "/materials/0/normalTexture/index"},
      {gltf("\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1]}}]"), "/materials/0"},
      {gltf("\"textures\":[{\"source\":0}]"), "/textures/0/source"},
      {gltf("\"images\":[{\"uri\":7}]"), "/images/0/uri"},
      {gltf("\"animations\":[{\"samplers\":[],\"channels\":[{\"sampler\":0,\"target\":{\"path\":\"scale\"}}]}]"),
       "/animations/0/channels/0/sampler"},
      {gltf("\"animations\":[{\"samplers\":[{\"input\":0,\"output\":0,\"interpolation\":1}]}],"
            "\"accessors\":[{\"count\":1,\"type\":\"SCALAR\",\"componentType\":5126}]"),
       "/animations/0/samplers/0/interpolation"},
      {gltf("\"buffers\":[{\"byteLength\":4,\"uri\":\"data:;base64,AAA=\"}]"), "/buffers/0"},
      {gltf("\"buffers\":[{\"byteLength\":4,\"uri\":\"data:;base64,A*A=\"}]"), "/buffers/0/uri"},
      {gltf("\"buffers\":[{\"byteLength\":4,\"uri\":\"missing.bin\"}]"), "/buffers/0/uri", ErrorCode::kIo},
      {gltf("\"images\":[{\"uri\":\"missing.png\"}]"), "/images/0/uri", ErrorCode::kIo},
      {gltf("\"images\":[{\"uri\":\"https://example.org/a.png\"}]"), "/images/0/uri", ErrorCode::kUnsupported},
      {gltf("\"images\":[{\"uri\":\"file:///etc/hostname\"}]"), "/images/0/uri", ErrorCode::kUnsupported},
      {gltf("\"images\":[{\"uri\":\"/etc/hostname\"}]"), "/images/0/uri"},
      {gltf("\"images\":[{\"uri\":\"../outside.png\"}]"), "/images/0/uri"},
      {gltf("\"images\":[{\"uri\":\"a/%2e%2e/..%2Foutside.png\"}]"), "/images/0/uri"},
      {gltf("\"images\":[{\"uri\":\"a%00.png\"}]"), "/images/0/uri"},
      {gltf("\"images\":[{\"uri\":\"link.png\"}]"), "/images/0/uri"},
  };
  const TempFolder outside;
  outside.write("secret.png", "x");
  const TempFolder folder;
  std::filesystem::create_symlink(outside.path() / "secret.png", folder.path() / "link.png");
  for (const BadFile& bad : files) {
    expect_refused(scene::import_scene(folder.write("scene.gltf", bad.text), {}), bad);
  }
}

// Cut to 32 bits each of these would be a small number that passes, or a negative one.
TEST(ImportRefuses, IndicesAndBoundsThatNeedMoreThan32BitsByTheirJsonPath) {
  const std::string buffer = "\"buffers\":[{\"byteLength\":64,\"uri\":\"data:;base64,AAAA\"}],\"bufferViews\":[{";
  const std::string mesh = "\"materials\":[{}],\"meshes\":[{\"primitives\":[{\"attributes\":{";
  const std::string accessor = "\"accessors\":[{\"type\":\"SCALAR\",\"count\":1,";
  const std::vector<BadFile> files = {
      {buffer + "\"buffer\":#,\"byteLength\":4}]", "/bufferViews/0/buffer"},
      {buffer + "\"buffer\":0,\"byteOffset\":#,\"byteLength\":4}]", "/bufferViews/0"},
      {buffer + "\"buffer\":0,\"byteLength\":#}]", "/bufferViews/0"},
      {buffer + "\"buffer\":0,\"byteLength\":4,\"byteStride\":#}]", "/bufferViews/0/byteStride"},
      {buffer + "\"buffer\":0,\"byteLength\":64}]," + accessor +
           "\"componentType\":5126,\"bufferView\":0,\"byteOffset\":#}]",
       "/accessors/0"},
      {accessor + "\"componentType\":5126,\"bufferView\":#}]", "/accessors/0/bufferView"},
      {accessor + "\"componentType\":#}]", "/accessors/0/componentType"},
      {mesh + "\"POSITION\":#}}]}]", "/meshes/0/primitives/0/attributes/POSITION"},
      {mesh + "},\"indices\":#}]}]", "/meshes/0/primitives/0/indices"},
      {mesh + "},\"material\":#}]}]", "/meshes/0/primitives/0/material"},
      {mesh + "},\"mode\":#}]}]", "/meshes/0/primitives/0/mode"},
      {"\"nodes\":[{\"mesh\":#}]", "/nodes/0/mesh"},
      {"\"nodes\":[{\"children\":[#]}]", "/nodes/0/children/0"},
      {"\"nodes\":[{}],\"scenes\":[{\"nodes\":[#]}]", "/scenes/0/nodes/0"},
      {"\"scenes\":[{}],\"scene\":#", "/scene"},
      {"\"nodes\":[{}],\"skins\":[{\"joints\":[#]}]", "/skins/0/joints/0"},
      {accessor +
           "\"componentType\":5126}],\"animations\":[{\"samplers\":[{\"input\":#,\"output\":0}],\"channels\":[]}]",
       "/animations/0/samplers/0/input"},
  };
  const TempFolder folder;
  for (const char* large : {"2147483648", "4294967296", "4294967300", "281474976710656", "18446744073709551616"}) {
    for (const BadFile& bad : files) {
      const BadFile numbered = {with_number(gltf(bad.text), large), bad.place, bad.code};
      expect_refused(scene::import_scene(folder.write("scene.gltf", numbered.text), {}), numbered);
    }
  }
}

// A buffer of 2^48 - 1 bytes that nobody has, and one view over all of it: only what is kept in 32 bits is at fault.
TEST(ImportRefuses, CountsAndSparseOffsetsThatAreNotSupportedByTheirJsonPath) {
  const std::string start =
      "\"buffers\":[{\"byteLength\":281474976710655}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":281474976710655}],"
      "\"accessors\":[{\"componentType\":5126,\"type\":\"SCALAR\",\"count\":";
  const std::string indices =
      "4,\"sparse\":{\"count\":1,\"values\":{\"bufferView\":0},\"indices\":{\"componentType\":5125,";
  const std::string values =
      "4,\"sparse\":{\"count\":1,\"indices\":{\"componentType\":5125,\"bufferView\":0},\"values\":{";
  const std::string offset = "\"bufferView\":0,\"byteOffset\":#}}}]";
  const std::vector<BadFile> files = {
      {start + "#}]", "/accessors/0/count"},
      {start + "#,\"bufferView\":0}]", "/accessors/0/count"},
      {start + indices + offset, "/accessors/0/sparse/indices/byteOffset"},
      {start + values + offset, "/accessors/0/sparse/values/byteOffset"},
  };
  const TempFolder folder;
  const auto expect = [&](const BadFile& bad, const std::string& number, ErrorCode code) {
    const BadFile numbered = {with_number(gltf(bad.text), number), bad.place, code};
    expect_refused(scene::import_scene(folder.write("scene.gltf", numbered.text), {}), numbered);
  };
  for (const BadFile& bad : files) {
    for (const char* large : {"2147483648", "4294967296", "4294967300"}) expect(bad, large, ErrorCode::kUnsupported);
    for (const char* absurd : {"281474976710656", "9007199254740993"}) expect(bad, absurd, ErrorCode::kInvalid);
  }
  expect({start + "#,\"bufferView\":0}]", "/accessors/0"}, "70368744177665", ErrorCode::kInvalid);
  expect({start + "4,\"sparse\":{\"count\":#}}]", "/accessors/0/sparse/count"}, "4294967297", ErrorCode::kInvalid);
}

TEST(ImportRefuses, AccessorsThatReachOutsideTheirViewByOneByte) {
  for (const std::size_t count : {3, 4}) {
    GltfBuilder b;
    b.accessor(b.view(std::vector<float>(3 * 3)), 5126, count, "VEC3");
    const auto scene = b.import(mesh_text("\"POSITION\":0"));
    EXPECT_EQ(scene.ok(), count == 3) << describe(scene);
  }
  GltfBuilder b;
  b.accessor(b.view(std::vector<float>(3 * 3)), 5126, 3, "VEC3", ",\"byteOffset\":4");
  expect_refused(b.import(mesh_text("\"POSITION\":0")), {"offset", "/accessors/0"});
  GltfBuilder strided;  // the last element needs its bytes, not its whole stride
  std::vector<std::uint8_t> bytes(2 * 16 + 12);
  strided.accessor(strided.view(bytes, 16), 5126, 3, "VEC3");
  EXPECT_TRUE(strided.import(mesh_text("\"POSITION\":0")));
}

TEST(ImportRefuses, SparseIndicesThatDoNotIncreaseOrLeaveTheAccessor) {
  for (const std::vector<std::uint8_t>& wrong : {std::vector<std::uint8_t>{2, 2}, {2, 1}, {1, 4}}) {
    GltfBuilder b;
    const int base = b.view(kSquare);
    const int indices = b.view(wrong);
    const int values = b.view(std::vector<float>(6));
    b.accessor(base, 5126, 4, "VEC3",
               ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":" + std::to_string(indices) +
                   ",\"componentType\":5121},\"values\":{\"bufferView\":" + std::to_string(values) + "}}");
    expect_refused(b.import(mesh_text("\"POSITION\":0")), {"sparse", "/accessors/0/sparse/indices"});
  }
}

TEST(ImportRefuses, AttributesOfDifferentLengthsOrTypes) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  b.floats({0, 0, 1}, "VEC3", 3);
  b.floats(std::vector<float>(8), "VEC2", 2);
  const std::string path = "/meshes/0/primitives/0/attributes/";
  expect_refused(b.import(mesh_text("\"POSITION\":0,\"NORMAL\":1")), {"count", path + "NORMAL"});
  expect_refused(b.import(mesh_text("\"POSITION\":0,\"NORMAL\":2")), {"type", path + "NORMAL"});
  expect_refused(b.import(mesh_text("\"POSITION\":2")), {"type", path + "POSITION"});
  expect_refused(b.import(mesh_text("\"POSITION\":0", ",\"indices\":0")), {"indices", "/indices"});
}

std::string members(int count, const std::string& value) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i == 0 ? "\"m" : ",\"m") + std::to_string(i) + "\":" + value;
  return text;
}

// Members are a list that is searched by name for every index that leads to the object: a view of a hundred thousand
// members that a hundred thousand accessors name would take hours.
TEST(ImportRefuses, ObjectsOfMoreMembersThanAnybodyWrites) {
  const std::string many = members(260, "0"), few = members(250, "0");
  expect_refused(GltfBuilder().import("\"meshes\":[{\"primitives\":[]," + many + "}]"), {"mesh", "/meshes/0"});
  expect_refused(GltfBuilder().import("\"nodes\":[{" + many + "}]"), {"node", "/nodes/0"});
  expect_refused(GltfBuilder().import("\"animations\":[{" + many + "}]"), {"animation", "/animations/0"});
  expect_refused(GltfBuilder().import("\"extensions\":{\"KHR_lights_punctual\":{" + many + "}}"), {"lights", "/"});
  EXPECT_TRUE(GltfBuilder().import("\"nodes\":[{" + few + "}]"));
  EXPECT_TRUE(GltfBuilder().import("\"nodes\":[{\"extras\":{" + many + "}}]")) << "what is carried may be of any size";
}

TEST(ImportRefuses, ManyExtensionsAreLeftOutInOnePass) {
  const auto start = std::chrono::steady_clock::now();
  const auto scene = GltfBuilder().import("\"nodes\":[{\"extensions\":{" + members(60000, "{\"accessor\":0}") + "}}]");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->left_out.size(), 60000u);
  EXPECT_EQ(scene->document.find("extensions"), std::string::npos);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_LT(seconds.count(), 10.0);
}

TEST(ImportRefuses, DracoBeyondTheBudgetMustBeJustifiedAsOtherBytesAre) {
  constexpr std::uint64_t kBase = std::uint64_t{1} << 20U, kMega = 1000000;
  const auto left = [](std::uint64_t file, std::uint64_t draco, std::uint64_t max_decoded) {
    return scene::DecodeBudget(file, draco, max_decoded).left_bytes() / scene::DecodeBudget::kElementBytes;
  };
  EXPECT_EQ(left(0, 0, 512 * kMega), kBase);
  EXPECT_EQ(left(kMega, 0, 512 * kMega), kBase + 4 * kMega);
  EXPECT_EQ(left(0, 100, 512 * kMega), kBase + 6000) << "sixty elements a byte";
  EXPECT_EQ(left(0, 10 * kMega, 240 * kMega), kBase + 40 * kMega) << "four, where they take more than what is allowed";
  EXPECT_EQ(left(0, kMega, 240 * kMega), kBase + 10 * kMega) << "what is allowed, between";
  scene::DecodeBudget budget(0, 0, 0);
  EXPECT_TRUE(budget.take(kBase));
  EXPECT_FALSE(budget.take(1));
}

TEST(ImportRefuses, ASmallFileThatAsksForGigabytes) {
  const auto start = std::chrono::steady_clock::now();
  GltfBuilder zeros;
  zeros.accessor(-1, 5126, 2000000000, "VEC3");
  expect_refused(zeros.import(mesh_text("\"POSITION\":0")), {"zeros", "/meshes/0/primitives/0"});
  // The same bytes named by a thousand primitives.
  GltfBuilder shared;
  shared.floats(kSquare, "VEC3", 3);
  shared.array(std::vector<std::uint8_t>(300000, 1), 5121, "SCALAR", 1);
  std::string primitives;
  for (int i = 0; i < 1000; ++i) {
    primitives += std::string(i == 0 ? "" : ",") + "{\"attributes\":{\"POSITION\":0},\"indices\":1}";
  }
  expect_refused(shared.import("\"meshes\":[{\"primitives\":[" + primitives + "]}]"), {"shared", "/meshes/0"});
  // Images that overlap.
  GltfBuilder images;
  images.view(std::vector<std::uint8_t>(1 << 20));
  std::string list;
  for (int i = 0; i < 100; ++i) {
    images.views.push_back("{\"buffer\":0,\"byteOffset\":" + std::to_string(i) + ",\"byteLength\":1000000}");
    list +=
        std::string(i == 0 ? "" : ",") + "{\"mimeType\":\"image/png\",\"bufferView\":" + std::to_string(i + 1) + "}";
  }
  expect_refused(images.import("\"images\":[" + list + "]"), {"images", "/images/"});
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(ImportRefuses, DeepJsonWithoutUsingTheStack) {
  std::string deep(1000000, '[');
  const TempFolder folder;
  expect_refused(scene::import_scene(folder.write("scene.gltf", deep), {}), {"deep", ""});
  std::string objects;
  for (int i = 0; i < 200000; ++i) objects += "{\"a\":";
  expect_refused(scene::import_scene(folder.write("scene.gltf", objects), {}), {"deep", ""});
}

TEST(ImportRefuses, BrokenGlbHeadersAndChunks) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  const std::string good = b.glb(mesh_text("\"POSITION\":0"));
  const TempFolder folder;
  ASSERT_TRUE(scene::import_scene(folder.write("scene.glb", good), {}));
  for (std::size_t size = 0; size < good.size(); ++size) {
    const auto scene = scene::import_scene(folder.write("scene.glb", good.substr(0, size)), {});
    ASSERT_FALSE(scene) << "truncated to " << size;
    EXPECT_EQ(scene.error().code, ErrorCode::kInvalid);
  }
  const auto patched = [&](std::size_t at, std::uint32_t value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &value, 4);
    return scene::import_scene(folder.write("scene.glb", bytes), {});
  };
  expect_refused(patched(4, 1), {"version", "GLB header", ErrorCode::kUnsupported});
  expect_refused(patched(8, 0xFFFFFFFFu), {"length", "GLB header"});
  expect_refused(patched(12, 0xFFFFFFF0u), {"chunk length", "GLB chunk 0"});
  expect_refused(patched(16, 0), {"chunk type", "GLB chunk 0"});
}

TEST(ImportRefuses, WhatIsNoFileOrNoKnownFormat) {
  const TempFolder folder;
  const auto missing = scene::import_scene(folder.path() / "scene.glb", {});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
  const auto is_folder = scene::import_scene(folder.path(), {});
  ASSERT_FALSE(is_folder);
  EXPECT_EQ(is_folder.error().code, ErrorCode::kIo);
  const auto unknown = scene::import_scene(folder.write("scene.gl.txt", "hello"), {});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kUnsupported);
}

TEST(ImportUri, DecodesWhatItMustAndNothingElse) {
  EXPECT_EQ(scene::percent_decode("a%20b%C3%A4").value(), "a b\xC3\xA4");
  EXPECT_FALSE(scene::percent_decode("a%2"));
  EXPECT_FALSE(scene::percent_decode("a%zz"));
  const auto bytes = scene::base64_decode("AP8Q");
  ASSERT_TRUE(bytes);
  EXPECT_EQ(*bytes, (std::vector<std::uint8_t>{0x00, 0xFF, 0x10}));
  EXPECT_EQ(scene::base64_decode("AA==").value().size(), 1U);
  EXPECT_EQ(scene::base64_decode("AA").value().size(), 1U);
  EXPECT_FALSE(scene::base64_decode("A"));
  const auto plain = scene::decode_data_uri("data:text/plain,a%00b");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->bytes.size(), 3U);
  EXPECT_EQ(plain->mime_type, "text/plain");
}

/// Lines of 76 characters and escaped padding are what mail tools and URL builders write.
TEST(ImportUri, Base64MayBeWrappedAndEscaped) {
  const std::vector<std::uint8_t> bytes{0xFF, 0xEF, 0x10, 0x20};
  for (const char* body : {"/+8QIA==", "/+8Q\r\nIA==\n", " /+8Q\tIA", "%2F%2B8QIA%3D%3D", "/+8QIA%3d%3D"}) {
    const auto data = scene::decode_data_uri(std::string("data:application/octet-stream;base64,") + body);
    ASSERT_TRUE(data) << body << ": " << data.error().detail;
    EXPECT_EQ(data->bytes, bytes) << body;
  }
  EXPECT_TRUE(scene::decode_data_uri("data:;BASE64,AA=="));
  for (const char* body : {"/+8QI*==", "/+8Q-A", "/+8Q%2", "A"}) {
    EXPECT_FALSE(scene::decode_data_uri(std::string("data:;base64,") + body)) << body;
  }
}

TEST(ImportUri, FindsFilesInFoldersWithSpacesButNeverOutside) {
  const TempFolder folder;
  folder.write("sub folder/a b.bin", "x");
  EXPECT_TRUE(scene::resolve_uri(folder.path(), "sub%20folder/a%20b.bin"));
  EXPECT_TRUE(scene::resolve_uri(folder.path(), "sub%20folder/../sub%20folder/a%20b.bin"));
  EXPECT_FALSE(scene::resolve_uri(folder.path() / "sub folder", "../sub%20folder/a%20b.bin"));
}

}  // namespace
}  // namespace meshlode::testing
