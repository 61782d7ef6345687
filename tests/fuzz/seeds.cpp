// SPDX-License-Identifier: GPL-3.0-or-later
// fuzz_seeds FOLDER: writes the valid inputs that fuzzing starts from, FOLDER/HARNESS/*.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "draw/textures/image_samples.h"
#include "format/names.h"
#include "run/read/asset.h"
#include "scene/import/mutant_seeds.h"
#include "stored_seeds.h"
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
Bytes codec_input(const run::Asset& asset, PageId page) {
  const format::PageRecord& record = asset.pages()[page.value];
  const format::MeshRecord& mesh = asset.meshes()[asset.groups()[record.first_group].mesh];
  const std::uint32_t shape = (mesh.normal_mode == format::NormalMode::kStored ? 1U : 0U) | mesh.uv_set_count << 1U |
                              mesh.has_color << 4U | (mesh.material == format::kNone ? 32U : 0U);
  Bytes bytes = {static_cast<std::uint8_t>(2U + static_cast<std::uint32_t>(record.codec)),
                 static_cast<std::uint8_t>(shape), static_cast<std::uint8_t>(record.cluster_count - 1U),
                 static_cast<std::uint8_t>(record.bytes), static_cast<std::uint8_t>(record.bytes >> 8U)};
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

/// Images of the kinds that are read.
std::vector<std::pair<std::string, Bytes>> make_images() {
  std::vector<std::pair<std::string, Bytes>> images;
  Bytes pixels(std::size_t{4} * 21 * 13);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * i / 7 + i);
  const struct {
    const char* name;
    test::PngKind kind;
    std::uint32_t row_bytes;
  } kinds[] = {{"grey1", {.color_type = 0, .bit_depth = 1}, 3},
               {"palette", {.color_type = 3, .bit_depth = 4, .has_transparency = true}, 11},
               {"rgb", {.color_type = 2}, 63},
               {"rgba-interlaced", {.color_type = 6, .is_interlaced = true}, 84}};
  for (const auto& [name, kind, row_bytes] : kinds) {
    Bytes rows(pixels.begin(), pixels.begin() + std::ptrdiff_t{13} * row_bytes);
    images.emplace_back(std::string("image-") + name + ".png", test::make_png(21, 13, kind, rows));
  }
  for (const int components : {1, 3}) {
    for (const bool is_progressive : {false, true}) {
      const Bytes part(pixels.begin(), pixels.begin() + std::ptrdiff_t{21} * 13 * components);
      images.emplace_back("image-" + std::to_string(components) + (is_progressive ? "-progressive.jpg" : ".jpg"),
                          test::make_jpeg(21, 13, components, is_progressive, part));
    }
  }
  const Bytes part(pixels.begin(), pixels.begin() + std::ptrdiff_t{4} * 21 * 13);
  for (const bool is_lossless : {true, false}) {
    images.emplace_back(is_lossless ? "image-lossless.webp" : "image-lossy.webp",
                        test::make_webp(21, 13, is_lossless, part));
  }
  return images;
}

/// The sample scene with textures, normals and masks on its materials.
scene::Scene textured_scene(const std::vector<std::pair<std::string, Bytes>>& images) {
  scene::Scene scene = test::sample_scene();
  scene::SceneBlob buffer = scene.blobs[1];
  scene.blobs.clear();
  std::string listed, textures;
  for (const auto& [name, bytes] : images) {
    const std::string index = std::to_string(scene.blobs.size());
    scene::SceneBlob blob;
    blob.name = name;
    blob.bytes = bytes;
    scene.blobs.push_back(blob);
    listed += (listed.empty() ? "" : ",") + std::string(R"({"blob":)") + index + "}";
    textures += (textures.empty() ? "" : ",") + std::string(R"({"sampler":0,"source":)") + index + "}";
  }
  scene.blobs.push_back(buffer);
  std::string materials;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    scene.materials[i].source_index = static_cast<std::uint32_t>(i);
    scene.materials[i].base_color_texture = static_cast<std::uint32_t>(i);
    scene.materials[i].base_color_uv_set = 0;
    scene.materials[i].alpha_mode = i % 2 == 0 ? scene::AlphaMode::kMask : scene::AlphaMode::kOpaque;
    const std::string texture = std::to_string(i % images.size()), normal = std::to_string((i + 2) % images.size());
    materials +=
        (materials.empty() ? "" : ",") + std::string(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":)") +
        texture +
        R"(,"extensions":{"KHR_texture_transform":{"scale":[2,0.5],"rotation":1}}}},"normalTexture":{"index":)" +
        normal + R"(,"scale":0.5}})";
  }
  scene.document = R"({"asset":{"version":"2.0"},"samplers":[{"wrapS":33648,"wrapT":33071}],"images":[)" + listed +
                   R"(],"textures":[)" + textures + R"(],"materials":[)" + materials + "]}";
  return scene;
}

Bytes behind(Bytes prefix, std::span<const std::uint8_t> bytes) {
  prefix.insert(prefix.end(), bytes.begin(), bytes.end());
  return prefix;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "fuzz_seeds FOLDER\n");
    return 1;
  }
  const std::filesystem::path folder = argv[1];
  const auto images = make_images();
  for (const auto& [name, bytes] : images) write(folder / "textures" / name, behind({0}, bytes));
  const Bytes near_camera = {63, 47, 128, 150, 170, 12, 1, 10}, far_camera = {40, 30, 180, 140, 128, 20, 4, 3};
  for (const format::Codec codec : {format::Codec::kNone, format::Codec::kStrips}) {
    const std::string name = codec == format::Codec::kNone ? "textured-none.lode" : "textured-strips.lode";
    const Bytes textured = test::sample_asset_bytes(textured_scene(images), codec);
    write(folder / "textures" / name, behind({1}, textured));
    write(folder / "render" / name, behind(near_camera, textured));
    write(folder / "head" / name, behind({255, 0, 12, 3}, textured));
    // All sections that are optional.
    const std::string optional = codec == format::Codec::kNone ? "optional-none.lode" : "optional-strips.lode";
    const Bytes all = test::promised_asset_bytes(codec);
    for (const char* of : {"reader", "judge"}) write(folder / of / optional, all);
    write(folder / "head" / optional, behind({173, 0, 30, 8}, all));
    write(folder / "verify" / name, behind({0, 0, 0, 0, 0, 0, 0, 0}, textured));
  }
  for (const auto& [codec, name] : format::kCodecNames) {
    const std::string suffix = std::string("-") + name + ".lode";
    const std::pair<const char*, Bytes> assets[] = {
        {"tetrahedron", test::asset_bytes_of(test::sample_tetrahedron(), codec)},
        {"patch", test::asset_bytes_of(test::sample_patch(), codec)},
        {"scene", test::sample_asset_bytes(codec)}};
    for (const auto& [shape, bytes] : assets) {
      write(folder / "reader" / (shape + suffix), bytes);
      write(folder / "judge" / (shape + suffix), bytes);
      write(folder / "head" / (shape + suffix), behind({173, 0, 30, 8}, bytes));
      write(folder / "render" / (shape + suffix), behind(shape[0] == 't' ? near_camera : far_camera, bytes));
      if (shape[0] == 's') {
        write(folder / "verify" / (shape + suffix), behind({0, 0, 0, 0, 0, 0, 0, 0}, bytes));
        write(folder / "verify" / ("other-" + (shape + suffix)), behind({127, 1, 5, 2, 3, 9, 4, 3}, bytes));
      }
      const auto asset = run::Asset::from_bytes(bytes);
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
  for (const auto& [name, bytes] : fuzz::make_stored_seeds()) write(folder / "stored" / name, bytes);
  return 0;
}
