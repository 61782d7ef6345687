// SPDX-License-Identifier: GPL-3.0-or-later
// One stream of EXT_meshopt_compression: the bytes of a compressed buffer view become those that accessors read.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::scene {

enum class MeshoptMode : std::uint8_t { kAttributes, kTriangles, kIndices };
enum class MeshoptFilter : std::uint8_t { kNone, kOctahedral, kQuaternion, kExponential };

/// What the glTF says a stream holds.
struct MeshoptLayout {
  MeshoptMode mode = MeshoptMode::kAttributes;
  MeshoptFilter filter = MeshoptFilter::kNone;
  std::uint64_t count = 0;   ///< elements; of triangles three a triangle
  std::uint32_t stride = 0;  ///< bytes of one
  [[nodiscard]] std::uint64_t size_bytes() const { return count * stride; }
};

/// The most that a byte of a stream can stand for: two bits for sixteen bytes that are all as before.
constexpr std::uint64_t kMeshoptMaxExpansion = 64;

/// Whether mode, filter, stride and count go together as the extension has it.
[[nodiscard]] bool is_sound(const MeshoptLayout& layout);

/// layout.size_bytes() bytes. Nothing is allocated for a stream that is too short for them. Indices are not compared
/// with any number of vertices. Errors, with `where` left to the caller: kInvalid, kUnsupported for a newer bitstream.
/// \pre is_sound(layout)
[[nodiscard]] Result<std::vector<std::uint8_t>> decode_meshopt(std::span<const std::uint8_t> stream,
                                                               const MeshoptLayout& layout);

/// Undoes a filter in place, element by element. \pre is_sound(layout), elements hold layout.size_bytes() bytes
void undo_meshopt_filter(const MeshoptLayout& layout, std::span<std::uint8_t> elements);

}  // namespace meshlode::scene
