// SPDX-License-Identifier: MIT
// What a stored page consists of (docs/reference/format.md, Stored pages): names for the streams and tables, and the
// order of the words that are not geometry.
#pragma once

#include <array>
#include <cstdint>

#include <meshlode/format.h>

#include "format/prefix_code.h"
#include "format/vertex_fields.h"

namespace meshlode::format {

/// Start of the stored bytes of a page whose codec is not none. Side information follows, then for kStrips the size of
/// each stream (u32), then the streams; for kColumns the words of the clusters' bit streams.
struct StoredHeader {
  std::uint32_t method;       ///< PageMethod
  std::uint32_t side_stored;  ///< bytes of the side information as they follow, through the codec's library
  std::uint32_t side_bytes;   ///< the same, decoded
  std::uint32_t twin_count;   ///< of kStrips, else 0
};
static_assert(sizeof(StoredHeader) == 16);

enum class PageMethod : std::uint32_t {
  kColumns = 1,  ///< heads and ranges by columns, bit streams as they are
  kStrips = 2,   ///< predicted along the strips
};

/// \pre codec is one of the enumerators, and not kNone
[[nodiscard]] constexpr PageMethod method_of(Codec codec) {
  switch (codec) {  // without a default, so that the compiler names a new codec
    case Codec::kLz4:
    case Codec::kZstd: return PageMethod::kColumns;
    case Codec::kNone:
    case Codec::kDraco:
    case Codec::kStrips: break;
  }
  return PageMethod::kStrips;
}

/// A slot of a strip names its vertex in one of three ways.
enum class SlotKind : std::uint8_t {
  kReference = 0,  ///< a vertex named before in this cluster
  kNew = 1,        ///< the next vertex of this cluster, predicted
  kTwin = 2,       ///< the next vertex of this cluster, equal to one of an earlier cluster of the page
};
constexpr std::uint32_t kSlotKinds = 3;

/// A triangle that continues a strip is 3 · turn + kind of its new slot; three of them in a row are one symbol, the
/// first one counting least. What is missing at a cluster's end is zero.
constexpr std::uint32_t kTriangleSymbols = 2 * kSlotKinds;
constexpr std::uint32_t kTripleSymbols = kTriangleSymbols * kTriangleSymbols * kTriangleSymbols;
/// The three slots of a strip's first triangle, the first one counting most.
constexpr std::uint32_t kStartSymbols = kSlotKinds * kSlotKinds * kSlotKinds;

enum Stream : std::uint32_t {
  kTripleStream,     ///< symbols
  kStartStream,      ///< symbols, one a strip
  kLengthStream,     ///< triangles of a strip - 1, for all strips of a cluster but the last
  kReferenceStream,  ///< folded: vertex - the vertex of the reference before it in the cluster (0 at first)
  kTwinStream,       ///< folded: vertex in the page - that of the twin before it in the page (0 at first)
  kFieldStreams,     ///< folded errors of the prediction, one stream a field; positions as u, v, sheared axis
};
constexpr std::uint32_t kMaxStreams = kFieldStreams + kMaxFields;

enum Table : std::uint32_t {
  kTripleTable,
  kStartTable,
  kLengthTable,
  kReferenceTable,
  kTwinTable,
  kPositionTable,  ///< of the two axes that are not sheared
  kShearTable,     ///< of the sheared axis
  kNormalTable,
  kColorTable,
  kUvTables,  ///< one a set
};
constexpr std::uint32_t kMaxTables = kUvTables + kMaxUvSets;

[[nodiscard]] constexpr std::uint32_t symbol_count(std::uint32_t table) {
  return table == kTripleTable ? kTripleSymbols : table == kStartTable ? kStartSymbols : kValueSymbols;
}

/// Position fields stand in streams by their part in the shear: first the two others in the order x y z, then the
/// sheared.
[[nodiscard]] constexpr std::array<std::uint32_t, 3> axes_by_role(std::uint32_t shear_axis) {
  return {shear_axis == 0 ? 1U : 0U, shear_axis == 2 ? 1U : 2U, shear_axis};
}

/// Of the field stream at kFieldStreams + field.
[[nodiscard]] constexpr std::uint32_t table_of_field(const MeshRecord& mesh, std::uint32_t field) {
  if (field < 3) return field < 2 ? kPositionTable : kShearTable;
  const std::uint32_t first_uv = mesh.normal_mode == NormalMode::kStored ? 5U : 3U;
  if (field < first_uv) return kNormalTable;
  const std::uint32_t set = (field - first_uv) / 2;
  return set < mesh.uv_set_count ? kUvTables + set : kColorTable;
}

/// The first streams' tables have the streams' numbers.
[[nodiscard]] constexpr std::uint32_t table_of_stream(const MeshRecord& mesh, std::uint32_t stream) {
  return stream < kFieldStreams ? stream : table_of_field(mesh, stream - kFieldStreams);
}

/// Words of a cluster's data that are not its stream, by what they are: each kind has its own columns.
enum RangeWord : std::uint32_t {
  kMaterialWord,
  kUvWord0,
  kUvWord1,
  kUvWord2,
  kFitWord0,
  kFitWord1,
  kColorWord0,
  kColorWord1,
  kRangeWordKinds
};

/// Whether words of the kind are stored as differences to the one before, folded.
[[nodiscard]] constexpr bool is_delta(RangeWord kind) {
  return kind == kUvWord1 || kind == kUvWord2;
}

/// Head words 1 to 3 hold 24 bits of a coordinate, which is stored as the folded difference to the cluster before.
constexpr std::uint32_t kCoordinateMask = 0xFFFFFFU;
[[nodiscard]] constexpr std::uint32_t fold_coordinate(std::uint32_t difference) {
  return fold(static_cast<std::uint32_t>(static_cast<std::int32_t>(difference << 8U) >> 8)) & kCoordinateMask;
}
[[nodiscard]] constexpr std::uint32_t unfold_coordinate(std::uint32_t folded) {
  return unfold(folded) & kCoordinateMask;
}

/// The three vertices that predict a new one, and kNobody: a vertex in the middle of every field's range.
constexpr std::uint32_t kNobody = 256;
struct Gate {
  std::uint16_t a, b, c;
  std::uint16_t kind;  ///< SlotKind
};

/// Positions, UVs and colours continue the parallelogram; normals do so by half, because their noise adds up.
[[nodiscard]] constexpr std::uint32_t predict_parallelogram(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return a + b - c;
}
[[nodiscard]] constexpr std::uint32_t predict_half(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(3U * (a + b) - 2U * c) >> 2);
}

}  // namespace meshlode::format
