// SPDX-License-Identifier: MIT
// The part of <meshlode/meshlode.h> for callers that read a file themselves: heads, ranges, bytes that they hand in,
// and selection by what is there.
#include <optional>

#include "format/page_hint.h"
#include "run/api/c_shared.h"
#include "run/read/find_image.h"
#include "run/read/sections.h"
#include "run/select/resident.h"
#include "run/select/streaming_order.h"
#include "run/unpack/unpack.h"

struct meshlode_selector {
  const meshlode::run::AssetByPromise* assets;
  meshlode::run::ResidentSelector selector;
};

namespace meshlode {
namespace {

std::span<const std::uint8_t> bytes_at(const void* bytes, std::size_t size) {
  return {static_cast<const std::uint8_t*>(bytes), size};
}

run::Frustum planes_of_c(const meshlode_frustum& frustum) {
  run::Frustum out;
  static_assert(sizeof(out.planes) == sizeof(frustum.planes));
  std::memcpy(&out.planes, frustum.planes, sizeof(out.planes));
  return out;
}

static_assert(sizeof(run::ClusterInstance) == sizeof(meshlode_draw_item) &&
              sizeof(run::PageRequest) == sizeof(meshlode_page_request));

}  // namespace
}  // namespace meshlode

using namespace meshlode;
using namespace meshlode::run::c;

meshlode_status meshlode_head_bytes(const void* first, size_t size, uint64_t file_bytes, uint64_t* needed,
                                    meshlode_error* error) {
  if (needed == nullptr || (first == nullptr && size > 0))
    return fail(error, MESHLODE_USAGE, "first or needed is NULL");
  return guard(error, [&] {
    const auto head = run::find_head(bytes_at(first, size), file_bytes);
    if (!head) return fail(error, head.error());
    *needed = head->bytes;
    return head->is_known ? succeed(error) : fail(error, MESHLODE_TOO_SMALL, "first: more bytes are needed");
  });
}

meshlode_status meshlode_open_head(const void* bytes, size_t size, uint64_t file_bytes, meshlode_asset** asset,
                                   meshlode_error* error) {
  if (asset == nullptr || (bytes == nullptr && size > 0)) return fail(error, MESHLODE_USAGE, "bytes or asset is NULL");
  if (reinterpret_cast<std::uintptr_t>(bytes) % 8 != 0) {
    return fail(error, MESHLODE_USAGE, "bytes: not at a multiple of 8");
  }
  return guard(error, [&] { return take(run::Asset::from_head(bytes_at(bytes, size), file_bytes), asset, error); });
}

meshlode_range meshlode_blob_range(const meshlode_asset* asset, uint32_t blob) {
  if (blob >= asset->asset.blobs().size()) return {0, 0};
  return {asset->asset.blobs()[blob].offset, asset->asset.blobs()[blob].bytes};
}

meshlode_status meshlode_check_blob(const meshlode_asset* asset, uint32_t blob, const void* bytes, size_t size,
                                    meshlode_error* error) {
  if (bytes == nullptr && size > 0) return fail(error, MESHLODE_USAGE, "bytes is NULL");
  return guard(error, [&] {
    const Status status = run::check_blob(asset->asset, blob, bytes_at(bytes, size));
    return status ? succeed(error) : fail(error, status.error());
  });
}

uint32_t meshlode_image_of_texture(const meshlode_asset* asset, uint32_t texture) {
  return run::find_image_of_texture(asset->asset, texture);
}

uint32_t meshlode_blob_of_image(const meshlode_asset* asset, uint32_t image) {
  return run::find_blob_of_image(asset->asset, image);
}

meshlode_range meshlode_page_range(const meshlode_asset* asset, uint32_t page) {
  if (page >= asset->asset.pages().size()) return {0, 0};
  return {asset->asset.pages()[page].offset, asset->asset.pages()[page].stored_bytes};
}

meshlode_hint meshlode_page_hint(const meshlode_asset* asset, uint32_t page) {
  meshlode_hint out{};
  if (page >= asset->asset.pages().size()) return out;
  const format::PageRecord& record = asset->asset.pages()[page];
  const format::PageHintRecord hint =
      format::make_page_hint(asset->asset.groups().subspan(record.first_group, record.group_count));
  static_assert(sizeof(out) == sizeof(hint));
  std::memcpy(&out, &hint, sizeof(out));
  return out;
}

meshlode_status meshlode_first_ranges(const meshlode_asset* asset, uint64_t max_gap, meshlode_range* ranges,
                                      size_t capacity, size_t* count, meshlode_error* error) {
  return guard(error, [&] {
    const std::vector<run::FileRange> found = run::first_ranges(asset->asset, max_gap);
    *count = found.size();
    for (std::size_t i = 0; i < std::min(capacity, found.size()); ++i) ranges[i] = {found[i].offset, found[i].bytes};
    return found.size() <= capacity ? succeed(error) : fail(error, MESHLODE_TOO_SMALL, "more ranges than capacity");
  });
}

meshlode_status meshlode_unpack_page(const meshlode_asset* asset, uint32_t page, const void* stored, size_t size,
                                     void* out, size_t capacity, meshlode_error* error) {
  if (page >= asset->asset.pages().size()) return fail(error, MESHLODE_USAGE, "page: does not exist");
  if (stored == nullptr) return fail(error, MESHLODE_USAGE, "stored is NULL");
  if (out == nullptr || !is_aligned(out)) return fail(error, MESHLODE_USAGE, "out: not at a multiple of 4");
  if (capacity < asset->asset.pages()[page].bytes)
    return fail(error, MESHLODE_TOO_SMALL, "out: below the page's bytes");
  return guard(error, [&] {
    const Status status = run::unpack_stored_page(asset->asset, PageId(page), bytes_at(stored, size),
                                                  {static_cast<std::uint32_t*>(out), capacity / 4});
    return status ? succeed(error) : fail(error, status.error());
  });
}

meshlode_status meshlode_make_frustum(const meshlode_view* view, const double target[3], const double up[3],
                                      double aspect, meshlode_frustum* frustum, meshlode_error* error) {
  run::Camera camera;
  if (const meshlode_status status = read_view(*view, 0.0, camera, error); status != MESHLODE_OK) return status;
  const auto made = run::frustum_of_view(camera, target, up, aspect);
  if (!made) return fail(error, MESHLODE_USAGE, run::kFrustumFault);
  std::memcpy(frustum->planes, &made->planes, sizeof(frustum->planes));
  return succeed(error);
}

meshlode_status meshlode_select_frustum(const meshlode_asset* asset, const meshlode_view* view,
                                        const meshlode_frustum* frustum, double pixel_error, meshlode_draw_item* items,
                                        size_t capacity, size_t* count, meshlode_error* error) {
  run::Camera camera;
  if (const meshlode_status status = read_view(*view, pixel_error, camera, error); status != MESHLODE_OK) return status;
  const auto planes = frustum != nullptr ? std::optional(planes_of_c(*frustum)) : std::nullopt;
  return guard(error, [&] {
    const auto by = asset->assets.by(view->promise);
    if (!by) return fail(error, by.error());
    const std::vector<run::ClusterInstance> drawn =
        run::select_bvh(**by, camera, pixel_error, {}, planes ? &*planes : nullptr);
    *count = drawn.size();
    for (std::size_t i = 0; i < std::min(capacity, drawn.size()); ++i) {
      items[i] = {drawn[i].instance.value, drawn[i].cluster.value};
    }
    return drawn.size() <= capacity ? succeed(error) : fail(error, MESHLODE_TOO_SMALL, "more items than capacity");
  });
}

meshlode_status meshlode_create_selector(const meshlode_asset* asset, meshlode_selector** selector,
                                         meshlode_error* error) {
  return guard(error, [&] {
    *selector = new meshlode_selector{&asset->assets, run::ResidentSelector(run::tables_of(asset->asset))};
    return succeed(error);
  });
}

void meshlode_destroy_selector(meshlode_selector* selector) {
  delete selector;
}

meshlode_status meshlode_select_resident(meshlode_selector* selector, const meshlode_view* view,
                                         const meshlode_frustum* frustum, double pixel_error, const uint32_t* resident,
                                         meshlode_draw_item* items, size_t capacity, size_t* count,
                                         meshlode_error* error) {
  run::Camera camera;
  if (const meshlode_status status = read_view(*view, pixel_error, camera, error); status != MESHLODE_OK) return status;
  const auto planes = frustum != nullptr ? std::optional(planes_of_c(*frustum)) : std::nullopt;
  return guard(error, [&] {
    const auto by = selector->assets->by(view->promise);
    if (!by) return fail(error, by.error());
    const std::size_t words = resident != nullptr ? ((*by)->pages().size() + 31) / 32 : 0;
    const run::ResidentQuery query{camera, pixel_error, {resident, words}, planes ? &*planes : nullptr};
    *count = selector->selector.select(run::tables_of(**by), query,
                                       {reinterpret_cast<run::ClusterInstance*>(items), capacity});
    return *count <= capacity ? succeed(error) : fail(error, MESHLODE_TOO_SMALL, "more items than capacity");
  });
}

const meshlode_page_request* meshlode_page_requests(const meshlode_selector* selector, size_t* count) {
  *count = selector->selector.requests().size();
  return reinterpret_cast<const meshlode_page_request*>(selector->selector.requests().data());
}

const float* meshlode_page_priorities(const meshlode_selector* selector, size_t* count) {
  *count = selector->selector.page_priorities().size();
  return selector->selector.page_priorities().data();
}
