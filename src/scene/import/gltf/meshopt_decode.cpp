// SPDX-License-Identifier: GPL-3.0-or-later
// The one file of the program that sees meshoptimizer. Its decoders check every read, but believe that the destination
// is as large as the counts say and that strides are allowed: both are checked before.
#include "scene/import/gltf/meshopt_decode.h"

#include <cstring>
#include <string>

#include <meshoptimizer.h>

#include "base/try.h"

namespace meshlode::scene {

namespace {

Error invalid_stream(std::string detail) {
  return {ErrorCode::kInvalid, "", "meshoptimizer: " + std::move(detail)};
}

/// The first byte of a stream: its kind above, its version below.
struct Codec {
  const char* name;
  std::uint8_t kind;
  std::uint8_t newest;  ///< version that the library of Debian 12 reads
};

Codec codec_of(MeshoptMode mode) {
  switch (mode) {
    case MeshoptMode::kTriangles: return {"triangle", 0xE0, 1};
    case MeshoptMode::kIndices: return {"index", 0xD0, 1};
    case MeshoptMode::kAttributes: break;
  }
  return {"vertex", 0xA0, 0};
}

Status check_head(std::span<const std::uint8_t> stream, const MeshoptLayout& layout) {
  const Codec codec = codec_of(layout.mode);
  if (stream.empty()) return invalid_stream("the stream is empty");
  if ((stream[0] & 0xF0U) != codec.kind) return invalid_stream(std::string("this is no ") + codec.name + " stream");
  const unsigned version = stream[0] & 0x0FU;
  if (version > codec.newest) {
    return Error{ErrorCode::kUnsupported, "",
                 std::string("meshoptimizer: version ") + std::to_string(version) + " of the " + codec.name +
                     " codec is not supported, only up to " + std::to_string(codec.newest)};
  }
  if (layout.size_bytes() / kMeshoptMaxExpansion > stream.size()) {
    return invalid_stream(std::to_string(stream.size()) + " bytes are too few for " + std::to_string(layout.count) +
                          " elements of " + std::to_string(layout.stride));
  }
  return Ok{};
}

/// Indices as 32 bits: asked for 16, the library would cut larger ones off and name other vertices.
bool decode_indices(std::span<const std::uint8_t> stream, const MeshoptLayout& layout, std::uint32_t* out) {
  constexpr std::size_t kSize = sizeof(std::uint32_t);
  const int failed = layout.mode == MeshoptMode::kTriangles
                         ? meshopt_decodeIndexBuffer(out, layout.count, kSize, stream.data(), stream.size())
                         : meshopt_decodeIndexSequence(out, layout.count, kSize, stream.data(), stream.size());
  return failed == 0;
}

}  // namespace

bool is_sound(const MeshoptLayout& layout) {
  if (layout.mode != MeshoptMode::kAttributes) {
    return layout.filter == MeshoptFilter::kNone && (layout.stride == 2 || layout.stride == 4) &&
           (layout.mode != MeshoptMode::kTriangles || layout.count % 3 == 0);
  }
  if (layout.stride == 0 || layout.stride > 256 || layout.stride % 4 != 0) return false;
  if (layout.filter == MeshoptFilter::kOctahedral) return layout.stride == 4 || layout.stride == 8;
  return layout.filter != MeshoptFilter::kQuaternion || layout.stride == 8;
}

Result<std::vector<std::uint8_t>> decode_meshopt(std::span<const std::uint8_t> stream, const MeshoptLayout& layout) {
  TRY(check_head(stream, layout));
  const Error broken = invalid_stream("a stream that is broken or not of " + std::to_string(layout.count) +
                                      " elements of " + std::to_string(layout.stride) + " bytes");
  std::vector<std::uint8_t> out;
  if (layout.mode == MeshoptMode::kAttributes) {
    out.resize(layout.size_bytes());
    if (meshopt_decodeVertexBuffer(out.data(), layout.count, layout.stride, stream.data(), stream.size()) != 0) {
      return broken;
    }
    undo_meshopt_filter(layout, out);
    return out;
  }
  if (layout.count > stream.size() * 3) return broken;  // a byte a triangle at the least, or a byte an index
  std::vector<std::uint32_t> indices(layout.count);
  if (!decode_indices(stream, layout, indices.data())) return broken;
  out.resize(layout.size_bytes());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (layout.stride == 2 && indices[i] > 0xFFFFU) {
      return invalid_stream("index " + std::to_string(indices[i]) + " at " + std::to_string(i) +
                            " does not fit 16 bits");
    }
    std::memcpy(out.data() + i * layout.stride, &indices[i], layout.stride);  // little-endian: the low bytes first
  }
  return out;
}

}  // namespace meshlode::scene
