// SPDX-License-Identifier: GPL-3.0-or-later
// The build half of meshlode: arrays in memory, or a scene file, become the bytes of a .lode asset.
//
//   meshlode::PrimitiveInput primitive{.positions = positions, .indices = indices};
//   meshlode::MeshInput mesh{.name = "rock", .primitives = {&primitive, 1}};
//   auto bytes = meshlode::build_asset({.meshes = {&mesh, 1}}, {});
//   if (!bytes) puts(bytes.error().message().c_str());
//
// Ownership. Inputs are views: the caller keeps the arrays alive and unchanged until the call returns; nothing is kept
// afterwards. Outputs are owned by the caller.
//
// Errors. Every input is checked before it is used: sizes that do not fit, indices out of range, numbers that are not
// finite → ErrorCode::kInvalid with a place such as "meshes[0].primitives[2].indices[17]". kUsage: an option that makes
// no sense, with its name ("BuildOptions::grid_step"). kUnsupported: a budget or grid that needs more bits than the
// format has, a mesh with more triangles than ids (docs/log/build-time.md). kBuildFailed: cancelled, out of memory, or
// more memory needed than allowed. kIo: only from the functions that touch files. No exception leaves.
//
// Determinism (I10). The same input and options give the same bytes for any number of threads, and for builds that run
// at the same time.
//
// Thread safety. Builds may run in several threads at once. Callbacks are called from one thread at a time for each
// build, not always the same thread, and must not call back into the same build.
//
// Not promised: the bytes of another version of this library; the order or number of progress events.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

namespace meshlode {

/// "No material": the default one, opaque white.
constexpr std::uint32_t kDefaultMaterial = format::kNone;

/// A triangle list with one material. n vertices, m triangles; exactly one of the two position arrays is given.
struct PrimitiveInput {
  std::span<const float> positions;          ///< 3n: x y z, mesh space
  std::span<const double> positions_double;  ///< 3n: instead of `positions`, for meshes far from their origin
  std::span<const float> normals;            ///< 3n, need not be unit length; empty: flat shading is meant
  std::array<std::span<const float>, format::kMaxUvSets> uvs;  ///< 2n each; empty: no such set. Set k is TEXCOORD_k
  std::span<const float> colors;              ///< 4n: r g b a, linear, clamped to 0 … 1; empty: white
  std::span<const std::uint32_t> indices;     ///< 3m, counter-clockwise seen from outside, each below n
  std::uint32_t material = kDefaultMaterial;  ///< into SceneInput::materials
};

/// One DAG is built across all primitives: there are no cracks between them in any cut.
struct MeshInput {
  std::string_view name;                       ///< UTF-8
  std::span<const PrimitiveInput> primitives;  ///< none: an empty mesh
};

struct MaterialInput {
  std::string_view name;
  std::array<float, 4> base_color{1.0F, 1.0F, 1.0F, 1.0F};  ///< linear
  format::AlphaMode alpha_mode = format::AlphaMode::kOpaque;
  float alpha_cutoff = 0.5F;  ///< for kMask
  bool double_sided = false;
  /// Bit k: the caller's shaders sample TEXCOORD_k with this material. Sets that no material of a mesh uses are not
  /// stored, unless BuildOptions::attributes is AttributeChoice::kAll.
  std::uint32_t uv_sets_used = 0xF;
};

struct InstanceInput {
  std::string_view name;
  std::uint32_t mesh = 0;  ///< into SceneInput::meshes
  /// Mesh space to world, column-major 4×4 (element 12 … 14 is the translation); the last row is 0 0 0 1. Mirrored
  /// and singular ones are allowed, and marked in the asset.
  std::array<double, 16> transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
};

struct SceneInput {
  std::string_view name;  ///< what the asset calls its source, such as a file's base name
  std::span<const MeshInput> meshes;
  std::span<const MaterialInput> materials;
  std::span<const InstanceInput> instances;  ///< empty: each mesh is drawn once, as it is
};

struct BuildProgress {
  double fraction = 0.0;  ///< of the whole build, 0 … 1, never falling within a build
  std::uint32_t mesh = 0;
  std::uint32_t mesh_count = 0;
  std::uint32_t level = 0;      ///< DAG level just finished
  std::uint64_t triangles = 0;  ///< of that level
  std::string_view mesh_name;   ///< valid during the call
};

/// Which attributes of the source the asset may carry.
enum class AttributeChoice : std::uint8_t {
  kAuto,  ///< what the materials can show
  kNone,  ///< positions alone
  kAll,   ///< everything that the source has and the format can hold
};

/// Attributes as bits of a set: BuildOptions::keep and BuildOptions::drop.
constexpr std::uint32_t kAttributeNormal = 1;
/// TEXCOORD_n, n below format::kMaxUvSets.
constexpr std::uint32_t attribute_texcoord(std::uint32_t n) {
  return 2U << n;
}
constexpr std::uint32_t kAttributeColor = 32;
constexpr std::uint32_t kAllAttributes = 63;

/// The trade of build time for quality and bytes as one word.
enum class Preset : std::uint8_t {
  kFast,     ///< errors are estimated (kQem), topology is a little larger
  kDefault,  ///< errors are measured (kMeasured)
  kBest,     ///< as kDefault, with more effort for clusters and the fewest bytes
};

enum class UvErrorUnit : std::uint8_t {
  kUv,      ///< UV units
  kTexels,  ///< texels of the largest texture that a material of the mesh samples with the set; of 2,048 a side where
            ///< no texture's size is known, as in scenes from arrays
};

/// Which meshes are thinned out as aggregates (foliage, grass, soups): pieces are merged so that a picture stays as
/// much covered, where a simplifier would keep each of them. Errors of such a mesh are of coverage
/// (docs/guides/foliage.md).
enum class AggregateChoice : std::uint8_t {
  kNever,
  kAuto,    ///< meshes of many small loose pieces, and parts of meshes that are: the leaves of a tree, its trunk not.
            ///< A part is a mesh of the asset, "tree#leaves", behind those of the input (docs/guides/foliage.md)
  kAlways,  ///< all pieces of at most 512 triangles
  kNamed,   ///< those of BuildOptions::aggregate_names
};

/// How long fewer bytes a triangle are looked for: as a preset does.
enum class StripEffort : std::uint8_t { kOfPreset, kFast, kDefault, kBest };

/// What `meshlode build` can be told, under the names of its options: `--error-tier`, `--grid` and so on.
struct BuildOptions {
  std::optional<format::ErrorTier> error_tier;  ///< what the stored errors are worth; nothing: what the preset says
  Preset preset = Preset::kDefault;
  AttributeChoice attributes = AttributeChoice::kAuto;
  std::uint32_t keep = 0;  ///< attributes that are stored although `attributes` would not, where the source has them
  std::uint32_t drop = 0;  ///< attributes that are not stored although `attributes` would; none of `keep`'s
  double grid_step = 0.0;  ///< mesh units between grid points, for meshes that must abut; 0: from position_error
  double position_error = 0.0;  ///< mesh units that a vertex may move at most; 0: chosen, invisible. Not with grid_step
  double normal_error = 0.1;    ///< degrees, above 0 and up to 180, that a stored normal may be off at most
  double uv_error = 0.0;        ///< what a texture coordinate may move at most; 0: chosen, invisible
  UvErrorUnit uv_error_unit = UvErrorUnit::kUv;  ///< of uv_error
  format::Codec codec = format::Codec::kNone;    ///< of the pages on disk
  StripEffort strip_effort = StripEffort::kOfPreset;
  std::uint32_t cluster_triangles = 128;  ///< the most of a cluster, 1 to 256
  std::uint32_t group_clusters = 20;      ///< how many clusters are simplified together, about: 4 to 32
  /// Remove and count triangles that touch a bad index or non-finite position, instead of refusing them, that have two
  /// corners in one place, or the same three as an earlier one of their material; orient the rest coherently.
  bool repair = false;
  /// build_file: whole-number colours of PLY and STL are taken as linear, not as sRGB.
  bool linear_colors = false;
  /// build_file: folders besides the scene's own from which files may be read that the scene names.
  std::vector<std::filesystem::path> allow_outside;
  /// Every cut of a manifold mesh is a manifold, with its holes, handles and pieces: no edge has more than two
  /// triangles. Takes more triangles, since small holes and handles else close where that is far cheaper.
  bool keep_topology = false;
  /// Open borders (edges of one triangle of a mesh, by exact position) keep every vertex in every cut, so that tiles
  /// that are built apart with the same grid_step abut at any pair of levels. Of positions alone; takes more triangles.
  bool lock_borders = false;
  AggregateChoice aggregate = AggregateChoice::kNever;
  /// kNamed: names of meshes, of which all pieces of at most 512 triangles are thinned out, and of materials, of whose
  /// pieces the same holds; comma by comma, '*' is any characters and '?' is one.
  std::string aggregate_names;
  /// What errors the asset has, and so what a renderer may choose to keep (docs/reference/selection.md): with kTexels
  /// those of texture coordinates beside those of positions, with kAppearance those of normals too. Works with every
  /// tier.
  format::Promise promise = format::Promise::kPosition;
  std::uint64_t max_memory_bytes = 0;  ///< meshes wait for each other to keep it, or it is refused; 0: what is left
  /// Of build_file: what compressed geometry may take decoded beyond what the size of its file justifies.
  std::uint64_t max_decoded_bytes = std::uint64_t{512} << 20U;
  std::uint32_t thread_count = 0;  ///< `--jobs`: threads at most, up to 4,096; 0: what oneTBB gives the calling thread
  std::function<void(const BuildProgress&)> on_progress;  ///< may be empty
  std::function<bool()> should_cancel;  ///< asked between steps; true ends the build with kBuildFailed. May be empty
};

/// The bytes of an asset, as a .lode file holds them (and AssetFile::take opens them).
[[nodiscard]] Result<std::vector<std::uint8_t>> build_asset(const SceneInput& scene, const BuildOptions& options);

/// build_asset, then a file that appears whole or not at all.
[[nodiscard]] Status build_asset_file(const SceneInput& scene, const std::filesystem::path& output,
                                      const BuildOptions& options);

/// Reads a .gltf, .glb, .ply, .obj or .stl, builds it and writes the asset. Files that it refers to are read from
/// below its own folder and those of allow_outside only. Errors as above, kUnsupported for an extension that cannot be
/// done without, and kUsage where the output is one of the files that were read, by whatever name.
[[nodiscard]] Status build_file(const std::filesystem::path& input, const std::filesystem::path& output,
                                const BuildOptions& options);

}  // namespace meshlode
