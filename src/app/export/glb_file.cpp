// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/glb_file.h"

namespace meshlode::app {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546C67U;   // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534AU;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942U;   // "BIN\0"

std::size_t pad4(std::size_t n) {
  return (n + 3) / 4 * 4;
}

void put_u32(std::vector<std::uint8_t>& out, std::size_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

}  // namespace

GlbBinary::Range GlbBinary::append(std::span<const std::uint8_t> bytes) {
  bytes_.resize(pad4(bytes_.size()));
  const Range range{bytes_.size(), bytes.size()};
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  return range;
}

Result<std::vector<std::uint8_t>> assemble_glb(std::string_view json, std::span<const std::uint8_t> binary) {
  const std::size_t json_bytes = pad4(json.size());
  const std::size_t binary_bytes = pad4(binary.size());
  const std::size_t total = 12 + 8 + json_bytes + (binary.empty() ? 0 : 8 + binary_bytes);
  if (total > 0xFFFFFFFFULL) {
    return Error{ErrorCode::kUnsupported, "", "the cut needs " + std::to_string(total) + " bytes, a GLB holds 4 GiB"};
  }
  std::vector<std::uint8_t> out;
  out.reserve(total);
  put_u32(out, kGlbMagic);
  put_u32(out, 2);
  put_u32(out, total);
  put_u32(out, json_bytes);
  put_u32(out, kJsonChunk);
  out.insert(out.end(), json.begin(), json.end());
  out.resize(20 + json_bytes, static_cast<std::uint8_t>(' '));
  if (!binary.empty()) {
    put_u32(out, binary_bytes);
    put_u32(out, kBinChunk);
    out.insert(out.end(), binary.begin(), binary.end());
    out.resize(total, 0);
  }
  return out;
}

}  // namespace meshlode::app
