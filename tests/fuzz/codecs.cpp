// SPDX-License-Identifier: GPL-3.0-or-later
// Each page codec's unpacker on any bytes: the first byte chooses the codec, the next two the size asked for.
#include <vector>

#include "harness.h"
#include "unpack/codecs.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace meshlode;
  if (size < 3) return 0;
  const std::size_t wanted = std::size_t{data[1]} | std::size_t{data[2]} << 8U;
  const std::vector<std::uint8_t> stored(data + 3, data + size);
  std::vector<std::uint8_t> out(wanted);
  switch (data[0] % 2) {
    case 0: (void)unpack_lz4(stored, out); break;
    default: (void)unpack_zstd(stored, out); break;
  }
  return 0;
}
