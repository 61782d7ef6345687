// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The builder: arrays in memory, or a scene file, become the bytes of a .lode asset.
///
/// \code
///   meshlode::PrimitiveInput primitive;
///   primitive.positions = positions;
///   primitive.indices = indices;
///   meshlode::MeshInput mesh;
///   mesh.primitives = {&primitive, 1};
///   meshlode::SceneInput scene;
///   scene.meshes = {&mesh, 1};
///   const auto bytes = meshlode::build_asset(scene, {});
///   if (!bytes) puts(bytes.error().message().c_str());
/// \endcode
///
/// Ownership. Inputs are views: the caller keeps the arrays alive and unchanged until the call returns. Nothing is kept
/// afterwards. Outputs are owned by the caller.
///
/// Errors. Every input is checked before it is used. ErrorCode::kInvalid: sizes that do not fit, indices out of range,
/// numbers that are not finite, with a place such as "meshes[0].primitives[2].indices[17]". kUsage: an option outside
/// its range, with its name ("BuildOptions::grid_step"). kUnsupported: a bound or grid that needs more bits than the
/// format has, or a mesh with more triangles than ids. kBuildFailed: cancelled, out of memory, or more memory needed
/// than allowed. kIo: from the functions that touch files. No exception leaves.
///
/// Determinism (I10). The same input and options give the same bytes for any number of threads, and for builds that run
/// at the same time.
///
/// Thread safety. Builds may run in several threads at once. Callbacks of one build are called by one thread at a time,
/// not always the same one, and must not call back into the same build.
///
/// Not promised: the bytes of another version of this library; the order or number of progress events; a stable ABI
/// before version 1 (docs/reference/compatibility.md).
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

/// A list of m triangles over n vertices with one material. Exactly one of the two position arrays is given.
struct PrimitiveInput {
  std::span<const float> positions;          ///< 3n: x y z, mesh space
  std::span<const double> positions_double;  ///< 3n: instead of `positions`, for meshes far from their origin
  std::span<const float> normals;            ///< 3n, need not be unit length; empty: flat shading
  std::array<std::span<const float>, format::kMaxUvSets> uvs;  ///< 2n each; set k is TEXCOORD_k; empty: no such set
  std::span<const float> colors;                               ///< 4n: r g b a, linear, clamped to 0 to 1; empty: white
  std::span<const std::uint32_t> indices;     ///< 3m, counter-clockwise seen from outside, each below n
  std::uint32_t material = kDefaultMaterial;  ///< into SceneInput::materials
};

/// A mesh. One DAG is built across all primitives: no cut has cracks between them.
struct MeshInput {
  std::string_view name;                       ///< UTF-8
  std::span<const PrimitiveInput> primitives;  ///< none: an empty mesh
};

/// A material, as far as the builder needs it.
struct MaterialInput {
  std::string_view name;                                      ///< UTF-8
  std::array<float, 4> base_color{1.0F, 1.0F, 1.0F, 1.0F};    ///< r g b a, linear
  format::AlphaMode alpha_mode = format::AlphaMode::kOpaque;  ///< how alpha is used
  float alpha_cutoff = 0.5F;                                  ///< for kMask
  bool double_sided = false;                                  ///< back faces are drawn
  /// Bit k: the caller's shaders sample TEXCOORD_k with this material. Sets that no material of a mesh uses are not
  /// stored, unless BuildOptions::attributes is AttributeChoice::kAll.
  std::uint32_t uv_sets_used = 0xF;
};

/// A mesh, drawn with a transform.
struct InstanceInput {
  std::string_view name;   ///< UTF-8
  std::uint32_t mesh = 0;  ///< into SceneInput::meshes
  /// Mesh space to world, column-major 4x4 (elements 12 to 14 are the translation); the last row is 0 0 0 1. Mirrored
  /// and singular ones are allowed, and marked in the asset.
  std::array<double, 16> transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
};

/// Everything that is built into one asset.
struct SceneInput {
  std::string_view name;                     ///< what the asset calls its source, such as a file's base name
  std::span<const MeshInput> meshes;         ///< its meshes
  std::span<const MaterialInput> materials;  ///< its materials
  std::span<const InstanceInput> instances;  ///< empty: each mesh is drawn once, as it is
};

/// A progress event.
struct BuildProgress {
  double fraction = 0.0;         ///< of the whole build, 0 to 1, never falling within a build
  std::uint32_t mesh = 0;        ///< the mesh in work
  std::uint32_t mesh_count = 0;  ///< meshes of the scene
  std::uint32_t level = 0;       ///< level of the DAG that was just finished
  std::uint64_t triangles = 0;   ///< of that level
  std::string_view mesh_name;    ///< valid during the call
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
/// COLOR_0.
constexpr std::uint32_t kAttributeColor = 32;
/// All of them.
constexpr std::uint32_t kAllAttributes = 63;

/// Build time against quality and bytes, as one word.
enum class Preset : std::uint8_t {
  kFast,     ///< errors are estimated (kQem), topology is a little larger
  kDefault,  ///< errors are measured (kMeasured)
  kBest,     ///< as kDefault, with more effort for clusters and the fewest bytes
};

/// Unit of BuildOptions::uv_error.
enum class UvErrorUnit : std::uint8_t {
  kUv,      ///< UV units
  kTexels,  ///< texels of the largest texture that a material of the mesh samples with the set; 2,048 per side if no
            ///< texture's size is known, as in scenes from arrays
};

/// Which meshes are simplified as aggregates (foliage, grass, debris): pieces are merged so that a picture stays as
/// much covered. Errors of such a mesh are of coverage (docs/guides/foliage.md).
enum class AggregateChoice : std::uint8_t {
  kNever,   ///< none
  kAuto,    ///< meshes of many small loose pieces, and parts of meshes: the leaves of a tree, not its trunk. A part
            ///< becomes a mesh of the asset, "tree#leaves", after those of the input
  kAlways,  ///< all pieces of at most 512 triangles
  kNamed,   ///< those of BuildOptions::aggregate_names
  kMasked,  ///< as kAuto, of pieces whose materials all have an alpha mask: masked cards
};

/// How groups follow each other inside a level, and so which of them share a page.
enum class PageOrder : std::uint8_t {
  kLevel,      ///< as the build made them: neighbours mostly lie together
  kCovisible,  ///< those together that the same views need; pages end where views load least
};

/// How much time to spend on shorter triangle strips. More effort: smaller topology, same geometry.
enum class StripEffort : std::uint8_t {
  kOfPreset,  ///< as BuildOptions::preset
  kFast,      ///< least time
  kDefault,   ///< as Preset::kDefault
  kBest,      ///< fewest bytes
};

/// Options of a build, under the names of `meshlode build`: `--error-tier`, `--grid` and so on.
struct BuildOptions {
  std::optional<format::ErrorTier> error_tier;          ///< what stored errors mean; none: what the preset says
  Preset preset = Preset::kDefault;                     ///< build time against quality
  AttributeChoice attributes = AttributeChoice::kAuto;  ///< what is stored
  std::uint32_t keep = 0;       ///< attributes to store although `attributes` would not, if the source has them
  std::uint32_t drop = 0;       ///< attributes not to store although `attributes` would; none of `keep`
  double grid_step = 0.0;       ///< mesh units between grid points, for meshes that must meet; 0: from position_error
  double position_error = 0.0;  ///< largest move of a vertex, mesh units; 0: chosen, invisible. Not with grid_step
  double normal_error = 0.1;    ///< largest error of a stored normal, degrees, above 0 to 180
  double uv_error = 0.0;        ///< largest move of a texture coordinate; 0: chosen, invisible
  UvErrorUnit uv_error_unit = UvErrorUnit::kUv;       ///< of uv_error
  format::Codec codec = format::Codec::kStrips;       ///< of the pages on disk: kStrips or kNone
  StripEffort strip_effort = StripEffort::kOfPreset;  ///< search effort for shorter strips
  std::uint32_t cluster_triangles = 128;              ///< maximum triangles per cluster, 1 to 256
  std::uint32_t group_clusters = 20;                  ///< target clusters per group, 4 to 32; groups vary around it
  /// Remove (and count) invalid, degenerate and duplicate triangles; orient the rest consistently.
  bool repair = false;
  /// build_file: whole-number colours of PLY and STL are linear, not sRGB.
  bool linear_colors = false;
  /// build_file: folders besides the scene's own from which files may be read that the scene names.
  std::vector<std::filesystem::path> allow_outside;
  /// Every cut of a manifold mesh is a manifold with its holes, handles and pieces: no edge has more than two
  /// triangles. Needs more triangles, since small holes and handles would otherwise close.
  bool keep_topology = false;
  /// Open borders (edges of one triangle of a mesh, by exact position) keep every vertex in every cut, so that tiles
  /// built apart with the same grid_step meet at any pair of levels. Concerns positions alone; needs more triangles.
  bool lock_borders = false;
  /// Surfaces that lie close above one another stay in order where an error comes near the gap between them.
  bool keep_layers = true;
  std::uint32_t page_size = 128;             ///< largest page, KiB: 16, 32, 64 or 128; a larger group has its own
  PageOrder page_order = PageOrder::kLevel;  ///< of groups inside a level
  std::uint32_t root_bytes = 0;  ///< limit of each mesh's first page, bytes, 16,384 to 131,072; 0: as page_size
  bool page_hints = false;       ///< the file has a sphere and errors of each page (AssetFile::page_hint)
  AggregateChoice aggregate = AggregateChoice::kMasked;  ///< what is simplified by coverage
  /// kNamed: names of meshes, whose pieces of at most 512 triangles are taken, and of materials, whose pieces are.
  /// Comma-separated; '*' stands for any characters, '?' for one.
  std::string aggregate_names;
  /// Which errors the asset stores besides those of positions (docs/reference/selection.md): kTexels adds texture
  /// coordinates, kAppearance also normals. A renderer selects by one with View::promise. Works with every error
  /// tier: bounds with kCertified, measured with kMeasured and kQem.
  format::Promise promise = format::Promise::kPosition;
  /// Limit for the process, bytes; 0: what the machine has left. Fewer meshes are built at once to stay below it; if
  /// one mesh alone needs more, the build fails with kBuildFailed before it starts.
  std::uint64_t max_memory_bytes = 0;
  /// build_file: limit for decoded geometry beyond what the size of its file justifies, bytes.
  std::uint64_t max_decoded_bytes = std::uint64_t{512} << 20U;
  std::uint32_t thread_count = 0;  ///< threads at most, up to 4,096; 0: what oneTBB gives the calling thread
  std::function<void(const BuildProgress&)> on_progress;  ///< may be empty
  std::function<bool()> should_cancel;  ///< called between steps; true ends the build with kBuildFailed. May be empty
};

/// Builds an asset in memory: the bytes of a .lode file, as AssetFile::take opens them.
[[nodiscard]] Result<std::vector<std::uint8_t>> build_asset(const SceneInput& scene, const BuildOptions& options);

/// Builds an asset into a file, which appears whole or not at all.
[[nodiscard]] Status build_asset_file(const SceneInput& scene, const std::filesystem::path& output,
                                      const BuildOptions& options);

/// Reads a .gltf, .glb, .ply, .obj or .stl file, builds it and writes the asset. Files that it names are read from
/// below its own folder and those of allow_outside only. Errors as above; kUnsupported for a required extension that is
/// not supported; kUsage if the output is one of the files that were read, under whatever name.
[[nodiscard]] Status build_file(const std::filesystem::path& input, const std::filesystem::path& output,
                                const BuildOptions& options);

}  // namespace meshlode
