// SPDX-License-Identifier: GPL-3.0-or-later
// Each page codec's unpacker on any bytes: the first byte chooses the codec, the second the mesh's attributes and the number
// of clusters, the next two the size asked for.
#include <vector>

#include "coding/section_columns.h"
#include "harness.h"
#include "unpack/codecs.h"
#include "unpack/stored_page.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace meshlode;
  if (size < 4) return 0;
  const std::size_t wanted = std::size_t{data[2]} | std::size_t{data[3]} << 8U;
  const std::vector<std::uint8_t> stored(data + 4, data + size);
  std::vector<std::uint8_t> out(wanted);
  format::MeshRecord mesh{};
  mesh.normal_mode = (data[1] & 1U) != 0 ? format::NormalMode::kStored : format::NormalMode::kNone;
  mesh.normal_scale = 812;
  mesh.uv_set_count = data[1] >> 1U & 3U;
  mesh.has_color = data[1] >> 3U & 1U;
  mesh.material = (data[1] & 16U) != 0 ? format::kNone : 0U;
  format::PageRecord record{};
  record.cluster_count = 1U + (data[1] >> 5U);
  std::vector<std::uint32_t> words(wanted / 4);
  const auto unpack_as = [&](format::Codec codec) {
    record.codec = codec;
    (void)unpack_page(mesh, record, stored, words);
  };
  switch (data[0] % 6) {
    case 0: (void)unpack_lz4(stored, out); break;
    case 1: (void)unpack_zstd(stored, out); break;
    case 2: (void)decode_section(stored, 2U * (data[1] % 32U), out); break;
    case 3: unpack_as(format::Codec::kLz4); break;
    case 4: unpack_as(format::Codec::kZstd); break;
    default: unpack_as(format::Codec::kDraco); break;
  }
  return 0;
}
