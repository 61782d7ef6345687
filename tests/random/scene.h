// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes nobody chose: a seed is a scene and the options to build it with. Writing it as a GLB shares no code with the
// importer, the exporter or the samples.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/vec.h"

namespace meshlode::test {

/// Attributes are empty or as long as `positions`.
struct RandomPrimitive {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uvs;
  std::vector<Vec4f> colors;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t material = 0;
};

struct RandomMesh {
  std::vector<RandomPrimitive> primitives;
};

struct RandomMaterial {
  bool is_textured = false, is_masked = false, is_double_sided = false;
};

struct RandomInstance {
  std::uint32_t mesh = 0;
  std::array<double, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};  ///< column-major
};

struct RandomScene {
  std::vector<RandomMesh> meshes;
  std::vector<RandomMaterial> materials;
  std::vector<RandomInstance> instances;
  std::vector<std::string> build_options;  ///< arguments of `meshlode build` beside input and output
  std::string contents;                    ///< the kinds of pieces, for people

  [[nodiscard]] std::uint64_t triangle_count() const;
};

/// One to three meshes of one to four primitives, each of one to three damaged pieces at sizes from 1e-3 to 30, with
/// seams, materials, instances and build options. Nine of ten seeds have fewer than 2,000 triangles, the rest fewer
/// than 50,000. The same on every machine and with every compiler.
[[nodiscard]] RandomScene random_scene(std::uint64_t seed);

/// Where the harm of a scene's pieces comes from.
enum class Harm {
  kDamage,   ///< pieces of all kinds, damaged (shapes.h): random_scene(seed)
  kSurgery,  ///< good surfaces, operated on (surgery.h)
  kLayers,   ///< none: good surfaces closely above one another (layers.h), of 2,000 to 8,000 triangles
};
/// The same, with harm of the kind; a seed is another scene for each.
[[nodiscard]] RandomScene random_scene(std::uint64_t seed, Harm harm);

/// The scene of one piece alone, undamaged, of about so many triangles: what kinds cost is compared with it. `torn`
/// gives every corner texture coordinates of its own. \pre kind < shape_kinds().size()
[[nodiscard]] RandomScene scene_of_one_piece(std::size_t kind, std::uint32_t triangles, bool torn);

/// glTF 2.0 in one binary file. Empty primitives and meshes are left out, and so are instances of such meshes.
[[nodiscard]] std::vector<std::uint8_t> write_glb(const RandomScene& scene);

}  // namespace meshlode::test
