// SPDX-License-Identifier: GPL-3.0-or-later
// KHR_draco_mesh_compression: one compressed buffer view becomes indices and flat attribute arrays.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::scene {

struct DracoAttribute {
  std::uint32_t component_type = 0;   ///< glTF's componentType
  std::uint32_t component_count = 0;  ///< 1 … 4
  std::vector<std::uint8_t> bytes;    ///< point_count tightly packed elements
};

struct DracoMesh {
  std::uint32_t point_count = 0;
  std::vector<std::uint32_t> indices;                  ///< 3 per face, each < point_count
  std::map<std::uint32_t, DracoAttribute> attributes;  ///< by Draco's unique id
};

/// What the glTF says the bytes hold. Draco is not started on bytes whose own header says otherwise.
struct DracoExpectation {
  std::uint64_t point_count = 0;
  std::uint64_t max_face_count = 0;
  bool is_face_count_exact = true;
  std::vector<std::uint32_t> attribute_ids;  ///< unique ids to extract
  std::uint64_t max_bytes = UINT64_MAX;      ///< of all attributes in the stream, those that nobody asked for too
};

/// Errors: kInvalid, with `where` left to the caller.
[[nodiscard]] Result<DracoMesh> decode_draco(std::span<const std::uint8_t> bytes, const DracoExpectation& expected);

}  // namespace meshlode::scene
