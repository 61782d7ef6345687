// SPDX-License-Identifier: GPL-3.0-or-later
// The same through <meshlode/meshlode.h>, with memory of exactly the sizes that the library asks for.
#include <algorithm>
#include <memory>
#include <vector>

#include <meshlode/meshlode.h>

#include "harness.h"
#include "read_all.h"

namespace meshlode::fuzz {

namespace {

void decode_page_c(const meshlode_asset* asset, std::uint32_t index, const meshlode_page& page) {
  std::vector<std::uint32_t> words(page.bytes / 4 + 1);
  if (meshlode_load_page(asset, index, words.data(), page.bytes, nullptr) != MESHLODE_OK) return;
  for (std::uint32_t c = page.first_cluster; c < page.first_cluster + page.cluster_count; ++c) {
    const meshlode_page_bytes bytes = {index, words.data()};
    meshlode_cluster_integers integers{};
    meshlode_decode_integers(asset, bytes, c, &integers, nullptr);  // for the sizes
    const std::uint32_t n = integers.vertex_count, m = integers.triangle_count;
    std::vector<std::int32_t> values(std::size_t{n} * integers.channel_count);
    std::vector<std::uint8_t> corners(std::size_t{3} * m);
    std::vector<std::uint32_t> materials(m);
    integers.value_capacity = static_cast<std::uint32_t>(values.size());
    integers.triangle_capacity = m;
    integers.values = values.data();
    integers.triangles = corners.data();
    integers.triangle_materials = materials.data();
    require(meshlode_decode_integers(asset, bytes, c, &integers, nullptr) == MESHLODE_OK, "integers of a loaded page");
    for (const std::uint8_t v : corners) require(v < n, "a corner is no vertex, in C");
    meshlode_cluster_floats floats{};
    std::vector<float> positions(std::size_t{3} * n), normals(std::size_t{3} * n), colors(std::size_t{4} * n);
    std::vector<float> uvs[MESHLODE_MAX_UV_SETS];
    floats.vertex_capacity = n;
    floats.triangle_capacity = m;
    floats.positions = positions.data();
    floats.normals = normals.data();
    floats.colors = colors.data();
    for (std::size_t k = 0; k < MESHLODE_MAX_UV_SETS; ++k) {
      uvs[k].resize(std::size_t{2} * n);
      floats.uvs[k] = uvs[k].data();
    }
    require(meshlode_decode_floats(asset, bytes, c, &floats, nullptr) == MESHLODE_OK, "floats of a loaded page");
  }
}

}  // namespace

void read_all_c(std::span<const std::uint8_t> bytes) {
  // Operator new gives more than 8 bytes of alignment, and exactly this many.
  const auto copy = std::make_unique<std::uint8_t[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), copy.get());
  meshlode_asset* asset = nullptr;
  meshlode_error error{};
  if (meshlode_open_buffer(copy.get(), bytes.size(), &asset, &error) != MESHLODE_OK) {
    require(error.text[0] != '\0' && asset == nullptr, "a refusal without a reason, in C");
    return;
  }
  std::uint32_t count = 0;
  const meshlode_page* pages = meshlode_pages(asset, &count);
  std::vector<std::uint32_t> order(count);
  require(meshlode_streaming_order(asset, MESHLODE_PROMISE_POSITION, order.data(), &error) == MESHLODE_OK,
          "no order of pages");
  std::vector<bool> is_loaded(count);
  for (const std::uint32_t p : order) {
    std::uint32_t needed_count = 0;
    const std::uint32_t* needed = meshlode_page_dependencies(asset, p, &needed_count);
    for (std::uint32_t i = 0; i < needed_count; ++i) require(is_loaded[needed[i]], "a page before what it needs");
    require(!is_loaded[p], "a page twice");
    is_loaded[p] = true;
    decode_page_c(asset, p, pages[p]);
  }
  meshlode_close(asset);
}

}  // namespace meshlode::fuzz
