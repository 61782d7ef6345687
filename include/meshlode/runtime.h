// SPDX-License-Identifier: MIT
/// \file
/// The runtime: open a .lode asset, choose what a camera needs, load pages, decode clusters.
///
/// \code
///   const auto asset = meshlode::AssetFile::open("scene.lode");
///   if (!asset) { puts(asset.error().message().c_str()); return 1; }
///   const auto items = asset->select_view({.eye = {0, 1, 5}}, 1.0);
///   if (!items) { puts(items.error().message().c_str()); return 1; }
///   for (const meshlode::DrawItem& item : *items) draw(item);
/// \endcode
///
/// Units. *Mesh space* is the space of the source mesh, in its own ("object") units. Stored spheres and decoded
/// positions are mesh space relative to MeshRecord::origin. *World space* is after InstanceRecord::transform. Errors
/// are distances in object units; format::kInfiniteError means "never passes".
///
/// Ids are indices into the tables below, all global to the asset. <meshlode/format.h> describes the records.
///
/// Errors. Functions that can fail return Result. Every byte of an asset is treated as hostile: opening checks the
/// tables, loading a page checks the page. After that nothing can crash, hang or read outside. No exception leaves but
/// std::bad_alloc.
///
/// Thread safety. Any number of threads may call const members of an AssetFile or a PageBytes at once. Calling
/// choose_promise, moving or destroying one while another thread uses it is a race.
///
/// Not promised: caching (a page loaded twice is unpacked twice); the layout of records in a later format version; a
/// stable ABI before version 1 (docs/reference/compatibility.md).
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

/// Where the scene is seen from. The rule looks at distances only: a view direction plays no part, and nothing is
/// culled.
struct View {
  std::array<double, 3> eye{0.0, 0.0, 0.0};   ///< world space; unused if orthographic
  bool is_orthographic = false;               ///< else perspective
  double fovy_radians = 0.78539816339744831;  ///< full vertical angle, in (0, pi); perspective only
  double ortho_height = 1.0;                  ///< world units across the picture's height, above 0; orthographic only
  double near_distance = 1e-3;                ///< world units, above 0: nearer surfaces count as this far
  std::uint32_t height_px = 720;              ///< height of the picture, at least 1
};

/// Draw this cluster with this instance's transform.
struct DrawItem {
  std::uint32_t instance;  ///< into AssetFile::instances()
  std::uint32_t cluster;   ///< into AssetFile::clusters()
};

/// One mesh at one error everywhere, without a camera.
struct UniformCut {
  std::vector<std::uint32_t> clusters;  ///< ascending
  double stored_error = 0.0;            ///< object units: the largest error in it, at least the mesh's level0_deviation
};

/// A page in its decoded, GPU-ready form (docs/reference/format.md, Pages): a view into the asset's bytes where the
/// file stores it uncompressed (the asset must then outlive it), else memory of its own.
class PageBytes {
 public:
  PageBytes(PageBytes&&) noexcept;             ///< leaves the other one empty
  PageBytes& operator=(PageBytes&&) noexcept;  ///< leaves the other one empty
  ~PageBytes();
  [[nodiscard]] std::span<const std::uint8_t> bytes() const;  ///< aligned to 4; valid as long as this
  [[nodiscard]] std::uint32_t page() const;                   ///< id of the page

 private:
  friend class AssetFile;
  struct State;
  explicit PageBytes(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The integers of a cluster, exactly as stored. Vertex i has values[i * channel_count + c] with the channels in the
/// order of MeshRecord: position x y z, normal X Y Z, u v of each set, colour r g b a, as far as the mesh has them.
struct ClusterIntegers {
  std::uint32_t vertex_count = 0;                      ///< at most format::kMaxClusterVertices
  std::uint32_t triangle_count = 0;                    ///< at most format::kMaxClusterTriangles
  std::uint32_t channel_count = 0;                     ///< integers per vertex
  std::vector<std::int32_t> values;                    ///< vertex_count * channel_count
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< vertex indices within the cluster, counter-clockwise
  std::vector<std::uint32_t> triangle_materials;       ///< per triangle, into AssetFile::materials()
};

/// A cluster as floats. Arrays of attributes that the mesh does not store are empty.
struct ClusterFloats {
  std::vector<std::array<float, 3>> positions;  ///< mesh space relative to MeshRecord::origin; exact while |m·q| < 2^24
  std::vector<std::array<float, 3>> normals;    ///< unit; also empty if normals are flat (NormalMode::kFlat)
  std::array<std::vector<std::array<float, 2>>, format::kMaxUvSets> uvs;  ///< stored set k, the source's TEXCOORD_n
                                                                          ///< with n = MeshRecord::uv_set_source[k]
  std::vector<std::array<float, 4>> colors;                               ///< linear, 0 … 1
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< vertex indices within the cluster, counter-clockwise
  std::vector<std::uint32_t> triangle_materials;       ///< per triangle, into AssetFile::materials()
};

/// An open asset. Movable, not copyable; views of its tables stay valid when it is moved.
class AssetFile {
 public:
  /// Maps the file; it must not shrink while it is open. Errors: kIo; kInvalid, naming the place in the file;
  /// kUnsupported for a newer version or an unknown required section.
  [[nodiscard]] static Result<AssetFile> open(const std::filesystem::path& path);
  /// Views the bytes, which must outlive the asset and lie at a multiple of 8.
  [[nodiscard]] static Result<AssetFile> view(std::span<const std::uint8_t> bytes);
  /// Takes the bytes.
  [[nodiscard]] static Result<AssetFile> take(std::vector<std::uint8_t> bytes);

  AssetFile(AssetFile&&) noexcept;             ///< leaves the other one empty
  AssetFile& operator=(AssetFile&&) noexcept;  ///< closes this one first
  ~AssetFile();

  // Tables: views that live as long as the asset. Every id and range in them was checked.
  [[nodiscard]] const format::FileHeader& header() const;                   ///< start of the file
  [[nodiscard]] std::span<const format::MeshRecord> meshes() const;         ///< meshes
  [[nodiscard]] std::span<const format::MaterialRecord> materials() const;  ///< materials
  [[nodiscard]] std::span<const format::InstanceRecord> instances() const;  ///< meshes with transforms
  [[nodiscard]] std::span<const format::GroupRecord> groups() const;        ///< groups of all meshes
  [[nodiscard]] std::span<const format::ClusterRecord> clusters() const;    ///< clusters of all meshes
  [[nodiscard]] std::span<const format::NodeRecord> nodes() const;          ///< BVHs of all meshes
  [[nodiscard]] std::span<const format::PageRecord> pages() const;          ///< pages of all meshes
  [[nodiscard]] std::span<const std::uint32_t> page_dependencies() const;   ///< ranges: PageRecord::first_dependency
  [[nodiscard]] std::span<const format::BlobRecord> blobs() const;          ///< images and buffers
  /// Errors besides those of positions (docs/reference/selection.md): one record per mesh; empty if there are none.
  [[nodiscard]] std::span<const format::PromiseMeshRecord> promises() const;
  /// The same: one record per group; empty if there are none.
  [[nodiscard]] std::span<const format::PromiseGroupRecord> promise_errors() const;
  /// Text of a record's StringRef, UTF-8 as the source had it.
  [[nodiscard]] std::string_view text(format::StringRef ref) const;
  /// An image's or buffer's bytes as they were in the source. \pre `blob` is a record of this asset
  [[nodiscard]] std::span<const std::uint8_t> blob_bytes(const format::BlobRecord& blob) const;
  /// JSON: source, settings, plan, what was left out.
  [[nodiscard]] std::string_view meta_json() const;
  /// JSON in the shape of glTF: nodes, materials, textures, cameras, animations.
  [[nodiscard]] std::string_view scene_json() const;

  /// Chooses by which errors cuts are made; positions when an asset is opened. From now on the errors of meshes(),
  /// groups() and nodes() are those of the promise: upload them again if you select on a GPU. Views of them stay valid
  /// until the next choice. Not while another thread uses the asset. \return kUsage for an unknown value; kUnsupported
  /// if the asset has no such errors, with how to build it.
  [[nodiscard]] Status choose_promise(format::Promise promise);

  /// Chooses the clusters to draw for `view`, ascending by (instance, cluster). No point of the surface is displaced by
  /// more than max(pixel_error, MeshRecord::level0_deviation in pixels), as far as the mesh's error tier guarantees.
  /// Every piece of each instance's surface is covered exactly once, without cracks within a mesh. Reads tables only:
  /// the pages of the result (page_of) need not be loaded yet. No frustum or occlusion culling. Singular instances are
  /// skipped. \param view         the camera \param pixel_error  allowed displacement in pixels, finite and at least 0;
  /// 0 selects the finest level \return kUsage if pixel_error or a member of `view` is outside its range
  [[nodiscard]] Result<std::vector<DrawItem>> select_view(const View& view, double pixel_error) const;

  /// Chooses the cut of one mesh in which each group with an error of at most `max_error` (object units) is replaced.
  /// \return kUsage for a mesh that does not exist or a max_error that is not a number of at least 0 (infinity: the
  /// coarsest cut)
  [[nodiscard]] Result<UniformCut> select_uniform(std::uint32_t mesh, double max_error) const;

  /// The page that holds a cluster. \pre cluster < clusters().size()
  [[nodiscard]] std::uint32_t page_of(std::uint32_t cluster) const;

  /// Unpacks and checks a page. Errors: kUsage no such page; kInvalid with the place; kUnsupported for a codec that was
  /// not built in.
  [[nodiscard]] Result<PageBytes> load_page(std::uint32_t page) const;

  /// Decodes a cluster of a loaded page; reuses the memory of `out`. Errors: kUsage if the page is another than the
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
