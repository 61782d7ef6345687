// SPDX-License-Identifier: MIT
#include "decode/decode.h"

#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "decode/octahedral.h"

namespace meshlode {

namespace {

static_assert(std::endian::native == std::endian::little, "pages are read as they lie in memory");

template <class T>
T load(std::span<const std::uint8_t> bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// A 32-bit load holds any value of at most 25 bits; it may reach into the triangles behind the stream, never beyond.
std::uint32_t read_bits(std::span<const std::uint8_t> bytes, std::size_t stream, std::size_t bit, std::uint32_t count) {
  const auto word = load<std::uint32_t>(bytes, stream + bit / 8);
  return word >> bit % 8 & ((1U << count) - 1U);
}

}  // namespace

std::array<std::int32_t, 3> decode_octahedral_point(std::int32_t a, std::int32_t b, std::uint32_t bits) {
  const std::int32_t m = (1 << (bits - 1)) - 1;
  const std::int32_t u = a - m;
  const std::int32_t v = b - m;
  const std::int32_t z = m - std::abs(u) - std::abs(v);
  if (z >= 0) return {u, v, z};
  return {u < 0 ? std::abs(v) - m : m - std::abs(v), v < 0 ? std::abs(u) - m : m - std::abs(u), z};
}

Vec3f decode_octahedral(std::int32_t a, std::int32_t b, std::uint32_t bits) {
  const auto point = decode_octahedral_point(a, b, bits);
  const double x = point[0];
  const double y = point[1];
  const double z = point[2];
  const double length = std::sqrt(x * x + y * y + z * z);  // the sum of squares is an integer: exact
  return {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
}

void decode_cluster(const Asset& asset, const PageBytes& page, ClusterId cluster, DecodedCluster& out) {
  const std::span<const std::uint8_t> bytes = page.bytes();
  const auto page_header = load<format::PageHeader>(bytes, 0);
  (void)asset;
  assert(cluster.value >= page_header.first_cluster &&
         cluster.value - page_header.first_cluster < page_header.cluster_count);
  const std::size_t index = cluster.value - page_header.first_cluster;
  const auto at = load<std::uint32_t>(bytes, sizeof(format::PageHeader) + index * sizeof(std::uint32_t));
  const auto header = load<format::PageCluster>(bytes, at);
  out.vertex_count = header.vertex_count;
  out.triangle_count = header.triangle_count;
  out.channel_count = header.channel_count;

  out.channels.resize(std::size_t{header.vertex_count} * header.channel_count);
  std::size_t bit = 0;
  const std::size_t channels_at = at + sizeof(format::PageCluster);
  std::array<format::Channel, 3 + 2 + 2 * format::kMaxUvSets + 4> channels;
  for (std::size_t c = 0; c < header.channel_count; ++c) {
    channels[c] = load<format::Channel>(bytes, channels_at + c * sizeof(format::Channel));
  }
  std::int32_t* value = out.channels.data();
  for (std::size_t i = 0; i < header.vertex_count; ++i) {
    for (std::size_t c = 0; c < header.channel_count; ++c) {
      const auto offset = read_bits(bytes, header.vertex_offset, bit, channels[c].bits);
      *value++ = channels[c].minimum + static_cast<std::int32_t>(offset);
      bit += channels[c].bits;
    }
  }

  out.triangles.resize(header.triangle_count);
  std::memcpy(out.triangles.data(), bytes.data() + header.triangle_offset, std::size_t{3} * header.triangle_count);
  out.triangle_material.clear();
  const std::size_t ranges_at = channels_at + header.channel_count * sizeof(format::Channel);
  for (std::size_t r = 0; r < header.material_range_count; ++r) {
    const auto range = load<format::MaterialRange>(bytes, ranges_at + r * sizeof(format::MaterialRange));
    out.triangle_material.insert(out.triangle_material.end(), range.triangle_count, range.material);
  }
}

void decode_attributes(const format::MeshRecord& mesh, const DecodedCluster& cluster, ClusterAttributes& out) {
  const std::size_t count = cluster.vertex_count;
  const bool has_normal = mesh.normal_mode == format::NormalMode::kStored;
  out.positions.resize(count);
  out.normals.resize(has_normal ? count : 0);
  for (std::uint32_t set = 0; set < format::kMaxUvSets; ++set) out.uvs[set].resize(set < mesh.uv_set_count ? count : 0);
  out.colors.resize(mesh.has_color != 0U ? count : 0);

  // mantissa · q has at most 49 bits and the power of two is exact, so this product of doubles is exact; the one
  // rounding is to float, and it too is exact while |mantissa · q| < 2^24.
  const double step = std::ldexp(1.0, mesh.grid.log2) * mesh.grid.mantissa;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t* value = &cluster.channels[i * cluster.channel_count];
    for (int axis = 0; axis < 3; ++axis) out.positions[i][axis] = static_cast<float>(step * *value++);
    if (has_normal) {
      out.normals[i] = decode_octahedral(value[0], value[1], mesh.normal_bits);
      value += 2;
    }
    for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
      const double uv_step = std::ldexp(1.0, mesh.uv_grid[set].log2);
      out.uvs[set][i] = {static_cast<float>(uv_step * value[0]), static_cast<float>(uv_step * value[1])};
      value += 2;
    }
    if (mesh.has_color != 0U) {
      for (int k = 0; k < 4; ++k) out.colors[i][k] = static_cast<float>(value[k]) / 255.0F;
    }
  }
}

Result<std::vector<DecodedCluster>> decode_all(const Asset& asset) {
  std::vector<DecodedCluster> clusters(asset.clusters().size());
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    const auto page = load_page(asset, PageId{p});
    if (!page) return page.error();
    const format::PageRecord& record = asset.pages()[p];
    for (std::uint32_t i = 0; i < record.cluster_count; ++i) {
      const ClusterId id{record.first_cluster + i};
      decode_cluster(asset, *page, id, clusters[id.value]);
    }
  }
  return clusters;
}

}  // namespace meshlode
