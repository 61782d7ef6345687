// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of a test's own, and a small scene of three files in it.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

namespace meshlode::app {

class BatchFolder {
 public:
  BatchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "meshlode-batch-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~BatchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  BatchFolder(const BatchFolder&) = delete;
  BatchFolder& operator=(const BatchFolder&) = delete;

  [[nodiscard]] std::filesystem::path path(const std::string& name = "") const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories(path(name).parent_path());
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  [[nodiscard]] static std::string text_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  /// NAME.gltf, NAME.bin and NAME.png: a plane of 2 n² triangles whose heights are of `seed`.
  std::filesystem::path write_scene(const std::string& name, std::uint32_t seed, std::uint32_t n = 6) const {
    std::string bin;
    const auto put = [&](const auto& value) { bin.append(reinterpret_cast<const char*>(&value), sizeof value); };
    std::uint32_t state = seed * 2654435761U + 1U;
    for (std::uint32_t y = 0; y <= n; ++y) {
      for (std::uint32_t x = 0; x <= n; ++x) {
        state = state * 1664525U + 1013904223U;
        put(static_cast<float>(x));
        put(static_cast<float>(y));
        put(static_cast<float>(state >> 16U) / 65536.0F);
      }
    }
    const std::size_t positions = bin.size();
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        const std::uint32_t a = y * (n + 1) + x;
        for (const std::uint32_t corner : {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1}) put(corner);
      }
    }
    write(name + ".bin", bin);
    write(name + ".png", "a picture of " + std::to_string(seed));
    const std::string leaf = name.substr(name.rfind('/') + 1);
    const auto number = [](std::size_t value) { return std::to_string(value); };
    return write(
        name + ".gltf",
        R"({"asset":{"version":"2.0"},"buffers":[{"uri":")" + leaf + R"(.bin","byteLength":)" + number(bin.size()) +
            R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + number(positions) + R"(},{"buffer":0,"byteOffset":)" +
            number(positions) + R"(,"byteLength":)" + number(bin.size() - positions) +
            R"(}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" + number(positions / 12) +
            R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)" +
            number((bin.size() - positions) / 4) + R"(}],"images":[{"uri":")" + leaf +
            R"(.png"}],"textures":[{"source":0}],"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
            R"("meshes":[{"primitives":[{"material":0,"indices":1,"attributes":{"POSITION":0}}]}],)"
            R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]})");
  }

 private:
  std::filesystem::path path_;
};

}  // namespace meshlode::app
