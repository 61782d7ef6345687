// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/corners.h"

#include <array>
#include <limits>
#include <string>

#include "base/try.h"

namespace meshlode::scene {

namespace {

/// "indices MUST NOT contain the maximum value of their type": it would mean primitive restart (3.7.2.1).
std::uint64_t restart_value(const CornerSource& source) {
  if (source.indices == nullptr) return std::numeric_limits<std::uint64_t>::max();
  return source.indices->component_type() == kGltfUnsignedByte    ? 0xFFu
         : source.indices->component_type() == kGltfUnsignedShort ? 0xFFFFu
                                                                  : 0xFFFFFFFFu;
}

std::uint32_t vertex_at(const CornerSource& source, std::uint64_t at) {
  return source.indices != nullptr ? source.indices->index(at) : static_cast<std::uint32_t>(at);
}

Error bad_index(const CornerSource& source, std::uint64_t at) {
  const std::uint32_t index = vertex_at(source, at);
  std::string why = " is out of range: there are " + std::to_string(source.vertex_count) + " vertices";
  if (index == restart_value(source) && source.mode == TINYGLTF_MODE_TRIANGLES) {
    why = " is the primitive restart value, which a list of triangles cannot have; --repair drops the triangle";
  } else if (index == restart_value(source)) {
    why = " is the primitive restart value, which no extension allows here; --repair gives the triangles: it splits " +
          std::string(source.mode == TINYGLTF_MODE_TRIANGLE_STRIP ? "the strip there" : "the fan there");
  }
  return {ErrorCode::kInvalid, "", "index " + std::to_string(index) + " at " + std::to_string(at) + why};
}

std::uint64_t triangles_in(int mode, std::uint64_t count) {
  if (mode == TINYGLTF_MODE_TRIANGLES) return count / 3;
  return count < 3 ? 0 : count - 2;
}

/// The triangles of the corners from `begin` to `end`.
Status add_part(const CornerSource& source, std::uint64_t begin, std::uint64_t end, TriangleCorners& out) {
  const std::uint64_t triangle_count = triangles_in(source.mode, end - begin);
  const std::uint64_t restart = restart_value(source);
  for (std::uint64_t t = 0; t < triangle_count; ++t) {
    std::array<std::uint64_t, 3> at{3 * t, 3 * t + 1, 3 * t + 2};
    // Every second triangle of a strip turns the other way; a fan's centre comes last.
    if (source.mode == TINYGLTF_MODE_TRIANGLE_STRIP) at = {t, t + (1 + t % 2), t + (2 - t % 2)};
    if (source.mode == TINYGLTF_MODE_TRIANGLE_FAN) at = {t + 1, t + 2, 0};
    std::array<std::uint32_t, 3> triangle{};
    bool is_valid = true;
    for (std::size_t c = 0; c < 3; ++c) {
      triangle[c] = vertex_at(source, begin + at[c]);
      if (triangle[c] < source.vertex_count && triangle[c] != restart) continue;
      if (!source.repair) return bad_index(source, begin + at[c]);
      is_valid = false;
    }
    if (is_valid) {
      out.vertices.insert(out.vertices.end(), triangle.begin(), triangle.end());
    } else {
      ++out.broken;
    }
  }
  return Ok{};
}

}  // namespace

std::uint64_t CornerSource::triangle_count() const {
  return triangles_in(mode, count());
}

Result<TriangleCorners> read_corners(const CornerSource& source) {
  TriangleCorners out;
  out.vertices.reserve(3 * source.triangle_count());
  const bool may_split =
      source.indices != nullptr && source.mode != TINYGLTF_MODE_TRIANGLES && (source.may_restart || source.repair);
  const std::uint64_t restart = restart_value(source);
  std::uint64_t begin = 0;
  for (std::uint64_t at = 0; may_split && at < source.count(); ++at) {
    if (vertex_at(source, at) != restart) continue;
    TRY(add_part(source, begin, at, out));
    begin = at + 1;
    ++out.restarts;
  }
  TRY(add_part(source, begin, source.count(), out));
  return out;
}

}  // namespace meshlode::scene
