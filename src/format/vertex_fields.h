// SPDX-License-Identifier: MIT
// The raw fields of a vertex as they lie in a decoded page, its full integers, and the way between them: what one
// cluster says of a shared vertex in the terms of another cluster.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/page.h>

namespace meshlode::format {

/// Raw fields in the order of the stream: x y z · a b · u v of each set · r g b a.
constexpr std::uint32_t kMaxFields = 3 + 2 + 2 * kMaxUvSets + 4;
using RawVertex = std::array<std::uint32_t, kMaxFields>;
/// Full integers: x y z · X Y Z · u v of each set · r g b a. Equal exactly where the vertices are.
constexpr std::uint32_t kMaxIntegers = kMaxFields + 1;
using FullVertex = std::array<std::uint32_t, kMaxIntegers>;

[[nodiscard]] constexpr std::uint32_t field_count(const MeshRecord& mesh) {
  return 3U + (mesh.normal_mode == NormalMode::kStored ? 2U : 0U) + 2U * mesh.uv_set_count + 4U * mesh.has_color;
}

/// A UV range, unpacked.
struct UvRangeFields {
  std::uint32_t first_vertex = 0, end_vertex = 0, first_bit = 0;
  std::uint32_t bits[2] = {}, minimum[2] = {}, shift[2] = {};
  std::int32_t slope[2][3] = {};
};

/// Everything that turns a cluster's bits into integers.
struct ClusterFields {
  ClusterLayout layout;
  std::uint32_t first_range[kMaxUvSets] = {};  ///< of each UV set, into the page's ranges
  std::uint32_t color_bits[4] = {}, color_minimum[4] = {};
};

/// Appends the cluster's UV ranges to `ranges`. \pre fields.layout was read without complaint from this page
void read_cluster_fields(const MeshRecord& mesh, const std::uint32_t* page, ClusterFields& fields,
                         std::vector<UvRangeFields>& ranges);

/// One mesh's page at work: what all conversions need.
struct FieldContext {
  const MeshRecord& mesh;
  const std::uint32_t* page;
  const std::vector<UvRangeFields>& ranges;
};

/// Bits of the first vertex' fields; 0 beyond field_count.
[[nodiscard]] RawVertex first_field_bits(const FieldContext& context, const ClusterFields& cluster);

/// These three write field_count fields, one more where they are full, and leave the rest of `out` alone.
void read_raw_vertex(const FieldContext& context, const ClusterFields& cluster, std::uint32_t vertex, RawVertex& out);

void full_from_raw(const FieldContext& context, const ClusterFields& cluster, std::uint32_t vertex,
                   const RawVertex& raw, FullVertex& out);

/// The raw fields that say `full` at `vertex` of the cluster. Where a field is too narrow for it the value does not fit
/// its bits; a reader cuts it off, a writer compares and stores the vertex in another way.
void raw_from_full(const FieldContext& context, const ClusterFields& cluster, std::uint32_t vertex,
                   const FullVertex& full, RawVertex& out);

}  // namespace meshlode::format
