// SPDX-License-Identifier: GPL-3.0-or-later
// Each page codec's unpacker on any bytes: the first byte chooses the codec, the second the mesh's attributes, the
// third the number of clusters, the next two the size asked for.
#include <algorithm>
#include <vector>

#include "format/section_columns.h"
#include "harness.h"
#include "run/unpack/decompressors.h"
#include "run/unpack/unpack_page.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace meshlode;
  if (size < 5) return 0;
  const std::size_t wanted = std::size_t{data[3]} | std::size_t{data[4]} << 8U;
  const std::vector<std::uint8_t> stored(data + 5, data + size);
  std::vector<std::uint8_t> out(wanted);
  format::MeshRecord mesh{};
  mesh.normal_mode = (data[1] & 1U) != 0 ? format::NormalMode::kStored : format::NormalMode::kNone;
  mesh.normal_scale = 812;
  mesh.uv_set_count = std::min(data[1] >> 1U & 7U, format::kMaxUvSets);
  mesh.has_color = data[1] >> 4U & 1U;
  mesh.material = (data[1] & 32U) != 0 ? format::kNone : 0U;
  format::PageRecord record{};
  record.cluster_count = 1U + data[2];
  std::vector<std::uint32_t> words(wanted / 4);
  const auto unpack_as = [&](format::Codec codec) {
    record.codec = codec;
    (void)run::unpack_page(mesh, record, stored, words);
  };
  switch (data[0] % 7) {
    case 0: (void)run::unpack_lz4(stored, out); break;
    case 1: (void)run::unpack_zstd(stored, out); break;
    case 2: (void)format::decode_section(stored, 2U * (data[1] % 32U), out); break;
    default: unpack_as(static_cast<format::Codec>(data[0] % 7 - 2)); break;
  }
  return 0;
}
