// SPDX-License-Identifier: GPL-3.0-or-later
// What import hands on: a whole scene in flat arrays, validated. Every index is in range and every position finite.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"

namespace meshlode::scene {

constexpr std::size_t kMaxUvSets = 4;

/// A triangle list with one material. Attribute arrays are empty or as long as `positions`.
struct Primitive {
  std::vector<Vec3d> positions;  ///< object units; double because PLY and far-away meshes have more than 24 bits
  std::vector<Vec3f> normals;    ///< empty: the source has none, flat normals are meant (glTF 2.0, 3.7.2.1)
  std::array<std::vector<Vec2f>, kMaxUvSets> uvs;  ///< TEXCOORD_0 … 3
  std::vector<Vec4f> colors;                       ///< COLOR_0, linear; alpha 1 where the source has none
  bool has_tangents = false;           ///< the source has TANGENT; tangents are not kept (the plan derives them)
  std::vector<std::uint32_t> indices;  ///< 3 per triangle, each < positions.size()
  MaterialId material;                 ///< into Scene::materials
};

/// Triangles that import removed, by kind. Nothing is dropped without being counted.
struct ImportDrops {
  /// --repair: triangles touching a non-finite position or an index out of range, degenerate ones and duplicates.
  std::uint64_t repaired = 0;
};

/// What --repair did to a mesh, by kind (repair/repair.h).
struct MeshRepairs {
  std::uint64_t degenerate = 0;  ///< triangles removed, part of ImportDrops::repaired: two corners in one place
  std::uint64_t duplicate = 0;   ///< triangles removed, part of it too: another of the material has the same corners
  std::uint64_t turned = 0;      ///< triangles whose orientation was reversed
  std::uint64_t stitched = 0;    ///< vertices replaced by an equal one
  std::uint64_t cut_edges = 0;   ///< edges of more than two triangles, taken apart
  std::uint64_t split = 0;       ///< vertices made because one had several fans of triangles
};

/// One glTF mesh: one DAG is built from all its primitives.
struct SourceMesh {
  std::string name;
  std::vector<Primitive> primitives;
  ImportDrops drops;
  MeshRepairs repairs;
  bool is_deformed = false;  ///< a skin or morph targets move its vertices: what it lies beside may be elsewhere
};

enum class AlphaMode : std::uint8_t { kOpaque, kMask, kBlend };

enum class TextureRole : std::uint8_t {
  kBaseColor,  ///< of metallic-roughness, or specular-glossiness's diffuse texture in its place
  kMetallicRoughness,
  kNormal,
  kOcclusion,
  kEmissive,
  kOther  ///< of an extension, known or not; also metallic-roughness beside specular-glossiness
};

/// A texture reference of a material: what samples which image, with which coordinates.
struct TextureUse {
  TextureRole role = TextureRole::kOther;
  std::uint32_t texture = kNoId;  ///< glTF texture index; kNoId where an unknown extension names none that exists
  std::uint32_t image = kNoId;    ///< glTF image index (base/gltf_textures.h); kNoId where the texture names none
  std::uint32_t blob = kNoId;     ///< in Scene::blobs: the image's bytes; kNoId where the source has none
  std::uint32_t uv_set = 0;       ///< TEXCOORD_n, KHR_texture_transform's where it names one; kMaxUvSets and more occur
  std::array<double, 2> offset{0.0, 0.0}, scale{1.0, 1.0};  ///< KHR_texture_transform
  double rotation = 0.0;                                    ///< the same, radians
};

/// The part of a material that the build and the renderer act on. The rest travels in Scene::document.
struct SceneMaterial {
  std::string name;
  std::uint32_t source_index = kNoId;  ///< glTF material index; kNoId for the default material
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  Vec4f base_color{1.0F, 1.0F, 1.0F, 1.0F};
  float alpha_cutoff = 0.5F;
  bool double_sided = false;
  std::uint32_t base_color_texture = kNoId;  ///< glTF texture index
  std::uint32_t base_color_uv_set = kNoId;   ///< TEXCOORD_n of the base colour texture
  std::uint32_t uv_sets_used = 0;  ///< bit n: some texture of the material (unknown extensions too) samples TEXCOORD_n
  bool needs_tangents = false;     ///< a normal map or anisotropy: shading has a direction along the surface
  std::vector<TextureUse> textures;  ///< every texture reference, in the order of the document
};

/// A node that draws a mesh, with its world transform composed in doubles.
struct SceneInstance {
  std::string name;
  std::uint32_t node = 0;  ///< of the document; behind the file's own nodes for instances of EXT_mesh_gpu_instancing
  MeshId mesh;
  Mat4d transform{1.0};  ///< mesh space to world, column-major
};

/// Bytes carried through as they were: an image, or a buffer that animations refer to.
struct SceneBlob {
  enum class Kind : std::uint8_t { kImage, kBuffer };
  Kind kind = Kind::kImage;
  std::string name;
  std::string mime_type;
  std::uint32_t source_index = 0;
  std::vector<std::uint8_t> bytes;
};

/// Something of the source that is not in the asset, with its reason: {"what": "skin 0", "why": "…"}.
struct LeftOut {
  std::string what;
  std::string why;
};

struct Scene {
  std::string source_name;  ///< base name of the file
  std::string choice;       ///< ImportOptions::scene: which scene of the file was asked for; empty: its default
  std::string source_hash;  ///< XXH3-128 in hex over the file and all it refers to, in order of reference
  std::vector<SourceMesh> meshes;
  std::vector<SceneMaterial> materials;  ///< glTF's in order; the default material last, where a primitive has none
  std::vector<SceneInstance> instances;  ///< depth first over the default scene, or the one that was chosen
  std::vector<SceneBlob> blobs;
  /// glTF-shaped JSON (asset, scene, scenes, nodes, materials, textures, samplers, images, cameras, animations, the
  /// accessors and bufferViews that animations use, extensions of the root): carried through unchanged except that
  /// `images[].blob` and `buffers[].blob` name entries of `blobs`, and geometry is gone. "{}" for formats without.
  std::string document = "{}";
  std::vector<LeftOut> left_out;
  /// Triangles that the file plainly holds, no fewer: counted by count/file_triangles.h from the file's bytes, whatever
  /// the importer made of them. Sound facets of an STL, and one for each face of PLY and OBJ with three different
  /// corners. 0 where the format does not tell (glTF).
  std::uint64_t triangles_in_file = 0;
};

}  // namespace meshlode::scene
