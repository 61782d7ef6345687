// SPDX-License-Identifier: GPL-3.0-or-later
// The importer on any bytes, and what lists the files of a scene. The first byte chooses the kind of file, --repair,
// and whether all scenes are instanced and missing images allowed; what follows "#mtl" in an OBJ is its library, which
// names a picture that is there; a GLB comes as the length of its JSON, its JSON and
// its binary chunk, because a fuzzer would spend its time on the three lengths of the container.
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "harness.h"
#include "scene/import/import.h"

namespace {

using namespace meshlode;

std::string u32(std::size_t value) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) text += static_cast<char>(value >> shift);
  return text;
}

std::string assemble_glb(std::string_view input) {
  if (input.size() < 2) return std::string(input);
  const std::size_t wanted = static_cast<unsigned char>(input[0]) | static_cast<unsigned char>(input[1]) << 8U;
  input.remove_prefix(2);
  std::string json(input.substr(0, wanted));
  std::string bin(input.substr(json.size()));
  json.resize((json.size() + 3) / 4 * 4, ' ');
  bin.resize((bin.size() + 3) / 4 * 4, '\0');
  std::string glb = "glTF" + u32(2) + u32(28 + json.size() + bin.size());
  glb += u32(json.size()) + "JSON" + json + u32(bin.size()) + std::string("BIN\0", 4) + bin;
  return glb;
}

/// One folder a process, gone with it.
class Scratch {
 public:
  Scratch() {
    std::error_code none;
    std::filesystem::path root = "/dev/shm";  // in memory: a disk would be written to for each input
    if (const char* given = std::getenv("MESHLODE_FUZZ_TMP")) {
      root = given;
    } else if (!std::filesystem::is_directory(root, none)) {
      root = std::filesystem::temp_directory_path();
    }
    folder_ = root / ("meshlode-fuzz-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] std::filesystem::path write(const char* name, const std::string& bytes) const {
    const auto path = folder_ / name;
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

 private:
  std::filesystem::path folder_;
};

void require_sound(const scene::Scene& scene, bool is_repaired) {
  for (const scene::SourceMesh& mesh : scene.meshes) {
    for (const scene::Primitive& p : mesh.primitives) {
      const std::size_t n = p.positions.size();
      fuzz::require(p.indices.size() % 3 == 0, "indices are no triangles");
      for (const std::uint32_t i : p.indices) fuzz::require(i < n, "an index is no vertex");
      for (std::size_t i = 0; is_repaired && i < p.indices.size(); i += 3) {
        const Vec3d &a = p.positions[p.indices[i]], &b = p.positions[p.indices[i + 1]],
                    &c = p.positions[p.indices[i + 2]];
        fuzz::require(a != b && b != c && c != a, "a degenerate triangle");
      }
      for (const Vec3d& v : p.positions)
        fuzz::require(std::isfinite(v.x + v.y + v.z) || std::abs(v.x) > 1e300, "position");
      fuzz::require(p.normals.empty() || p.normals.size() == n, "normals");
      for (const auto& set : p.uvs) fuzz::require(set.empty() || set.size() == n, "uvs");
      fuzz::require(p.colors.empty() || p.colors.size() == n, "colors");
      fuzz::require(p.material.value < scene.materials.size(), "no such material");
    }
  }
  for (const scene::SceneInstance& i : scene.instances)
    fuzz::require(i.mesh.value < scene.meshes.size(), "no such mesh");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Scratch scratch;
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  constexpr const char* kNames[] = {"a.glb", "a.gltf", "a.ply", "a.obj", "a.stl"};
  const std::size_t kind = (data[0] & 0x3FU) % std::size(kNames);
  const std::size_t library = kind == 3 ? rest.find("#mtl\n") : std::string_view::npos;
  if (kind == 3)
    static_cast<void>(scratch.write("a.mtl", std::string(library < rest.size() ? rest.substr(library) : "")));
  if (kind == 2 || kind == 3) static_cast<void>(scratch.write("a.png", "\x89PNG\r\n"));
  const auto path = scratch.write(kNames[kind], kind == 0 ? assemble_glb(rest) : std::string(rest.substr(0, library)));
  const bool repair = (data[0] & 0x80U) != 0;
  const bool takes_all = (data[0] & 0x40U) != 0;
  const auto scene = meshlode::scene::import_scene(
      path, {.repair = repair, .scene = takes_all ? "all" : "", .may_lack_images = takes_all});
  if (scene) {
    require_sound(*scene, repair);
  } else {
    meshlode::fuzz::require(!scene.error().detail.empty(), "a refusal without a reason");
    meshlode::fuzz::require(!scene.error().detail.starts_with("internal error"), scene.error().detail.c_str());
  }
  const auto references = meshlode::scene::list_references(path);
  meshlode::fuzz::require(references || !references.error().detail.empty(), "a refusal without a reason");
  return 0;
}
