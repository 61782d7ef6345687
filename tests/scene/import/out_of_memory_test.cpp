// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that cannot be had while a file is read is no fault of the file: each large allocation of an import fails
// once. Small ones are let through, as a machine that runs out of memory does: nlohmann-json's destructors allocate,
// and end the program where they cannot. This program's operator new stands in for the library's, in shared libraries
// too. It also counts the memory of a document's values.
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>
#include <tuple>
#include <vector>

#include "draco_samples.h"
#include "gltf_builder.h"
#include "mutant_seeds.h"
#include "scene/import/import.h"
#include "scene/import/json.h"

namespace {

constexpr long kNever = -1;
thread_local long allocations_left = kNever;  ///< of this thread and the size below or more, until one fails
thread_local std::size_t smallest = 0;
thread_local long held = 0, most_held = 0;  ///< bytes, with what malloc puts before each block

long bytes_of(void* memory) {
  return static_cast<long>(malloc_usable_size(memory) + sizeof(std::size_t));
}

void* allocate(std::size_t bytes) {
  if (bytes >= smallest && allocations_left >= 0 && allocations_left-- == 0) return nullptr;
  void* const memory = std::malloc(bytes == 0 ? 1 : bytes);
  if (memory != nullptr) most_held = std::max(most_held, held += bytes_of(memory));
  return memory;
}

void release(void* memory) {
  if (memory != nullptr) held -= bytes_of(memory);
  std::free(memory);
}

void* allocate_or_throw(std::size_t bytes) {
  void* const out = allocate(bytes);
  if (out == nullptr) throw std::bad_alloc();
  return out;
}

}  // namespace

void* operator new(std::size_t bytes) {
  return allocate_or_throw(bytes);
}
void* operator new[](std::size_t bytes) {
  return allocate_or_throw(bytes);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return allocate(bytes);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return allocate(bytes);
}
void operator delete(void* memory) noexcept {
  release(memory);
}
void operator delete[](void* memory) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  release(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  release(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  release(memory);
}

namespace meshlode::testing {
namespace {

/// Calls `body` with the first allocation of at least `bytes` failing, then the second, until none fails any more;
/// `body` is told which. Returns how many did.
template <class Body>
long fail_each_allocation(std::size_t bytes, const Body& body) {
  smallest = bytes;
  for (long which = 0;; ++which) {
    allocations_left = which;
    body(which);
    if (allocations_left != kNever) {
      allocations_left = kNever;
      return which;
    }
  }
}

constexpr int kSide = 48;  // vertices: enough for each array of a mesh to be large

std::vector<float> grid_positions() {
  std::vector<float> out;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) out.insert(out.end(), {static_cast<float>(x), static_cast<float>(y), 0.0F});
  }
  return out;
}

std::vector<std::uint16_t> grid_triangles() {
  std::vector<std::uint16_t> out;
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x + 1 < kSide; ++x) {
      const auto at = static_cast<std::uint16_t>(y * kSide + x);
      for (const int step : {0, 1, kSide + 1, 0, kSide + 1, kSide})
        out.push_back(static_cast<std::uint16_t>(at + step));
    }
  }
  return out;
}

std::vector<SeedFile> large_files() {
  const std::vector<float> p = grid_positions();
  const std::vector<std::uint16_t> t = grid_triangles();
  const std::string counts[] = {std::to_string(p.size() / 3), std::to_string(t.size() / 3)};
  std::string ply = "ply\nformat ascii 1.0\nelement vertex " + counts[0] +
                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " + counts[1] +
                    "\nproperty list uchar int vertex_indices\nend_header\n";
  std::string obj, stl = "solid a\n";
  for (std::size_t i = 0; i < p.size(); i += 3) {
    const std::string text = std::to_string(p[i]) + " " + std::to_string(p[i + 1]) + " 0\n";
    ply += text;
    obj += "v " + text;
  }
  for (std::size_t i = 0; i < t.size(); i += 3) {
    ply += "3";
    obj += "f";
    stl += "facet normal 0 0 1\nouter loop\n";
    for (std::size_t k = i; k < i + 3; ++k) {
      ply.append(1, ' ').append(std::to_string(t[k]));
      obj.append(1, ' ').append(std::to_string(t[k] + 1));
      stl += "vertex " + std::to_string(p[3U * t[k]]) + " " + std::to_string(p[3U * t[k] + 1]) + " 0\n";
    }
    ply += "\n";
    obj += "\n";
    stl += "endloop\nendfacet\n";
  }
  GltfBuilder gltf;
  gltf.floats(p, "VEC3", 3);
  gltf.array(t, 5123, "SCALAR", 1);
  return {{"a.glb", gltf.glb("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
                             "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0")},
          {"draco.glb", make_draco_glb(make_draco_sample(kSide, true, 5, 11))},
          {"a.ply", ply},
          {"a.obj", obj},
          {"a.stl", stl + "endsolid a\n"}};
}

TEST(OutOfMemory, IsNotTheFilesFault) {
  const auto folder = std::filesystem::temp_directory_path() / ("meshlode-memory-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  for (const SeedFile& file : large_files()) {
    const auto path = folder / file.name;
    std::ofstream(path, std::ios::binary).write(file.bytes.data(), static_cast<std::streamsize>(file.bytes.size()));
    ASSERT_TRUE(scene::import_scene(path, {})) << file.name;
    const long failures = fail_each_allocation(4096, [&](long which) {
      const auto scene = scene::import_scene(path, {});
      if (scene) return;  // the last time, where none failed
      EXPECT_EQ(scene.error().code, ErrorCode::kBuildFailed)
          << file.name << ", " << which << ": " << scene.error().message();
      EXPECT_TRUE(scene.error().message().ends_with("out of memory")) << scene.error().message();
    });
    EXPECT_GE(failures, 2) << file.name;
  }
  std::filesystem::remove_all(folder);
}

/// A .gltf of a triangle and `bytes` of the same value, again and again, in its extras.
std::string gltf_of_many(const std::string& value, std::size_t bytes) {
  std::string text = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAA)"
                     R"(AACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
                     R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
                     R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],)"
                     R"("scenes":[{"nodes":[0]}],"scene":0,"extras":[)";
  while (text.size() < bytes) text += value + ",";
  return text + "0]}";
}

/// The most memory that `body` takes at once, the file's text as it is mapped included, per byte of the text.
template <class Body>
double bytes_per_byte(const std::string& text, const Body& body) {
  held = most_held = 0;
  body();
  return static_cast<double>(most_held) / static_cast<double>(text.size()) + 1.0;
}

TEST(Memory, OfADocumentIsAtMost16BytesPerByteOfText) {
  const auto path = std::filesystem::temp_directory_path() / ("meshlode-many-" + std::to_string(::getpid()) + ".gltf");
  const std::string nested = std::string(100, '[') + std::string(100, ']');
  // Values that are nested and hold nothing else take 16 bytes per byte for the tree, and their counts or text besides.
  for (const auto& [value, most_parsed, most_imported] :
       std::vector<std::tuple<std::string, double, double>>{{"0", 9.5, 16.0},
                                                            {"{}", 9.5, 16.0},
                                                            {"\"a\"", 13.1, 16.0},
                                                            {"[0]", 14.1, 16.0},
                                                            {"{\"a\":0}", 13.1, 16.0},
                                                            {"{\"a\":\"b\"}", 13.6, 16.0},
                                                            {nested, 20.0, 20.0}}) {
    const std::string text = gltf_of_many(value, 2'000'000);
    EXPECT_LE(bytes_per_byte(text, [&] { EXPECT_TRUE(scene::parse_json(text)); }), most_parsed) << value;
    std::ofstream(path, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
    EXPECT_LE(bytes_per_byte(text, [&] { EXPECT_TRUE(scene::import_scene(path, {})); }), most_imported) << value;
  }
  std::filesystem::remove(path);
  // What is no JSON takes no more, whatever its commas announce.
  for (const char* start : {"[", "{", "{\"a\":[", "[0", "{\"a\":0"}) {
    const std::string text = start + std::string(2'000'000, ',');
    EXPECT_LE(bytes_per_byte(text, [&] { EXPECT_FALSE(scene::parse_json(text)); }), 16.0) << start;
  }
  std::string nests;
  for (int depth = 0; depth < 5; ++depth) nests += "{\"a\":";
  for (int depth = 0; depth < 5; ++depth) nests += std::string(400'000, ',') + '}';
  EXPECT_LE(bytes_per_byte(nests, [&] { EXPECT_FALSE(scene::parse_json(nests)); }), 16.0);
}

TEST(OutOfMemory, ACopyOfADocumentIsUndone) {
  const auto json = scene::parse_json(R"({"a long name of a member": [null, 1, -2.5, true, "a text that is not short",
                                          {"another long name of one": ["and another text, inside"]}]})");
  ASSERT_TRUE(json);
  long thrown = 0;
  const long failures = fail_each_allocation(0, [&](long) {
    try {
      // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): that the copy fails is what is tested.
      const scene::Json copy = *json;
    } catch (const std::bad_alloc&) {
      ++thrown;
    }
  });
  EXPECT_GT(failures, 5);
  EXPECT_EQ(thrown, failures);
}

}  // namespace
}  // namespace meshlode::testing
