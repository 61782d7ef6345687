// SPDX-License-Identifier: MIT
// <meshlode/runtime.h> over the rooms read, unpack, select and decode: no logic of its own, only the checks of what a
// caller may pass and the translation to plain types.
#include <meshlode/runtime.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/try.h"
#include "format/page_hint.h"
#include "run/api/by_promise.h"
#include "run/api/camera_of_view.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "run/read/find_image.h"
#include "run/read/sections.h"
#include "run/select/resident.h"
#include "run/select/select.h"
#include "run/select/streaming_order.h"
#include "run/unpack/unpack.h"

namespace meshlode {
namespace {

Error usage(const char* where, const char* detail) {
  return Error{ErrorCode::kUsage, where, detail};
}

Result<run::Camera> make_camera(const View& view) {
  const run::ViewFault fault = run::fault_of_view(view);
  if (fault.field != nullptr) return Error{ErrorCode::kUsage, std::string("View::") + fault.field, fault.detail};
  return run::camera_of_view(view);
}

template <class Out, class In>
void copy_vectors(const std::vector<In>& from, std::vector<Out>& to) {
  to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    for (std::size_t c = 0; c < to[i].size(); ++c) to[i][c] = from[i][static_cast<typename In::length_type>(c)];
  }
}

/// What selecting takes beside the camera.
Result<run::Camera> make_camera(const View& view, double pixel_error) {
  TRY_LET(camera, make_camera(view));
  if (!(pixel_error >= 0.0) || !std::isfinite(pixel_error)) return usage("pixel_error", "is not a number >= 0");
  return *camera;
}

/// The two are the same planes.
std::optional<run::Frustum> planes_of(const Frustum* frustum) {
  return frustum != nullptr ? std::optional(run::Frustum{frustum->planes}) : std::nullopt;
}

static_assert(sizeof(run::ClusterInstance) == sizeof(DrawItem) && sizeof(run::PageRequest) == sizeof(PageRequest));

}  // namespace

Result<Frustum> make_frustum(const View& view, const std::array<double, 3>& target, const std::array<double, 3>& up,
                             double aspect) {
  TRY_LET(camera, make_camera(view));
  const auto planes = run::frustum_of_view(*camera, target.data(), up.data(), aspect);
  if (!planes) return usage("frustum", run::kFrustumFault);
  return Frustum{planes->planes};
}

Result<HeadSize> find_head(std::span<const std::uint8_t> first, std::uint64_t file_bytes) {
  TRY_LET(head, run::find_head(first, file_bytes));
  return HeadSize{head->bytes, head->is_known};
}

struct PageBytes::State {
  run::PageBytes bytes;
  std::uint32_t page;
  const void* owner;  ///< the AssetFile's state: a page of another asset was checked against other tables
};

PageBytes::PageBytes(std::unique_ptr<State> state) : state_(std::move(state)) {}
PageBytes::PageBytes(PageBytes&&) noexcept = default;
PageBytes& PageBytes::operator=(PageBytes&&) noexcept = default;
PageBytes::~PageBytes() = default;
std::span<const std::uint8_t> PageBytes::bytes() const {
  return state_->bytes.bytes();
}
std::uint32_t PageBytes::page() const {
  return state_->page;
}

struct AssetFile::State {
  run::AssetByPromise assets;
  const run::Asset& asset = assets.by_position();

  explicit State(run::Asset opened) : assets(std::move(opened)) {}
  static Result<AssetFile> wrap(Result<run::Asset> asset) {
    if (!asset) return asset.error();
    return AssetFile(std::make_unique<State>(std::move(*asset)));
  }
  [[nodiscard]] Result<const run::Asset*> by(format::Promise promise) const {
    return assets.by(static_cast<std::uint32_t>(promise));
  }
  /// Decodes to the integer form of the room `decode`.
  [[nodiscard]] Status decode(const PageBytes::State& page, std::uint32_t cluster, run::DecodedCluster& out) const {
    if (cluster >= asset.clusters().size()) return usage("cluster", "does not exist");
    if (page.owner != this || page_of(cluster) != page.page) return usage("page", "is not the page of this cluster");
    run::decode_cluster(asset, page.bytes, ClusterId(cluster), out);
    return Ok{};
  }
  [[nodiscard]] std::uint32_t page_of(std::uint32_t cluster) const {
    return asset.groups()[asset.clusters()[cluster].coarser_group].page;
  }
};

struct ResidentSelector::State {
  const run::AssetByPromise* assets;
  run::ResidentSelector selector;
};

ResidentSelector::ResidentSelector(std::unique_ptr<State> state) : state_(std::move(state)) {}
ResidentSelector::ResidentSelector(ResidentSelector&&) noexcept = default;
ResidentSelector& ResidentSelector::operator=(ResidentSelector&&) noexcept = default;
ResidentSelector::~ResidentSelector() = default;

Status ResidentSelector::select(const View& view, double pixel_error, std::span<const std::uint32_t> resident,
                                std::vector<DrawItem>& items, const Frustum* frustum) {
  TRY_LET(camera, make_camera(view, pixel_error));
  TRY_LET(asset, state_->assets->by(static_cast<std::uint32_t>(view.promise)));
  const auto planes = planes_of(frustum);
  const run::ResidentQuery query{*camera, pixel_error, resident, planes ? &*planes : nullptr};
  const run::SelectTables tables = run::tables_of(**asset);
  items.resize(items.capacity());
  for (;;) {
    const std::size_t count =
        state_->selector.select(tables, query, {reinterpret_cast<run::ClusterInstance*>(items.data()), items.size()});
    const bool is_whole = count <= items.size();
    items.resize(count);
    if (is_whole) return Ok{};
  }
}

std::span<const PageRequest> ResidentSelector::requests() const {
  const auto requests = state_->selector.requests();
  return {reinterpret_cast<const PageRequest*>(requests.data()), requests.size()};
}

std::span<const float> ResidentSelector::page_priorities() const {
  return state_->selector.page_priorities();
}

AssetFile::AssetFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
AssetFile::AssetFile(AssetFile&&) noexcept = default;
AssetFile& AssetFile::operator=(AssetFile&&) noexcept = default;
AssetFile::~AssetFile() = default;

Result<AssetFile> AssetFile::open(const std::filesystem::path& path) {
  return State::wrap(run::Asset::open(path));
}
Result<AssetFile> AssetFile::view(std::span<const std::uint8_t> bytes) {
  return State::wrap(run::Asset::from_bytes(bytes));
}
Result<AssetFile> AssetFile::take(std::vector<std::uint8_t> bytes) {
  return State::wrap(run::Asset::from_vector(std::move(bytes)));
}

Result<AssetFile> AssetFile::view_head(std::span<const std::uint8_t> bytes, std::uint64_t file_bytes) {
  return State::wrap(run::Asset::from_head(bytes, file_bytes));
}
Result<AssetFile> AssetFile::take_head(std::vector<std::uint8_t> bytes, std::uint64_t file_bytes) {
  return State::wrap(run::Asset::from_head(std::move(bytes), file_bytes));
}

const format::FileHeader& AssetFile::header() const {
  return state_->asset.header();
}
std::span<const format::MeshRecord> AssetFile::meshes() const {
  return state_->asset.meshes();
}
std::span<const format::MaterialRecord> AssetFile::materials() const {
  return state_->asset.materials();
}
std::span<const format::InstanceRecord> AssetFile::instances() const {
  return state_->asset.instances();
}
std::span<const format::GroupRecord> AssetFile::groups() const {
  return state_->asset.groups();
}
std::span<const format::ClusterRecord> AssetFile::clusters() const {
  return state_->asset.clusters();
}
std::span<const format::NodeRecord> AssetFile::nodes() const {
  return state_->asset.nodes();
}
std::span<const format::PageRecord> AssetFile::pages() const {
  return state_->asset.pages();
}
std::span<const std::uint32_t> AssetFile::page_dependencies() const {
  return state_->asset.page_dependencies();
}
std::span<const format::BlobRecord> AssetFile::blobs() const {
  return state_->asset.blobs();
}
std::span<const format::PromiseMeshRecord> AssetFile::promises() const {
  return state_->asset.promises();
}
std::span<const format::PromiseGroupRecord> AssetFile::promise_errors() const {
  return state_->asset.promise_errors();
}
std::string_view AssetFile::text(format::StringRef ref) const {
  return state_->asset.string(ref);
}
std::span<const std::uint8_t> AssetFile::blob_bytes(const format::BlobRecord& blob) const {
  return state_->asset.blob_bytes(blob);
}
ByteRange AssetFile::blob_range(const format::BlobRecord& blob) const {
  return {blob.offset, blob.bytes};
}
Status AssetFile::check_blob(std::uint32_t blob, std::span<const std::uint8_t> bytes) const {
  return run::check_blob(state_->asset, blob, bytes);
}
std::uint32_t AssetFile::image_of_texture(std::uint32_t texture) const {
  return run::find_image_of_texture(state_->asset, texture);
}
std::uint32_t AssetFile::blob_of_image(std::uint32_t image) const {
  return run::find_blob_of_image(state_->asset, image);
}
std::string_view AssetFile::meta_json() const {
  return state_->asset.meta_json();
}
std::string_view AssetFile::scene_json() const {
  return state_->asset.scene_json();
}

Result<PromiseTables> AssetFile::tables_of(format::Promise promise) const {
  TRY_LET(asset, state_->by(promise));
  return PromiseTables{(*asset)->meshes(), (*asset)->groups(), (*asset)->nodes()};
}

Result<std::vector<DrawItem>> AssetFile::select_view(const View& view, double pixel_error,
                                                     const Frustum* frustum) const {
  TRY_LET(camera, make_camera(view, pixel_error));
  TRY_LET(asset, state_->by(view.promise));
  const auto planes = planes_of(frustum);
  const std::vector<run::ClusterInstance> drawn =
      run::select_bvh(**asset, *camera, pixel_error, {}, planes ? &*planes : nullptr);
  std::vector<DrawItem> items;
  items.reserve(drawn.size());
  for (const run::ClusterInstance& d : drawn) items.push_back({d.instance.value, d.cluster.value});
  return items;
}

ResidentSelector AssetFile::resident_selector() const {
  return ResidentSelector(std::make_unique<ResidentSelector::State>(
      ResidentSelector::State{&state_->assets, run::ResidentSelector(run::tables_of(state_->asset))}));
}

Result<UniformCut> AssetFile::select_uniform(std::uint32_t mesh, double max_error, format::Promise promise) const {
  if (mesh >= state_->asset.meshes().size()) return usage("mesh", "does not exist");
  if (!(max_error >= 0.0)) return usage("max_error", "is not a number >= 0");
  TRY_LET(asset, state_->by(promise));
  const run::UniformCut cut = run::select_uniform(**asset, MeshId(mesh), max_error);
  UniformCut result;
  result.stored_error = cut.stored_error;
  result.clusters.reserve(cut.clusters.size());
  for (const ClusterId c : cut.clusters) result.clusters.push_back(c.value);
  return result;
}

Result<std::vector<std::uint32_t>> AssetFile::streaming_order(format::Promise promise) const {
  TRY_LET(asset, state_->by(promise));
  return run::streaming_order(**asset);
}

format::PageHintRecord AssetFile::page_hint(std::uint32_t page) const {
  return format::make_page_hint(groups().subspan(pages()[page].first_group, pages()[page].group_count));
}

std::vector<ByteRange> AssetFile::first_ranges(std::uint64_t max_gap) const {
  std::vector<ByteRange> ranges;
  for (const run::FileRange& range : run::first_ranges(state_->asset, max_gap)) {
    ranges.push_back({range.offset, range.bytes});
  }
  return ranges;
}

std::uint32_t AssetFile::page_of(std::uint32_t cluster) const {
  return state_->page_of(cluster);
}

Result<PageBytes> AssetFile::load_page(std::uint32_t page) const {
  if (page >= state_->asset.pages().size()) return usage("page", "does not exist");
  TRY_LET(bytes, run::load_page(state_->asset, PageId(page)));
  return PageBytes(std::make_unique<PageBytes::State>(PageBytes::State{std::move(*bytes), page, state_.get()}));
}

ByteRange AssetFile::page_range(std::uint32_t page) const {
  return {pages()[page].offset, pages()[page].stored_bytes};
}

Result<PageBytes> AssetFile::unpack_page(std::uint32_t page, std::span<const std::uint8_t> stored,
                                         std::span<std::uint32_t> out) const {
  TRY(run::unpack_stored_page(state_->asset, PageId(page), stored, out));
  const std::span bytes{reinterpret_cast<const std::uint8_t*>(out.data()), pages()[page].bytes};
  return PageBytes(std::make_unique<PageBytes::State>(PageBytes::State{run::PageBytes(bytes), page, state_.get()}));
}

Status AssetFile::decode(const PageBytes& page, std::uint32_t cluster, ClusterIntegers& out) const {
  run::DecodedCluster decoded;
  std::swap(decoded.channels, out.values);  // reuse what the caller brought
  std::swap(decoded.triangles, out.triangles);
  std::swap(decoded.triangle_material, out.triangle_materials);
  TRY(state_->decode(*page.state_, cluster, decoded));
  out.vertex_count = decoded.vertex_count;
  out.triangle_count = decoded.triangle_count;
  out.channel_count = decoded.channel_count;
  out.values = std::move(decoded.channels);
  out.triangles = std::move(decoded.triangles);
  out.triangle_materials = std::move(decoded.triangle_material);
  return Ok{};
}

Status AssetFile::decode(const PageBytes& page, std::uint32_t cluster, ClusterFloats& out) const {
  run::DecodedCluster decoded;
  std::swap(decoded.triangles, out.triangles);
  std::swap(decoded.triangle_material, out.triangle_materials);
  TRY(state_->decode(*page.state_, cluster, decoded));
  const format::GroupRecord& group = state_->asset.groups()[state_->asset.clusters()[cluster].coarser_group];
  run::ClusterAttributes floats;
  run::decode_attributes(state_->asset.meshes()[group.mesh], decoded, floats);
  copy_vectors(floats.positions, out.positions);
  copy_vectors(floats.normals, out.normals);
  for (std::size_t k = 0; k < out.uvs.size(); ++k) copy_vectors(floats.uvs[k], out.uvs[k]);
  copy_vectors(floats.colors, out.colors);
  out.triangles = std::move(decoded.triangles);
  out.triangle_materials = std::move(decoded.triangle_material);
  return Ok{};
}

}  // namespace meshlode
