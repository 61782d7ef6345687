// SPDX-License-Identifier: GPL-3.0-or-later
// fuzz_seeds FOLDER: writes the valid inputs that fuzzing starts from: FOLDER/{reader,judge,importer,codecs}/*.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "import/mutant_seeds.h"
#include "read/asset.h"
#include "support/sample_asset.h"

namespace {

using namespace meshlode;
using Bytes = std::vector<std::uint8_t>;

void write(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// The stored bytes of a page as the codec harness wants them.
Bytes codec_input(const Asset& asset, PageId page) {
  const format::PageRecord& record = asset.pages()[page.value];
  const format::MeshRecord& mesh = asset.meshes()[asset.groups()[record.first_group].mesh];
  const std::uint32_t shape = (mesh.normal_mode == format::NormalMode::kStored ? 1U : 0U) | mesh.uv_set_count << 1U |
                              mesh.has_color << 4U | (mesh.material == format::kNone ? 32U : 0U);
  Bytes bytes = {static_cast<std::uint8_t>(2U + static_cast<std::uint32_t>(record.codec)), static_cast<std::uint8_t>(shape),
                 static_cast<std::uint8_t>(record.cluster_count - 1U), static_cast<std::uint8_t>(record.bytes),
                 static_cast<std::uint8_t>(record.bytes >> 8U)};
  const auto stored = asset.stored_page(page);
  bytes.insert(bytes.end(), stored.begin(), stored.end());
  return bytes;
}

Bytes importer_input(const testing::SeedFile& seed) {
  const std::string extension = seed.name.substr(seed.name.find_last_of('.') + 1);
  Bytes bytes;
  std::string body = seed.bytes;
  if (body.starts_with("glTF")) {
    std::uint32_t size = 0;
    std::memcpy(&size, body.data() + 12, 4);
    if (size > 0xFFFF) return {};
    bytes = {0, static_cast<std::uint8_t>(size), static_cast<std::uint8_t>(size >> 8U)};
    body.erase(20 + size, 8);  // the second chunk's head
    body.erase(0, 20);
  } else {
    bytes = {static_cast<std::uint8_t>(extension == "gltf" ? 1 : extension == "ply" ? 2 : extension == "obj" ? 3 : 4)};
  }
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "fuzz_seeds FOLDER\n");
    return 1;
  }
  const std::filesystem::path folder = argv[1];
  const struct {
    const char* name;
    format::Codec codec;
  } codecs[] = {{"none", format::Codec::kNone}, {"lz4", format::Codec::kLz4}, {"zstd", format::Codec::kZstd},
                 {"strips", format::Codec::kStrips}, {"draco", format::Codec::kDraco}};
  for (const auto& [name, codec] : codecs) {
    const std::string suffix = std::string("-") + name + ".lode";
    const std::pair<const char*, Bytes> assets[] = {
        {"tetrahedron", test::asset_bytes_of(test::sample_tetrahedron(), codec)},
        {"patch", test::asset_bytes_of(test::sample_patch(), codec)},
        {"scene", test::sample_asset_bytes(codec)}};
    for (const auto& [shape, bytes] : assets) {
      write(folder / "reader" / (shape + suffix), bytes);
      write(folder / "judge" / (shape + suffix), bytes);
      const auto asset = Asset::from_bytes(bytes);
      if (!asset) return 2;
      for (std::size_t p = 0; p < asset->pages().size() && codec != format::Codec::kNone; ++p) {
        write(folder / "codecs" / (std::string(shape) + "-" + name + "-" + std::to_string(p)),
              codec_input(*asset, PageId(p)));
      }
    }
  }
  std::size_t index = 0;
  for (const testing::SeedFile& seed : testing::make_seed_files()) {
    const Bytes bytes = importer_input(seed);
    if (!bytes.empty()) write(folder / "importer" / (std::to_string(index++) + "-" + seed.name), bytes);
  }
  return 0;
}
