// SPDX-License-Identifier: MIT
// <meshlode/meshlode.h> over the rooms read, unpack, select and decode: the checks of what a caller may pass, and
// nothing that throws gets out.
#include <meshlode/meshlode.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "run/api/c_shared.h"
#include "run/decode/decode.h"
#include "run/select/select.h"
#include "run/select/streaming_order.h"
#include "run/unpack/unpack.h"

namespace meshlode {
namespace {

using namespace run::c;

/// The C struct has the record's layout (c_records.cpp).
template <class Out, class In>
const Out* view(std::span<const In> records, std::uint32_t* count) {
  static_assert(sizeof(Out) == sizeof(In));
  *count = static_cast<std::uint32_t>(records.size());
  return reinterpret_cast<const Out*>(records.data());
}

std::uint32_t page_of(const run::Asset& asset, std::uint32_t cluster) {
  return asset.groups()[asset.clusters()[cluster].coarser_group].page;
}

/// What both ways to decode check, and the integers.
meshlode_status decode(const run::Asset& asset, const meshlode_page_bytes& page, std::uint32_t cluster,
                       run::DecodedCluster& out, meshlode_error* error) {
  if (cluster >= asset.clusters().size()) return fail(error, MESHLODE_USAGE, "cluster: does not exist");
  if (page.page != page_of(asset, cluster)) return fail(error, MESHLODE_USAGE, "page: is not the page of this cluster");
  if (page.bytes == nullptr || !is_aligned(page.bytes)) {
    return fail(error, MESHLODE_USAGE, "page: its bytes are not at a multiple of 4");
  }
  const std::span bytes(static_cast<const std::uint8_t*>(page.bytes), asset.pages()[page.page].bytes);
  run::decode_cluster(asset, run::PageBytes(bytes), ClusterId(cluster), out);
  return MESHLODE_OK;
}

void copy_triangles(const run::DecodedCluster& cluster, std::uint8_t* triangles, std::uint32_t* materials) {
  if (triangles != nullptr) std::memcpy(triangles, cluster.triangles.data(), 3 * cluster.triangles.size());
  if (materials != nullptr) {
    std::copy(cluster.triangle_material.begin(), cluster.triangle_material.end(), materials);
  }
}

template <class Vector>
void copy_vectors(const std::vector<Vector>& from, float* to) {
  if (to == nullptr) return;
  for (const Vector& v : from) {
    for (int c = 0; c < Vector::length(); ++c) *to++ = v[c];
  }
}

}  // namespace
}  // namespace meshlode

using namespace meshlode;
using namespace meshlode::run::c;

uint32_t meshlode_version(void) {
  return MESHLODE_VERSION;
}

uint32_t meshlode_format_version(void) {
  return format::kVersion;
}

meshlode_status meshlode_open_file(const char* path, meshlode_asset** asset, meshlode_error* error) {
  if (path == nullptr || asset == nullptr) return fail(error, MESHLODE_USAGE, "path or asset is NULL");
  return guard(error, [&] { return take(run::Asset::open(path), asset, error); });
}

meshlode_status meshlode_open_buffer(const void* bytes, size_t size, meshlode_asset** asset, meshlode_error* error) {
  if (asset == nullptr || (bytes == nullptr && size > 0)) return fail(error, MESHLODE_USAGE, "bytes or asset is NULL");
  if (reinterpret_cast<std::uintptr_t>(bytes) % 8 != 0) {
    return fail(error, MESHLODE_USAGE, "bytes: not at a multiple of 8");
  }
  return guard(error, [&] {
    return take(run::Asset::from_bytes({static_cast<const std::uint8_t*>(bytes), size}), asset, error);
  });
}

void meshlode_close(meshlode_asset* asset) {
  delete asset;
}

const meshlode_mesh* meshlode_meshes(const meshlode_asset* asset, uint32_t* count) {
  return view<meshlode_mesh>(asset->asset.meshes(), count);
}
const meshlode_material* meshlode_materials(const meshlode_asset* asset, uint32_t* count) {
  return view<meshlode_material>(asset->asset.materials(), count);
}
const meshlode_instance* meshlode_instances(const meshlode_asset* asset, uint32_t* count) {
  return view<meshlode_instance>(asset->asset.instances(), count);
}
const meshlode_group* meshlode_groups(const meshlode_asset* asset, uint32_t* count) {
  return view<meshlode_group>(asset->asset.groups(), count);
}
const meshlode_cluster* meshlode_clusters(const meshlode_asset* asset, uint32_t* count) {
  return view<meshlode_cluster>(asset->asset.clusters(), count);
}
const meshlode_node* meshlode_nodes(const meshlode_asset* asset, uint32_t* count) {
  return view<meshlode_node>(asset->asset.nodes(), count);
}
const meshlode_page* meshlode_pages(const meshlode_asset* asset, uint32_t* count) {
  return view<meshlode_page>(asset->asset.pages(), count);
}
const meshlode_blob* meshlode_blobs(const meshlode_asset* asset, uint32_t* count) {
  return view<meshlode_blob>(asset->asset.blobs(), count);
}

const char* meshlode_text(const meshlode_asset* asset, meshlode_string string, size_t* bytes) {
  const std::string_view strings = asset->asset.strings();
  *bytes = 0;
  if (string.offset > strings.size() || string.bytes > strings.size() - string.offset) return nullptr;
  *bytes = string.bytes;
  return strings.data() + string.offset;
}

const void* meshlode_blob_bytes(const meshlode_asset* asset, uint32_t blob, size_t* bytes) {
  *bytes = 0;
  if (blob >= asset->asset.blobs().size()) return nullptr;
  const auto view = asset->asset.blob_bytes(asset->asset.blobs()[blob]);
  *bytes = view.size();
  return view.data();
}

meshlode_status meshlode_tables_of(const meshlode_asset* asset, uint32_t promise, meshlode_promise_tables* tables,
                                   meshlode_error* error) {
  return guard(error, [&] {
    const auto by = asset->assets.by(promise);
    if (!by) return fail(error, by.error());
    std::uint32_t count = 0;
    tables->meshes = view<meshlode_mesh>((*by)->meshes(), &count);
    tables->groups = view<meshlode_group>((*by)->groups(), &count);
    tables->nodes = view<meshlode_node>((*by)->nodes(), &count);
    return succeed(error);
  });
}

const char* meshlode_meta_json(const meshlode_asset* asset, size_t* bytes) {
  *bytes = asset->asset.meta_json().size();
  return asset->asset.meta_json().data();
}
const char* meshlode_scene_json(const meshlode_asset* asset, size_t* bytes) {
  *bytes = asset->asset.scene_json().size();
  return asset->asset.scene_json().data();
}

meshlode_status meshlode_select_view(const meshlode_asset* asset, const meshlode_view* view, double pixel_error,
                                     meshlode_draw_item* items, size_t capacity, size_t* count, meshlode_error* error) {
  return meshlode_select_frustum(asset, view, nullptr, pixel_error, items, capacity, count, error);
}

meshlode_status meshlode_select_uniform(const meshlode_asset* asset, uint32_t mesh, uint32_t promise, double max_error,
                                        uint32_t* clusters, size_t capacity, size_t* count, double* stored_error,
                                        meshlode_error* error) {
  if (mesh >= asset->asset.meshes().size()) return fail(error, MESHLODE_USAGE, "mesh: does not exist");
  if (!(max_error >= 0.0)) return fail(error, MESHLODE_USAGE, "max_error is not a number >= 0");
  return guard(error, [&] {
    const auto by = asset->assets.by(promise);
    if (!by) return fail(error, by.error());
    const run::UniformCut cut = run::select_uniform(**by, MeshId(mesh), max_error);
    *count = cut.clusters.size();
    if (stored_error != nullptr) *stored_error = cut.stored_error;
    for (std::size_t i = 0; i < std::min(capacity, cut.clusters.size()); ++i) clusters[i] = cut.clusters[i].value;
    return cut.clusters.size() <= capacity ? succeed(error)
                                           : fail(error, MESHLODE_TOO_SMALL, "more clusters than capacity");
  });
}

uint32_t meshlode_page_of(const meshlode_asset* asset, uint32_t cluster) {
  return cluster < asset->asset.clusters().size() ? page_of(asset->asset, cluster) : MESHLODE_NONE;
}

const uint32_t* meshlode_page_dependencies(const meshlode_asset* asset, uint32_t page, uint32_t* count) {
  *count = 0;
  if (page >= asset->asset.pages().size()) return nullptr;
  const format::PageRecord& record = asset->asset.pages()[page];
  *count = record.dependency_count;
  return asset->asset.page_dependencies().subspan(record.first_dependency, record.dependency_count).data();
}

meshlode_status meshlode_streaming_order(const meshlode_asset* asset, uint32_t promise, uint32_t* pages,
                                         meshlode_error* error) {
  return guard(error, [&] {
    const auto by = asset->assets.by(promise);
    if (!by) return fail(error, by.error());
    const std::vector<std::uint32_t> order = run::streaming_order(**by);
    std::copy(order.begin(), order.end(), pages);
    return succeed(error);
  });
}

meshlode_status meshlode_load_page(const meshlode_asset* asset, uint32_t page, void* out, size_t capacity,
                                   meshlode_error* error) {
  if (page >= asset->asset.pages().size()) return fail(error, MESHLODE_USAGE, "page: does not exist");
  if (out == nullptr || !is_aligned(out)) return fail(error, MESHLODE_USAGE, "out: not at a multiple of 4");
  if (capacity < asset->asset.pages()[page].bytes)
    return fail(error, MESHLODE_TOO_SMALL, "out: below the page's bytes");
  return guard(error, [&] {
    const auto bytes = run::load_page(asset->asset, PageId(page));
    if (!bytes) return fail(error, bytes.error());
    std::memcpy(out, bytes->bytes().data(), bytes->bytes().size());
    return succeed(error);
  });
}

meshlode_status meshlode_view_page(const meshlode_asset* asset, uint32_t page, const void** out,
                                   meshlode_error* error) {
  if (page >= asset->asset.pages().size()) return fail(error, MESHLODE_USAGE, "page: does not exist");
  if (asset->asset.pages()[page].codec != format::Codec::kNone) {
    return fail(error, MESHLODE_UNSUPPORTED, "page: is stored compressed, which meshlode_load_page unpacks");
  }
  return guard(error, [&] {
    const auto bytes = run::load_page(asset->asset, PageId(page));
    if (!bytes) return fail(error, bytes.error());
    *out = asset->asset.stored_page(PageId(page)).data();
    return succeed(error);
  });
}

meshlode_status meshlode_decode_floats(const meshlode_asset* asset, meshlode_page_bytes page, uint32_t cluster,
                                       meshlode_cluster_floats* out, meshlode_error* error) {
  return guard(error, [&] {
    run::DecodedCluster decoded;
    const meshlode_status status = decode(asset->asset, page, cluster, decoded, error);
    if (status != MESHLODE_OK) return status;
    out->vertex_count = decoded.vertex_count;
    out->triangle_count = decoded.triangle_count;
    if (out->vertex_capacity < decoded.vertex_count || out->triangle_capacity < decoded.triangle_count) {
      return fail(error, MESHLODE_TOO_SMALL, "more vertices or triangles than capacity");
    }
    const std::uint32_t group = asset->asset.clusters()[cluster].coarser_group;
    run::ClusterAttributes floats;
    run::decode_attributes(asset->asset.meshes()[asset->asset.groups()[group].mesh], decoded, floats);
    copy_vectors(floats.positions, out->positions);
    copy_vectors(floats.normals, out->normals);
    for (std::size_t k = 0; k < floats.uvs.size(); ++k) copy_vectors(floats.uvs[k], out->uvs[k]);
    copy_vectors(floats.colors, out->colors);
    copy_triangles(decoded, out->triangles, out->triangle_materials);
    return succeed(error);
  });
}

meshlode_status meshlode_decode_integers(const meshlode_asset* asset, meshlode_page_bytes page, uint32_t cluster,
                                         meshlode_cluster_integers* out, meshlode_error* error) {
  return guard(error, [&] {
    run::DecodedCluster decoded;
    const meshlode_status status = decode(asset->asset, page, cluster, decoded, error);
    if (status != MESHLODE_OK) return status;
    out->vertex_count = decoded.vertex_count;
    out->triangle_count = decoded.triangle_count;
    out->channel_count = decoded.channel_count;
    if (out->value_capacity < decoded.channels.size() || out->triangle_capacity < decoded.triangle_count) {
      return fail(error, MESHLODE_TOO_SMALL, "more values or triangles than capacity");
    }
    if (out->values != nullptr) std::copy(decoded.channels.begin(), decoded.channels.end(), out->values);
    copy_triangles(decoded, out->triangles, out->triangle_materials);
    return succeed(error);
  });
}
