// SPDX-License-Identifier: MIT
// The run-time half of meshlode: open a .lode asset, choose what a camera needs, load pages, decode clusters.
//
//   auto asset = meshlode::AssetFile::open("scene.lode");
//   if (!asset) { puts(asset.error().message().c_str()); return 1; }
//   for (const meshlode::DrawItem& item : asset->select_view({.eye = {0, 1, 5}}, 1.0)) …
//
// Units. *Mesh space* is the space of the source mesh, in its own ("object") units; stored spheres and decoded
// positions are mesh space relative to MeshRecord::origin. *World space* is after InstanceRecord::transform. Errors are
// distances in object units; format::kInfiniteError means "never passes".
//
// Ids are indices into the tables below, all global to the asset. The records are described in <meshlode/format.h>.
//
// Errors. Functions that can fail return Result. Every byte of an asset is treated as hostile: opening checks the
// tables and loading a page checks the page, so that nothing behind them can crash, hang or read outside. No exception
// leaves but std::bad_alloc.
//
// Thread safety. An AssetFile and a PageBytes are immutable: any number of threads may call const members at once.
// Moving or destroying one while another thread uses it is a race.
//
// Not promised: the order of DrawItems beyond "ascending"; any caching (a page loaded twice is unpacked twice); that a
// future format version keeps the layout of the records; a stable ABI before version 1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

namespace meshlode {

/// Where the scene is looked at from, as far as choosing a cut needs it: the rule looks at distances only, so a view
/// direction plays no part in it, and nothing is culled.
struct View {
  std::array<double, 3> eye{0.0, 0.0, 0.0};  ///< world space; unused where orthographic
  bool is_orthographic = false;
  double fovy_radians = 0.78539816339744831;  ///< full vertical angle, in (0, pi); perspective only
  double ortho_height = 1.0;                  ///< world units that the picture's height spans; orthographic only
  double near_distance = 1e-3;                ///< world units, above 0: surfaces nearer than this count as this far
  std::uint32_t height_px = 720;              ///< of the picture, at least 1
};

/// Draw this cluster with this instance's transform.
struct DrawItem {
  std::uint32_t instance;
  std::uint32_t cluster;
};

/// One mesh at one error everywhere, without a camera.
struct UniformCut {
  std::vector<std::uint32_t> clusters;  ///< ascending
  double stored_error = 0.0;            ///< object units: the largest error in it, at least the mesh's level0_deviation
};

/// A page in its decoded, GPU-ready form (docs/reference/format.md, Pages): a view into the asset's bytes where the
/// file stores it uncompressed (the AssetFile's storage must then outlive it), else memory of its own.
class PageBytes {
 public:
  PageBytes(PageBytes&&) noexcept;
  PageBytes& operator=(PageBytes&&) noexcept;
  ~PageBytes();
  [[nodiscard]] std::span<const std::uint8_t> bytes() const;
  [[nodiscard]] std::uint32_t page() const;

 private:
  friend class AssetFile;
  struct State;
  explicit PageBytes(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The integers of a cluster, exactly as stored. Vertex i has values[i * channel_count + c] with the channels in the
/// order of MeshRecord: position x y z, normal X Y Z, u v of each set, colour r g b a, as far as the mesh has them.
struct ClusterIntegers {
  std::uint32_t vertex_count = 0;
  std::uint32_t triangle_count = 0;
  std::uint32_t channel_count = 0;
  std::vector<std::int32_t> values;
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< vertex indices within the cluster, counter-clockwise
  std::vector<std::uint32_t> triangle_materials;       ///< per triangle, into AssetFile::materials()
};

/// A cluster as floats. Attribute arrays are empty where the mesh does not store the attribute.
struct ClusterFloats {
  std::vector<std::array<float, 3>> positions;  ///< mesh space relative to MeshRecord::origin; exact while |m·q| < 2^24
  std::vector<std::array<float, 3>> normals;    ///< unit; empty too where normals are flat (NormalMode::kFlat)
  std::array<std::vector<std::array<float, 2>>, format::kMaxUvSets> uvs;  ///< stored set k, the source's TEXCOORD_n
                                                                          ///< with n = MeshRecord::uv_set_source[k]
  std::vector<std::array<float, 4>> colors;                               ///< linear, 0 … 1
  std::vector<std::array<std::uint8_t, 3>> triangles;
  std::vector<std::uint32_t> triangle_materials;
};

/// An open asset. Movable, not copyable; moving keeps every view it has handed out.
class AssetFile {
 public:
  /// Maps the file; it must not shrink while it is open. Errors: kIo; kInvalid, naming the place in the file;
  /// kUnsupported for a newer version or an unknown required section.
  [[nodiscard]] static Result<AssetFile> open(const std::filesystem::path& path);
  /// Views the bytes, which must outlive the asset and lie at a multiple of 8.
  [[nodiscard]] static Result<AssetFile> view(std::span<const std::uint8_t> bytes);
  /// Takes the bytes.
  [[nodiscard]] static Result<AssetFile> take(std::vector<std::uint8_t> bytes);

  AssetFile(AssetFile&&) noexcept;
  AssetFile& operator=(AssetFile&&) noexcept;
  ~AssetFile();

  // Tables: views that live as long as the asset. Every id and range in them was checked.
  [[nodiscard]] const format::FileHeader& header() const;
  [[nodiscard]] std::span<const format::MeshRecord> meshes() const;
  [[nodiscard]] std::span<const format::MaterialRecord> materials() const;
  [[nodiscard]] std::span<const format::InstanceRecord> instances() const;
  [[nodiscard]] std::span<const format::GroupRecord> groups() const;
  [[nodiscard]] std::span<const format::ClusterRecord> clusters() const;
  [[nodiscard]] std::span<const format::NodeRecord> nodes() const;
  [[nodiscard]] std::span<const format::PageRecord> pages() const;
  [[nodiscard]] std::span<const std::uint32_t> page_dependencies() const;
  [[nodiscard]] std::span<const format::BlobRecord> blobs() const;
  /// What the asset promises besides positions (docs/reference/selection.md): one record a mesh, and one a group; or
  /// none.
  [[nodiscard]] std::span<const format::PromiseMeshRecord> promises() const;
  [[nodiscard]] std::span<const format::PromiseGroupRecord> promise_errors() const;
  /// Text of a record's StringRef, UTF-8 as the source had it.
  [[nodiscard]] std::string_view text(format::StringRef ref) const;
  /// An image's or buffer's bytes as they were in the source. \pre `blob` is a record of this asset
  [[nodiscard]] std::span<const std::uint8_t> blob_bytes(const format::BlobRecord& blob) const;
  /// JSON: source, settings, plan, what was left out.
  [[nodiscard]] std::string_view meta_json() const;
  /// JSON in the shape of glTF: nodes, materials, textures, cameras, animations.
  [[nodiscard]] std::string_view scene_json() const;

  /// From here on cuts keep this promise: the errors of meshes(), groups() and nodes() are those of it, for whoever
  /// selects by these tables too. Views taken before stay valid until the next choice. It is that of positions when an
  /// asset is opened. Errors: kUsage for no enumerator; kUnsupported where the asset has no such errors, with how to
  /// build it. Not while another thread uses the asset.
  [[nodiscard]] Status choose_promise(format::Promise promise);

  /// What to draw so that no point of the surface moves by more than max(pixel_error, level 0's own deviation) pixels,
  /// as far as the asset's error tier promises it. Each piece of each instance's surface is drawn exactly once, without
  /// cracks within a mesh, whatever the camera. Ascending by (instance, cluster). Singular instances are not drawn.
  /// Errors: kUsage for a view or pixel error that is not finite or not in its range.
  [[nodiscard]] Result<std::vector<DrawItem>> select_view(const View& view, double pixel_error) const;

  /// The cut of one mesh where each group whose error is at most `max_error` (object units) is replaced by what is
  /// coarser. Errors: kUsage for a mesh that does not exist or an error that is not a number >= 0 (infinity is the
  /// coarsest cut).
  [[nodiscard]] Result<UniformCut> select_uniform(std::uint32_t mesh, double max_error) const;

  /// The page that holds a cluster. \pre cluster < clusters().size()
  [[nodiscard]] std::uint32_t page_of(std::uint32_t cluster) const;

  /// Unpacks and checks a page. Errors: kUsage no such page; kInvalid with the place; kUnsupported for a codec that was
  /// not built in.
  [[nodiscard]] Result<PageBytes> load_page(std::uint32_t page) const;

  /// Decodes a cluster of a loaded page; reuses the memory of `out`. Errors: kUsage where the page is not the
  /// cluster's.
  [[nodiscard]] Status decode(const PageBytes& page, std::uint32_t cluster, ClusterIntegers& out) const;
  /// The same as floats.
  [[nodiscard]] Status decode(const PageBytes& page, std::uint32_t cluster, ClusterFloats& out) const;

 private:
  struct State;
  explicit AssetFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace meshlode
