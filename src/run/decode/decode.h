// SPDX-License-Identifier: MIT
// Decode: one cluster of a loaded page as integers and as floats. Exact and deterministic (I9).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "run/unpack/unpack.h"

namespace meshlode::run {

/// Vertex i has channels[i * channel_count + c], the integers of format::MeshRecord in their order.
struct DecodedCluster {
  std::uint32_t vertex_count = 0, triangle_count = 0, channel_count = 0;
  std::vector<std::int32_t> channels;
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< local vertex indices
  std::vector<std::uint32_t> triangle_material;        ///< into Asset::materials()

  [[nodiscard]] Vec3i position(std::uint32_t i) const {
    const std::int32_t* c = &channels[std::size_t{i} * channel_count];
    return {c[0], c[1], c[2]};
  }
};

/// \pre `page` is the loaded page of the cluster's group. Reuses the vectors of `out`.
void decode_cluster(const Asset& asset, const PageBytes& page, ClusterId cluster, DecodedCluster& out);

/// The same without triangles and materials, for who reads them elsewhere: `out` has its counts and channels.
void decode_vertices(const Asset& asset, const PageBytes& page, ClusterId cluster, DecodedCluster& out);

/// Float attributes of one cluster, in mesh space (positions relative to MeshRecord::origin).
struct ClusterAttributes {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< unit; empty unless normal_mode == kStored
  std::array<std::vector<Vec2f>, format::kMaxUvSets> uvs;
  std::vector<Vec4f> colors;
};
void decode_attributes(const format::MeshRecord& mesh, const DecodedCluster& cluster, ClusterAttributes& out);

/// What pages and decode_all() take in memory, from the tables alone.
[[nodiscard]] std::uint64_t count_decoded_bytes(const Asset& asset);
/// The same for clusters alone, as often as they are named. \pre each is one of the asset's
[[nodiscard]] std::uint64_t count_decoded_bytes(const Asset& asset, std::span<const ClusterId> clusters);
/// Error: kUnsupported, in one line, where `bytes` are more than Asset::max_decoded_bytes().
[[nodiscard]] Status check_decoded_bytes(const Asset& asset, std::uint64_t bytes);

/// Loads and decodes every cluster of an asset, for tools and judges: clusters[i] is ClusterId(i). Errors: as
/// load_page(), and check_decoded_bytes() before any work.
[[nodiscard]] Result<std::vector<DecodedCluster>> decode_all(const Asset& asset);

}  // namespace meshlode::run
