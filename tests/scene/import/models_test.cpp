// SPDX-License-Identifier: GPL-3.0-or-later
// Real models: each imports or is refused with the code it should; positions and indices of plain primitives equal
// those of a few lines of another reader (tests/independent judges all attributes); models stored plain and by Draco
// are alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "scene/import/import.h"

namespace meshlode::scene {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string models_folder() {
  const char* folder = std::getenv("MESHLODE_MODELS");
  return folder == nullptr ? "" : folder;
}
std::string assimp_folder() {
  const char* folder = std::getenv("MESHLODE_ASSIMP_MODELS");
  return folder == nullptr ? "/usr/share/assimp/models" : folder;
}

std::vector<fs::path> files_below(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

#define MESHLODE_NEEDS(folder, variable)                                         \
  if ((folder).empty() || !fs::exists(folder)) {                                 \
    const char* required = std::getenv("MESHLODE_REQUIRE_MODELS");               \
    if (required != nullptr && std::string(required) == "1") {                   \
      FAIL() << variable " names no folder and MESHLODE_REQUIRE_MODELS=1";       \
    }                                                                            \
    GTEST_SKIP() << "set " variable " to the folder of models to run this test"; \
  }

std::string read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void expect_sound(const Scene& scene, const std::string& name) {
  for (const SourceMesh& mesh : scene.meshes) {
    for (const Primitive& p : mesh.primitives) {
      ASSERT_EQ(p.indices.size() % 3, 0U) << name;
      for (const std::uint32_t i : p.indices) ASSERT_LT(i, p.positions.size()) << name;
      for (const Vec3d& v : p.positions) {
        ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) << name;
      }
      ASSERT_TRUE(p.normals.empty() || p.normals.size() == p.positions.size()) << name;
      for (const auto& set : p.uvs) ASSERT_TRUE(set.empty() || set.size() == p.positions.size()) << name;
      ASSERT_TRUE(p.colors.empty() || p.colors.size() == p.positions.size()) << name;
      ASSERT_LT(p.material.value, scene.materials.size()) << name;
    }
  }
  for (const SceneInstance& i : scene.instances) ASSERT_LT(i.mesh.value, scene.meshes.size()) << name;
}

/// The other reader: GLB or external/base64 buffers, plain float positions and integer indices, nothing else.
struct PlainReader {
  json root;
  std::vector<std::string> buffers;

  explicit PlainReader(const fs::path& path) {
    const std::string bytes = read_file(path);
    std::string text = bytes;
    std::string bin;
    if (bytes.compare(0, 4, "glTF") == 0) {
      std::uint32_t size = 0;
      std::memcpy(&size, bytes.data() + 12, 4);
      text = bytes.substr(20, size);
      if (bytes.size() > 28 + size) bin = bytes.substr(28 + size);
    }
    root = json::parse(text);
    for (const json& buffer : root.value("buffers", json::array())) {
      const std::string uri = buffer.value("uri", "");
      if (uri.empty()) {
        buffers.push_back(bin);
      } else if (uri.compare(0, 5, "data:") == 0) {
        buffers.push_back(base64(uri.substr(uri.find(',') + 1)));
      } else {
        buffers.push_back(read_file(path.parent_path() / uri));
      }
    }
  }
  static std::string base64(const std::string& text) {
    const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    unsigned bits = 0, count = 0;
    for (const char c : text) {
      const std::size_t digit = alphabet.find(c);
      if (digit == std::string::npos) break;
      bits = bits * 64 + static_cast<unsigned>(digit);
      count += 6;
      if (count >= 8) out += static_cast<char>(bits >> (count -= 8) & 0xFF);
      bits &= 0xFFFF;
    }
    return out;
  }
  [[nodiscard]] const char* at(const json& accessor, std::size_t i, std::size_t size) const {
    const json& view = root["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t stride = view.value("byteStride", size);
    return buffers[view["buffer"].get<std::size_t>()].data() + view.value("byteOffset", std::size_t{0}) +
           accessor.value("byteOffset", std::size_t{0}) + i * stride;
  }
  [[nodiscard]] std::vector<Vec3d> positions_of_corners(const json& primitive) const {
    const json& position = root["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    std::vector<std::size_t> corners(position["count"].get<std::size_t>());
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = i;
    if (primitive.contains("indices")) {
      const json& indices = root["accessors"][primitive["indices"].get<std::size_t>()];
      const int type = indices["componentType"];
      corners.resize(indices["count"].get<std::size_t>());
      for (std::size_t i = 0; i < corners.size(); ++i) {
        std::uint32_t value = 0;
        const std::size_t size = type == 5121 ? 1 : type == 5123 ? 2 : 4;
        std::memcpy(&value, at(indices, i, size), size);
        corners[i] = value;
      }
    }
    std::vector<Vec3d> out;
    for (const std::size_t corner : corners) {
      float xyz[3];
      std::memcpy(xyz, at(position, corner, 12), 12);
      out.emplace_back(xyz[0], xyz[1], xyz[2]);
    }
    return out;
  }
};

bool is_plain(const json& root, const json& primitive) {
  if (primitive.value("mode", 4) != 4 || !primitive["attributes"].contains("POSITION")) return false;
  if (primitive.contains("extensions") && primitive["extensions"].contains("KHR_draco_mesh_compression")) return false;
  const json& position = root["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
  return position["componentType"] == 5126 && position.contains("bufferView") && !position.contains("sparse");
}

TEST(ImportModels, EveryModelImportsOrIsRefusedWithItsCode) {
  const std::string folder = models_folder();
  MESHLODE_NEEDS(folder, "MESHLODE_MODELS");
  const std::map<std::string, ErrorCode> refused = {
      {"cube_att.gltf", ErrorCode::kInvalid},          // a node with two parents
      {"SpecGlossVsMetalRough.gltf", ErrorCode::kIo},  // its images are not beside it
  };
  std::size_t imported = 0;
  for (const fs::path& path : files_below(folder, {".gltf", ".glb"})) {
    const auto scene = import_scene(path, {});
    const auto expected = refused.find(path.filename().string());
    if (scene) {
      ++imported;
      expect_sound(*scene, path.string());
      continue;
    }
    ASSERT_NE(expected, refused.end()) << scene.error().message();
    EXPECT_EQ(scene.error().code, expected->second) << scene.error().message();
  }
  EXPECT_GT(imported, 30U);
}

TEST(ImportModels, TheAssimpSetImportsOrIsRefusedWithItsCode) {
  const std::string folder = assimp_folder() + "/glTF2";
  MESHLODE_NEEDS(folder, "MESHLODE_ASSIMP_MODELS");
  const std::map<std::string, ErrorCode> refused = {{"BoxWithInfinites.glb", ErrorCode::kInvalid},
                                                    {"IncorrectVertexArrays/Cube.gltf", ErrorCode::kInvalid},
                                                    {"AllIndicesOutOfRange.gltf", ErrorCode::kInvalid},
                                                    {"IndexOutOfRange.gltf", ErrorCode::kInvalid},
                                                    {"MissingBin/BoxTextured.gltf", ErrorCode::kIo},
                                                    {"RecursiveNodes.gltf", ErrorCode::kInvalid},
                                                    {"sceneWrongType.gltf", ErrorCode::kInvalid},
                                                    {"NoScene.gltf", ErrorCode::kInvalid},
                                                    {"badArray.gltf", ErrorCode::kInvalid},
                                                    {"badNumber.gltf", ErrorCode::kInvalid},
                                                    {"badObject.gltf", ErrorCode::kInvalid},
                                                    {"badString.gltf", ErrorCode::kInvalid},
                                                    {"badUint.gltf", ErrorCode::kInvalid}};
  for (const fs::path& path : files_below(folder, {".gltf", ".glb"})) {
    const auto scene = import_scene(path, {});
    ErrorCode expected{};
    for (const auto& [suffix, code] : refused) {
      if (path.string().ends_with(suffix)) expected = code;
    }
    if (scene) {
      EXPECT_EQ(expected, ErrorCode{}) << path;
      expect_sound(*scene, path.string());
    } else {
      EXPECT_EQ(scene.error().code, expected) << scene.error().message();
    }
  }
}

TEST(ImportModels, RepairGetsTheBrokenAssimpModelsThrough) {
  const std::string folder = assimp_folder() + "/glTF2";
  MESHLODE_NEEDS(folder, "MESHLODE_ASSIMP_MODELS");
  for (const std::string name : {"BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb",
                                 "IndexOutOfRange/AllIndicesOutOfRange.gltf", "IndexOutOfRange/IndexOutOfRange.gltf"}) {
    const auto scene = import_scene(folder + "/" + name, {.repair = true});
    ASSERT_TRUE(scene) << scene.error().message();
    expect_sound(*scene, name);
    EXPECT_GT(scene->meshes[0].drops.repaired, 0U) << name;
  }
}

TEST(ImportModels, AssimpsPlyObjAndStlFilesAreSoundScenesOrErrorsWithAReason) {
  const std::string folder = assimp_folder();
  MESHLODE_NEEDS(folder, "MESHLODE_ASSIMP_MODELS");
  std::size_t imported = 0;
  for (const std::string sub : {"PLY", "OBJ", "STL"}) {
    if (!fs::exists(folder + "/" + sub)) continue;
    for (const fs::path& path : files_below(folder + "/" + sub, {".ply", ".obj", ".stl"})) {
      for (const bool repair : {false, true}) {
        const auto scene = import_scene(path, {.repair = repair});
        if (scene) {
          ++imported;
          expect_sound(*scene, path.string());
        } else {
          EXPECT_FALSE(scene.error().detail.empty()) << path;
        }
      }
    }
  }
  EXPECT_GT(imported, 0U);
}

TEST(ImportModels, PositionsAndIndicesEqualAnIndependentReadersOnEveryPlainPrimitive) {
  const std::string folder = models_folder();
  MESHLODE_NEEDS(folder, "MESHLODE_MODELS");
  std::size_t compared = 0;
  for (const fs::path& path : files_below(folder, {".gltf", ".glb"})) {
    const auto scene = import_scene(path, {});
    if (!scene) continue;
    const PlainReader other(path);
    const json& meshes = other.root["meshes"];
    ASSERT_EQ(scene->meshes.size(), meshes.size());
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const json& primitives = meshes[m]["primitives"];
      if (scene->meshes[m].primitives.size() != primitives.size()) continue;  // points or lines among them
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        if (!is_plain(other.root, primitives[p])) continue;
        const Primitive& ours = scene->meshes[m].primitives[p];
        const auto theirs = other.positions_of_corners(primitives[p]);
        ASSERT_EQ(ours.indices.size(), theirs.size() / 3 * 3) << path;
        for (std::size_t i = 0; i < ours.indices.size(); ++i) {
          ASSERT_EQ(ours.positions[ours.indices[i]], theirs[i]) << path << " corner " << i;
        }
        compared += ours.indices.size() / 3;
      }
    }
  }
  EXPECT_GT(compared, 1000000U);
}

/// A triangle with its corners' normals, in a list that is sorted by the x of its centre.
struct LooseTriangle {
  double x;
  std::array<Vec3d, 3> corners, normals;
};

std::vector<LooseTriangle> loose_triangles(const SourceMesh& mesh) {
  std::vector<LooseTriangle> out;
  for (const Primitive& p : mesh.primitives) {
    for (std::size_t t = 0; t < p.indices.size(); t += 3) {
      LooseTriangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        triangle.corners[k] = p.positions[p.indices[t + k]];
        triangle.normals[k] = Vec3d(p.normals[p.indices[t + k]]);
        triangle.x += triangle.corners[k].x / 3.0;
      }
      out.push_back(triangle);
    }
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  return out;
}

/// Whether `b` is `a` with corners within `far` and normals within `turn`, in some rotation.
bool is_near(const LooseTriangle& a, const LooseTriangle& b, double far, double turn) {
  for (std::size_t shift = 0; shift < 3; ++shift) {
    bool is_same = true;
    for (std::size_t k = 0; k < 3; ++k) {
      is_same = is_same && glm::length(a.corners[k] - b.corners[(k + shift) % 3]) <= far &&
                glm::length(a.normals[k] - b.normals[(k + shift) % 3]) <= turn;
    }
    if (is_same) return true;
  }
  return false;
}

std::size_t count_without_partner(const std::vector<LooseTriangle>& from, const std::vector<LooseTriangle>& to,
                                  double far, double turn, bool may_collapse) {
  std::size_t alone = 0;
  for (const LooseTriangle& a : from) {
    const auto first =
        std::lower_bound(to.begin(), to.end(), a.x - far, [](const auto& t, double x) { return t.x < x; });
    bool found = false;
    for (auto b = first; b != to.end() && b->x <= a.x + far && !found; ++b) found = is_near(a, *b, far, turn);
    for (std::size_t k = 0; k < 3 && may_collapse && !found; ++k) {
      found = glm::length(a.corners[k] - a.corners[(k + 1) % 3]) <= 2.0 * far;
    }
    alone += found ? 0 : 1;
  }
  return alone;
}

/// Models that their makers stored both ways. Draco's encoder drops triangles that quantization collapses.
void expect_same_model(const fs::path& plain_path, const fs::path& draco_path, std::size_t least) {
  const auto plain = import_scene(plain_path, {});
  const auto draco = import_scene(draco_path, {});
  ASSERT_TRUE(plain) << plain.error().message();
  ASSERT_TRUE(draco) << draco.error().message();
  ASSERT_EQ(plain->meshes.size(), draco->meshes.size());
  std::size_t compared = 0;
  for (std::size_t m = 0; m < plain->meshes.size(); ++m) {
    const auto ours = loose_triangles(draco->meshes[m]);
    const auto theirs = loose_triangles(plain->meshes[m]);
    Vec3d low(HUGE_VAL);
    Vec3d high(-HUGE_VAL);
    for (const LooseTriangle& t : theirs) {
      for (const Vec3d& p : t.corners) {
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
    }
    // 11 bits along the longest side, and what 8 octahedral bits make of a normal, a little over a degree: the coarsest
    // that such files are made with.
    const Vec3d size = high - low;
    const double far = 0.51 * std::sqrt(3.0) * std::max({size.x, size.y, size.z}) / 2047.0;
    EXPECT_EQ(count_without_partner(ours, theirs, far, 0.02, false), 0U) << draco_path << " mesh " << m;
    EXPECT_EQ(count_without_partner(theirs, ours, far, 0.02, true), 0U) << draco_path << " mesh " << m;
    compared += ours.size();
  }
  EXPECT_GE(compared, least);
}

TEST(ImportModels, AModelStoredPlainAndByDracoHasTheSameTrianglesAndNormals) {
  const std::string folder = models_folder();
  MESHLODE_NEEDS(folder, "MESHLODE_MODELS");
  const std::string box = folder + "/draco/Box/glTF_Binary/";
  expect_same_model(box + "Box.glb", box + "Box_Draco.glb", 12);
}

TEST(ImportModels, AnEngineOfTwentyNineMeshesStoredPlainAndByDracoHasTheSameTrianglesAndNormals) {
  const std::string folder = assimp_folder() + "/glTF2";
  MESHLODE_NEEDS(folder, "MESHLODE_ASSIMP_MODELS");
  expect_same_model(folder + "/2CylinderEngine-glTF-Binary/2CylinderEngine.glb", folder + "/draco/2CylinderEngine.gltf",
                    60000);
}

}  // namespace
}  // namespace meshlode::scene
