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
/// Thread safety. Any number of threads may call const members of an AssetFile or a PageBytes at once; each selects
/// with a ResidentSelector of its own. Moving or destroying one while another thread uses it is a race.
///
/// Not promised: caching (a page loaded twice is unpacked twice); the layout of records in a later format version; a
/// stable ABI before version 1 (docs/reference/compatibility.md).
#pragma once

#if !defined(_MSVC_LANG) && __cplusplus < 202002L
#error "meshlode/runtime.h needs C++20 (-std=c++20)"
#endif

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
/// culled but by a Frustum.
struct View {
  std::array<double, 3> eye{0.0, 0.0,
                            0.0};  ///< world space, finite; if orthographic, only a frustum made of it uses it
  bool is_orthographic = false;    ///< else perspective
  double fovy_radians = 0.78539816339744831;  ///< full vertical angle, in (0, pi); perspective only
  double ortho_height = 1.0;                  ///< world units across the picture's height, above 0; orthographic only
  double near_distance = 1e-3;                ///< world units, above 0: nearer surfaces count as this far
  std::uint32_t height_px = 720;              ///< height of the picture, at least 1
  /// By which errors the cut is made (docs/reference/selection.md).
  format::Promise promise = format::Promise::kPosition;
};

/// The view volume, world space: a point p is inside where a·p.x + b·p.y + c·p.z + d >= 0 for each plane (a, b, c, d).
/// Planes may have any length and look any way; one of zeros has everything inside.
struct Frustum {
  std::array<std::array<double, 4>, 6> planes{};  ///< finite
};

/// The view volume of a camera: four sides and the plane through the eye, and no far one. `target` is a point that it
/// looks at and `up` points to the top of the picture; `aspect` is width over height. Errors: kUsage for a member of
/// `view` outside its range, an aspect that is not above 0, or directions that are not finite or have no picture.
[[nodiscard]] Result<Frustum> make_frustum(const View& view, const std::array<double, 3>& target,
                                           const std::array<double, 3>& up, double aspect);

/// Draw this cluster with this instance's transform.
struct DrawItem {
  std::uint32_t instance;  ///< into AssetFile::instances()
  std::uint32_t cluster;   ///< into AssetFile::clusters()
};

/// A page that a view wants and that is not resident.
struct PageRequest {
  std::uint32_t page;  ///< into AssetFile::pages()
  float priority;      ///< see ResidentSelector::page_priorities
};

/// The tables that hold errors.
struct PromiseTables {
  std::span<const format::MeshRecord> meshes;   ///< as AssetFile::meshes(), but level0_deviation
  std::span<const format::GroupRecord> groups;  ///< as AssetFile::groups(), but error
  std::span<const format::NodeRecord> nodes;    ///< as AssetFile::nodes(), but error
};

/// Bytes of the file.
struct ByteRange {
  std::uint64_t offset = 0;  ///< from the start of the file
  std::uint64_t bytes = 0;   ///< length
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

/// Chooses what to draw of what is loaded, and says what to load: see AssetFile::resident_selector. It holds the links
/// of the asset's DAG and the memory of a search. Movable; one per thread; the asset must outlive it.
class ResidentSelector {
 public:
  ResidentSelector(ResidentSelector&&) noexcept;             ///< leaves the other one empty
  ResidentSelector& operator=(ResidentSelector&&) noexcept;  ///< leaves the other one empty
  ~ResidentSelector();

  /// Chooses what to draw for `view` with the pages at hand, ascending by (instance, cluster). What is drawn covers
  /// each piece of each instance's surface exactly once where the pages with terminal groups are resident, and as
  /// finely as resident pages allow; with all pages resident it is what AssetFile::select_view chooses.
  ///
  /// Page p is resident iff bit p % 32 of word p / 32 of `resident` is set; pages behind its end are not. `items` gets
  /// what is drawn, and takes memory only where it has to grow. Without a frustum nothing is culled; with one, items
  /// whose culling sphere is outside are left out, and pages that only such clusters want are not asked for. Errors:
  /// kUsage if pixel_error or a member of `view` is outside its range; kUnsupported if the asset has no errors of the
  /// view's promise. Views may alternate between promises.
  [[nodiscard]] Status select(const View& view, double pixel_error, std::span<const std::uint32_t> resident,
                              std::vector<DrawItem>& items, const Frustum* frustum = nullptr);

  /// Of the last call: wanted pages that are not resident, by falling priority, then by id. A page comes behind all
  /// pages that it is of no use without.
  [[nodiscard]] std::span<const PageRequest> requests() const;
  /// Of the last call, per page, resident or not: what is lost without it. The largest projected error in pixels of its
  /// groups that do not pass and are inside the frustum, and of what depends on them; 0: this view does not want it, so
  /// evict it first. format::kInfiniteError: it holds a terminal group of a mesh with an instance that is not singular;
  /// keep it always.
  [[nodiscard]] std::span<const float> page_priorities() const;

 private:
  friend class AssetFile;
  struct State;
  explicit ResidentSelector(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// How many of a file's first bytes AssetFile::view_head needs.
struct HeadSize {
  std::uint64_t bytes = 0;  ///< at most those of the file
  bool is_known = false;    ///< false: find_head has to see this many of the first bytes to say it
};
/// From the first bytes of a file, as many as there are, at any address. 64 bytes say how long the section table is;
/// with it the answer is known. Errors: kInvalid with the place; kUnsupported for a newer version, or where tables lie
/// behind pages or images, which this writer's never do.
[[nodiscard]] Result<HeadSize> find_head(std::span<const std::uint8_t> first, std::uint64_t file_bytes);

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

  /// Views the head of a file: its first bytes, as many as find_head says or more. All tables, texts and selections
  /// work; load_page fails and blob_bytes is empty, as pages and images are for the caller to read: page_range,
  /// unpack_page, blob_range, check_blob. The bytes must outlive the asset and lie at a multiple of 8. Errors: those of
  /// open, and kInvalid where the head is cut off.
  [[nodiscard]] static Result<AssetFile> view_head(std::span<const std::uint8_t> bytes, std::uint64_t file_bytes);
  /// Takes the bytes.
  [[nodiscard]] static Result<AssetFile> take_head(std::vector<std::uint8_t> bytes, std::uint64_t file_bytes);

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
  /// An image's or buffer's bytes as they were in the source; empty of a head. \pre `blob` is a record of this asset
  [[nodiscard]] std::span<const std::uint8_t> blob_bytes(const format::BlobRecord& blob) const;
  /// Where they lie in the file. \pre `blob` is a record of this asset
  [[nodiscard]] ByteRange blob_range(const format::BlobRecord& blob) const;
  /// Checks bytes that the caller read, by their number and checksum. Errors: kUsage, kInvalid.
  [[nodiscard]] Status check_blob(std::uint32_t blob, std::span<const std::uint8_t> bytes) const;
  /// The glTF image of a glTF texture, such as MaterialRecord::base_color_texture; format::kNone without. Reads
  /// scene_json() from its start: ask once.
  [[nodiscard]] std::uint32_t image_of_texture(std::uint32_t texture) const;
  /// The blob that is a glTF image; format::kNone where the asset does not hold it. Ask once.
  [[nodiscard]] std::uint32_t blob_of_image(std::uint32_t image) const;
  /// JSON: source, settings, plan, what was left out.
  [[nodiscard]] std::string_view meta_json() const;
  /// JSON in the shape of glTF: nodes, materials, textures, cameras, animations.
  [[nodiscard]] std::string_view scene_json() const;

  /// What to upload to select by a promise on a GPU: meshes(), groups() and nodes() have the errors of positions. Views
  /// that live as long as the asset. \return kUsage for an unknown value; kUnsupported if the asset has no such errors,
  /// with how to build it.
  [[nodiscard]] Result<PromiseTables> tables_of(format::Promise promise) const;

  /// Chooses the clusters to draw for `view`, ascending by (instance, cluster). No point of the surface is displaced by
  /// more than max(pixel_error, MeshRecord::level0_deviation in pixels), as far as the mesh's error tier guarantees.
  /// Every piece of each instance's surface is covered exactly once, without cracks within a mesh. Reads tables only:
  /// the pages of the result (page_of) need not be loaded yet. No occlusion culling. Singular instances are
  /// skipped. \param view         the camera \param pixel_error  allowed displacement in pixels, finite and at least 0;
  /// 0 selects the finest level \param frustum  null: nothing is culled; else items whose culling sphere is outside are
  /// left out \return kUsage if pixel_error or a member of `view` is outside its range; kUnsupported if the asset has
  /// no errors of the view's promise
  [[nodiscard]] Result<std::vector<DrawItem>> select_view(const View& view, double pixel_error,
                                                          const Frustum* frustum = nullptr) const;

  /// For choosing with only some pages loaded. Takes all memory that selecting needs, so that no frame does.
  [[nodiscard]] ResidentSelector resident_selector() const;

  /// Chooses the cut of one mesh in which each group with an error of at most `max_error` (object units) is replaced.
  /// \return kUsage for a mesh that does not exist or a max_error that is not a number of at least 0 (infinity: the
  /// coarsest cut); kUnsupported if the asset has no errors of the promise
  [[nodiscard]] Result<UniformCut> select_uniform(std::uint32_t mesh, double max_error,
                                                  format::Promise promise = format::Promise::kPosition) const;

  /// An order in which to load all pages: each behind those that it depends on, and those with the largest errors
  /// first, over all meshes. Errors: kUnsupported if the asset has no errors of the promise.
  [[nodiscard]] Result<std::vector<std::uint32_t>> streaming_order(
      format::Promise promise = format::Promise::kPosition) const;

  /// How much a page matters, from its groups and their errors of positions. With the rule of selection, the sphere and
  /// the largest error give at least the projected error of each group of the page and of what depends on it, up to
  /// 1e-5 of it for rounding. A view that selects by another promise may need the page earlier. \pre page <
  /// pages().size()
  [[nodiscard]] format::PageHintRecord page_hint(std::uint32_t page) const;

  /// What to read before the first picture: where the pages lie without which nothing is drawn, those that hold a
  /// terminal group of a mesh with an instance that is not singular. Ascending. Pages with at most `max_gap` bytes
  /// between them share a range; neighbours always do, so that one read gets the first pages of many small meshes.
  [[nodiscard]] std::vector<ByteRange> first_ranges(std::uint64_t max_gap = 0) const;

  /// The page that holds a cluster. \pre cluster < clusters().size()
  [[nodiscard]] std::uint32_t page_of(std::uint32_t cluster) const;

  /// Unpacks and checks a page. Errors: kUsage no such page; kInvalid with the place; kUnsupported for a codec that was
  /// not built in.
  [[nodiscard]] Result<PageBytes> load_page(std::uint32_t page) const;

  /// Where a page lies in the file. \pre page < pages().size()
  [[nodiscard]] ByteRange page_range(std::uint32_t page) const;
  /// Unpacks and checks a page from stored bytes that the caller read, at any address, into memory of the caller, which
  /// must outlive the result: PageRecord::bytes / 4 words. Errors: as for load_page, and kUsage for a wrong number of
  /// bytes or too little room. After an error the content of `out` is undefined.
  [[nodiscard]] Result<PageBytes> unpack_page(std::uint32_t page, std::span<const std::uint8_t> stored,
                                              std::span<std::uint32_t> out) const;

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
