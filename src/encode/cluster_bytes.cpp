// SPDX-License-Identifier: GPL-3.0-or-later
#include "encode/cluster_bytes.h"

#include <algorithm>
#include <bit>
#include <bitset>
#include <cassert>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

#include "encode/octahedral.h"
#include "encode/uv_grid.h"

namespace meshlode {

namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in memory");

constexpr std::uint32_t kMaxChannels = 3 + 2 + 2 * kMaxUvSets + 4;

Error limit_error(std::string detail) { return {ErrorCode::kBuildFailed, "", std::move(detail)}; }

template <class T>
void append(std::vector<std::uint8_t>& out, const T& record) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t at = out.size();
  out.resize(at + sizeof(T));
  std::memcpy(out.data() + at, &record, sizeof(T));
}

void pad_to_4(std::vector<std::uint8_t>& out) { out.resize((out.size() + 3U) & ~std::size_t{3}); }

std::int32_t quantize_color(float value) {
  if (!(value > 0.0F)) return 0;  // NaN too
  return static_cast<std::int32_t>(std::floor(std::min(double(value), 1.0) * 255.0 + 0.5));
}

/// The channel integers of one vertex, in the order of format::MeshRecord.
void quantize_vertex(const LodDag& dag, std::size_t vertex, const ChannelPlan& plan, std::int32_t* out) {
  const Vec3i& position = dag.vertex_position[vertex];
  *out++ = position.x;
  *out++ = position.y;
  *out++ = position.z;
  const float* attributes = dag.vertex_attributes.data() + vertex * plan.layout.stride();
  if (plan.layout.has_normal) {
    const auto normal = encode_octahedral({attributes[0], attributes[1], attributes[2]}, plan.normal_bits);
    *out++ = normal[0];
    *out++ = normal[1];
  }
  for (std::uint32_t set = 0; set < plan.layout.uv_set_count; ++set) {
    const float* uv = attributes + plan.layout.uv_offset() + 2U * set;
    *out++ = quantize_uv(uv[0], plan.uv_log2[set]);
    *out++ = quantize_uv(uv[1], plan.uv_log2[set]);
  }
  if (plan.layout.has_color) {
    for (std::uint32_t i = 0; i < 4; ++i) *out++ = quantize_color(attributes[plan.layout.color_offset() + i]);
  }
}

Status check_cluster(const LodDag& dag, const DagCluster& cluster) {
  if (cluster.vertex_count < 1 || cluster.vertex_count > format::kMaxClusterVertices) {
    return limit_error("has " + std::to_string(cluster.vertex_count) + " vertices, 1 to 256 are possible");
  }
  if (cluster.triangle_count < 1 || cluster.triangle_count > format::kMaxClusterTriangles) {
    return limit_error("has " + std::to_string(cluster.triangle_count) + " triangles, 1 to 256 are possible");
  }
  std::bitset<format::kMaxClusterVertices> used;
  for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count; ++t) {
    for (const std::uint8_t vertex : dag.triangles[t]) {
      if (vertex >= cluster.vertex_count) return limit_error("a triangle names a vertex that the cluster lacks");
      used.set(vertex);
    }
  }
  if (used.count() != cluster.vertex_count) return limit_error("a vertex belongs to no triangle");
  return Ok{};
}

Result<std::vector<format::MaterialRange>> material_ranges(const LodDag& dag, const DagCluster& cluster) {
  std::vector<format::MaterialRange> ranges;
  for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count; ++t) {
    const std::uint32_t material = dag.triangle_material[t];
    if (ranges.empty() || ranges.back().material != material) {
      if (!ranges.empty() && ranges.back().material > material) {
        return limit_error("triangles are not sorted by material");
      }
      ranges.push_back({material, 0});
    }
    ++ranges.back().triangle_count;
  }
  return ranges;
}

/// Bit k of the stream is bit k mod 8 of byte k / 8.
class BitWriter {
 public:
  explicit BitWriter(std::vector<std::uint8_t>& out) : out_(out) {}
  void put(std::uint32_t value, std::uint32_t bits) {
    pending_ |= std::uint64_t{value} << count_;
    for (count_ += bits; count_ >= 8; count_ -= 8) {
      out_.push_back(static_cast<std::uint8_t>(pending_ & 0xFFU));
      pending_ >>= 8U;
    }
  }
  void flush() {
    if (count_ > 0) out_.push_back(static_cast<std::uint8_t>(pending_ & 0xFFU));
    pending_ = 0;
    count_ = 0;
  }

 private:
  std::vector<std::uint8_t>& out_;
  std::uint64_t pending_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace

Status append_cluster(const LodDag& dag, const DagCluster& cluster, const ChannelPlan& plan,
                      std::vector<std::uint8_t>& out) {
  if (Status status = check_cluster(dag, cluster); !status) return status;
  const auto ranges = material_ranges(dag, cluster);
  if (!ranges) return ranges.error();

  const std::uint32_t channel_count = plan.channel_count;
  std::vector<std::int32_t> values(std::size_t{cluster.vertex_count} * channel_count);
  for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
    quantize_vertex(dag, cluster.first_vertex + i, plan, &values[i * channel_count]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::abs(std::int64_t{values[i * channel_count + axis]}) > kMaxGridCoordinate) {
        return limit_error("a position needs more than 24 bits");
      }
    }
  }

  std::array<format::Channel, kMaxChannels> channels{};
  std::uint32_t vertex_bits = 0;
  for (std::size_t c = 0; c < channel_count; ++c) {
    std::int32_t least = values[c];
    std::int32_t most = values[c];
    for (std::size_t i = c; i < values.size(); i += channel_count) {
      least = std::min(least, values[i]);
      most = std::max(most, values[i]);
    }
    channels[c] = {least, static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint32_t>(most - least)))};
    vertex_bits += channels[c].bits;
  }

  const std::size_t start = out.size();
  format::PageCluster header{};
  header.vertex_count = static_cast<std::uint16_t>(cluster.vertex_count);
  header.triangle_count = static_cast<std::uint16_t>(cluster.triangle_count);
  header.channel_count = static_cast<std::uint16_t>(channel_count);
  header.material_range_count = static_cast<std::uint16_t>(ranges->size());
  header.vertex_bits = vertex_bits;
  header.vertex_offset =
      static_cast<std::uint32_t>(sizeof(format::PageCluster) + channel_count * sizeof(format::Channel) +
                                 ranges->size() * sizeof(format::MaterialRange));
  header.triangle_offset = header.vertex_offset + align4((cluster.vertex_count * vertex_bits + 7U) / 8U);
  append(out, header);
  for (std::size_t c = 0; c < channel_count; ++c) append(out, channels[c]);
  for (const format::MaterialRange& range : *ranges) append(out, range);

  BitWriter bits(out);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const format::Channel& channel = channels[i % channel_count];
    bits.put(static_cast<std::uint32_t>(values[i] - channel.minimum), channel.bits);
  }
  bits.flush();
  pad_to_4(out);
  assert(out.size() - start == header.triangle_offset);
  (void)start;
  for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count; ++t) {
    out.insert(out.end(), dag.triangles[t].begin(), dag.triangles[t].end());
  }
  pad_to_4(out);
  return Ok{};
}

std::uint32_t max_cluster_bytes(const AttributeLayout& layout, const EncodeOptions& options, std::uint32_t vertex_count,
                                std::uint32_t triangle_count, std::uint32_t material_count) {
  const std::uint32_t channel_count =
      3U + (layout.has_normal ? 2U : 0U) + 2U * layout.uv_set_count + (layout.has_color ? 4U : 0U);
  const std::uint32_t vertex_bits = 3U * 24U + (layout.has_normal ? 2U * options.normal_bits : 0U) +
                                    2U * 25U * layout.uv_set_count + (layout.has_color ? 32U : 0U);
  return static_cast<std::uint32_t>(sizeof(std::uint32_t) + sizeof(format::PageCluster) +
                                    channel_count * sizeof(format::Channel) +
                                    material_count * sizeof(format::MaterialRange)) +
         align4((vertex_count * vertex_bits + 7U) / 8U) + align4(3U * triangle_count);
}

}  // namespace meshlode
