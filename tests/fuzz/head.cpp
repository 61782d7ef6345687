// SPDX-License-Identifier: GPL-3.0-or-later
// An engine that reads a hostile file itself, in C: the head as far as it came, selections by what is resident, pages
// and images from their ranges. Four bytes before the file say what is resident, how much of the head is there, from
// how far the scene is seen, and how many pixels are allowed.
#include <algorithm>
#include <memory>
#include <vector>

#include <meshlode/meshlode.h>

#include "asset_mutator.h"
#include "harness.h"

namespace meshlode::fuzz {
namespace {

constexpr std::size_t kPrefix = 4;

void select(const meshlode_asset* asset, const std::uint8_t* choices, std::uint32_t pages) {
  meshlode_selector* selector = nullptr;
  require(meshlode_create_selector(asset, &selector, nullptr) == MESHLODE_OK, "no selector");
  std::uint32_t clusters = 0, instances = 0;
  (void)meshlode_clusters(asset, &clusters);
  (void)meshlode_instances(asset, &instances);
  meshlode_view view{};
  view.eye[2] = 0.01 * choices[2] * choices[2];
  view.fovy_radians = 0.8;
  view.near_distance = 1e-3;
  view.height_px = 720;
  view.ortho_height = 2.0;
  view.is_orthographic = choices[3] % 2;
  const double target[3] = {0.0, 0.0, view.eye[2] - 1.0}, up[3] = {0.0, 1.0, 0.0};
  meshlode_frustum frustum{};
  require(meshlode_make_frustum(&view, target, up, 1.5, &frustum, nullptr) == MESHLODE_OK, "no frustum");
  std::vector<std::uint32_t> resident((pages + 31) / 32);
  for (std::size_t w = 0; w < resident.size(); ++w)
    resident[w] = static_cast<std::uint32_t>(choices[0] * 0x9E3779B9U * (w + 1));
  std::vector<meshlode_draw_item> items(64);
  std::size_t count = 0;
  for (const meshlode_frustum* planes :
       {static_cast<const meshlode_frustum*>(nullptr), static_cast<const meshlode_frustum*>(&frustum)}) {
    const meshlode_status status = meshlode_select_resident(selector, &view, planes, choices[3] / 8.0, resident.data(),
                                                            items.data(), items.size(), &count, nullptr);
    require(status == (count > items.size() ? MESHLODE_TOO_SMALL : MESHLODE_OK), "a selection fails");
    for (std::size_t i = 0; i < std::min(count, items.size()); ++i) {
      require(items[i].cluster < clusters && items[i].instance < instances, "an item is not there");
      const std::uint32_t page = meshlode_page_of(asset, items[i].cluster);
      require((resident[page / 32] >> page % 32 & 1U) != 0, "what is drawn is not resident");
    }
    const meshlode_page_request* requests = meshlode_page_requests(selector, &count);
    for (std::size_t r = 0; r < count; ++r) {
      require(requests[r].page < pages && requests[r].priority > 0.0F, "a request for nothing");
      require((resident[requests[r].page / 32] >> requests[r].page % 32 & 1U) == 0, "a request for what is there");
      require(r == 0 || requests[r - 1].priority >= requests[r].priority, "requests out of order");
    }
  }
  meshlode_destroy_selector(selector);
}

/// What a reader asks before it reads a page: ranges that hold whole pages, and hints that can be compared.
void plan(const meshlode_asset* asset, std::uint64_t max_gap, std::uint32_t pages, std::uint64_t file_bytes) {
  std::vector<meshlode_range> ranges(pages + 1);
  std::size_t count = 0;
  require(meshlode_first_ranges(asset, max_gap, ranges.data(), ranges.size(), &count, nullptr) == MESHLODE_OK,
          "more first ranges than pages");
  for (std::size_t r = 0; r < count; ++r) {
    require(ranges[r].bytes <= file_bytes && ranges[r].offset <= file_bytes - ranges[r].bytes, "a range off the file");
    require(r == 0 || ranges[r].offset - ranges[r - 1].offset > ranges[r - 1].bytes, "ranges that meet");
  }
  require(count == 0 || meshlode_first_ranges(asset, max_gap, nullptr, 0, &count, nullptr) == MESHLODE_TOO_SMALL,
          "ranges without room");
  for (std::uint32_t p = 0; p < pages; ++p) {
    const meshlode_hint hint = meshlode_page_hint(asset, p);
    require(hint.radius >= 0.0F && hint.radius <= MESHLODE_INFINITE_ERROR && hint.smallest_error >= 0.0F &&
                hint.largest_error >= hint.smallest_error && hint.largest_error <= MESHLODE_INFINITE_ERROR,
            "a hint that says nothing");
    for (const float middle : hint.center) require(middle - middle == 0.0F, "a hint that is nowhere");
  }
}

void unpack(const meshlode_asset* asset, std::uint32_t pages, const std::uint8_t* file, std::size_t file_bytes) {
  const auto copy_of = [&](meshlode_range range) {  // of exactly its size
    auto copy = std::make_unique<std::uint8_t[]>(range.bytes);
    if (range.offset < file_bytes) {
      std::copy_n(file + range.offset, std::min<std::uint64_t>(range.bytes, file_bytes - range.offset), copy.get());
    }
    return copy;
  };
  std::uint32_t count = 0;
  const meshlode_page* records = meshlode_pages(asset, &count);
  for (std::uint32_t p = 0; p < pages; ++p) {
    const meshlode_range range = meshlode_page_range(asset, p);
    std::vector<std::uint32_t> words(records[p].bytes / 4);
    meshlode_error error{};
    const meshlode_status status =
        meshlode_unpack_page(asset, p, copy_of(range).get(), range.bytes, words.data(), records[p].bytes, &error);
    require(status == MESHLODE_OK || error.text[0] != '\0', "a refusal without a reason");
    if (status != MESHLODE_OK || records[p].cluster_count == 0) continue;
    meshlode_cluster_integers integers{};
    require(meshlode_decode_integers(asset, {p, words.data()}, records[p].first_cluster, &integers, nullptr) ==
                MESHLODE_TOO_SMALL,
            "a cluster of a page without integers");
  }
  (void)meshlode_blobs(asset, &count);
  for (std::uint32_t b = 0; b < count; ++b) {
    const meshlode_range range = meshlode_blob_range(asset, b);
    (void)meshlode_check_blob(asset, b, copy_of(range).get(), range.bytes, nullptr);
  }
  for (std::uint32_t t = 0; t < 4; ++t) {
    const std::uint32_t blob = meshlode_blob_of_image(asset, meshlode_image_of_texture(asset, t));
    require(blob == MESHLODE_NONE || blob < count, "an image that is not there");
  }
}

}  // namespace
}  // namespace meshlode::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace meshlode::fuzz;
  if (size < kPrefix) return 0;
  const std::uint8_t* const file = data + kPrefix;
  const std::size_t file_bytes = size - kPrefix;
  // As a caller asks: with what it has, and again with what is needed.
  std::uint64_t needed = 0, asked = 0;
  meshlode_status status = MESHLODE_TOO_SMALL;
  for (int step = 0; step < 3 && status == MESHLODE_TOO_SMALL; ++step) {
    asked = std::min<std::uint64_t>(needed, file_bytes);
    status = meshlode_head_bytes(file, asked, file_bytes, &needed, nullptr);
    require(status != MESHLODE_TOO_SMALL || (needed > asked && needed <= file_bytes), "no step forward");
  }
  require(status != MESHLODE_TOO_SMALL, "more than three steps to a head");
  const std::size_t there = status == MESHLODE_OK ? needed - (needed * data[1] >> 8U) : file_bytes;
  const auto copy = std::make_unique<std::uint8_t[]>(there);
  std::copy_n(file, there, copy.get());
  meshlode_asset* asset = nullptr;
  meshlode_error error{};
  if (meshlode_open_head(copy.get(), there, file_bytes, &asset, &error) != MESHLODE_OK) {
    require(error.text[0] != '\0' && asset == nullptr, "a refusal without a reason");
    return 0;
  }
  require(there == needed, "a head that is cut off was opened");
  std::uint32_t pages = 0;
  (void)meshlode_pages(asset, &pages);
  select(asset, data, pages);
  plan(asset, std::uint64_t{data[0]} << (data[3] % 64U), pages, file_bytes);
  unpack(asset, pages, file, file_bytes);
  meshlode_close(asset);
  return 0;
}

#ifdef MESHLODE_FUZZ
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return meshlode::fuzz::mutate_asset(data, size, max_size, seed, meshlode::fuzz::kPrefix);
}
#endif
