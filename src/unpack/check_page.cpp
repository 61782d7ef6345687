// SPDX-License-Identifier: MIT
#include "unpack/check_page.h"

#include <algorithm>
#include <bitset>
#include <cstring>
#include <string>

namespace meshlode {

namespace {

constexpr std::int64_t kMaxChannelMinimum = (std::int64_t{1} << 24) - 1;  ///< with 25 bits above it: never overflows
constexpr std::uint32_t kMaxChannelBits = 25;  ///< a 32-bit load at any byte holds the value, whatever its first bit

template <class T>
T load(std::span<const std::uint8_t> bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

std::uint64_t align4(std::uint64_t bytes) { return (bytes + 3U) & ~std::uint64_t{3}; }

bool is_zero(std::span<const std::uint8_t> bytes, std::uint64_t first, std::uint64_t end) {
  const auto range = bytes.subspan(first, end - first);
  return std::all_of(range.begin(), range.end(), [](std::uint8_t byte) { return byte == 0; });
}

class PageChecker {
 public:
  PageChecker(const Asset& asset, PageId page, std::span<const std::uint8_t> bytes)
      : asset_(asset), record_(asset.pages()[page.value]), page_(page), bytes_(bytes) {}

  Status run() {
    const auto header = load<format::PageHeader>(bytes_, 0);
    if (header.first_cluster != record_.first_cluster) return fail("first_cluster", "does not match the page table");
    if (header.cluster_count != record_.cluster_count) return fail("cluster_count", "does not match the page table");
    // check_pages made sure that the offsets lie inside.
    std::uint64_t at = sizeof(format::PageHeader) + std::uint64_t{record_.cluster_count} * sizeof(std::uint32_t);
    for (cluster_ = 0; cluster_ < record_.cluster_count; ++cluster_) {
      const auto offset = load<std::uint32_t>(bytes_, sizeof(format::PageHeader) + cluster_ * sizeof(std::uint32_t));
      if (offset != at) return fail("offset", "does not follow the cluster before it");
      if (Status status = check_cluster(at); !status) return status;
    }
    if (at != bytes_.size()) return fail("offset", "bytes are left over behind the last cluster");
    return Ok{};
  }

 private:
  [[nodiscard]] Error fail(const char* field, const char* detail) const {
    std::string where = "page " + std::to_string(page_.value);
    if (cluster_ < record_.cluster_count) where += ", cluster " + std::to_string(record_.first_cluster + cluster_);
    return {ErrorCode::kInvalid, where + ", field " + field, detail};
  }

  /// Checks the cluster that starts at `at` and moves `at` behind it.
  Status check_cluster(std::uint64_t& at) {
    if (bytes_.size() - at < sizeof(format::PageCluster)) return fail("offset", "reaches beyond the page");
    const auto header = load<format::PageCluster>(bytes_, at);
    const format::ClusterRecord& cluster = asset_.clusters()[record_.first_cluster + cluster_];
    const format::MeshRecord& mesh = asset_.meshes()[asset_.groups()[cluster.coarser_group].mesh];
    if (header.vertex_count != cluster.vertex_count) return fail("vertex_count", "does not match the cluster's record");
    if (header.triangle_count != cluster.triangle_count) {
      return fail("triangle_count", "does not match the cluster's record");
    }
    if (header.channel_count != mesh.channel_count) return fail("channel_count", "does not match the mesh");
    if (header.material_range_count < 1 || header.material_range_count > header.triangle_count) {
      return fail("material_range_count", "must be 1 to triangle_count");
    }
    const std::uint64_t channels_at = at + sizeof(format::PageCluster);
    const std::uint64_t ranges_at = channels_at + header.channel_count * sizeof(format::Channel);
    const std::uint64_t vertices_at = ranges_at + header.material_range_count * sizeof(format::MaterialRange);
    if (vertices_at > bytes_.size()) return fail("channel_count", "the cluster's header reaches beyond the page");
    if (Status status = check_channels(header, mesh, channels_at); !status) return status;
    if (Status status = check_ranges(header, ranges_at); !status) return status;

    const std::uint64_t vertex_bits = std::uint64_t{header.vertex_count} * header.vertex_bits;
    const std::uint64_t triangles_at = vertices_at + align4((vertex_bits + 7U) / 8U);
    const std::uint64_t triangles_end = triangles_at + 3U * header.triangle_count;
    if (header.vertex_offset != vertices_at) return fail("vertex_offset", "does not follow the material ranges");
    if (header.triangle_offset != triangles_at) return fail("triangle_offset", "does not follow the vertices");
    if (align4(triangles_end) > bytes_.size()) return fail("triangle_offset", "the triangles reach beyond the page");
    const std::uint64_t vertices_end = vertices_at + (vertex_bits + 7U) / 8U;
    if (!is_zero(bytes_, vertices_end, triangles_at) || !is_zero(bytes_, triangles_end, align4(triangles_end)) ||
        (vertex_bits % 8U != 0 && bytes_[vertices_end - 1] >> vertex_bits % 8U != 0)) {
      return fail("vertex_offset", "padding is not zero");
    }
    if (Status status = check_triangles(header, triangles_at); !status) return status;
    at = align4(triangles_end);
    return Ok{};
  }

  Status check_channels(const format::PageCluster& header, const format::MeshRecord& mesh, std::uint64_t at) {
    std::uint32_t total = 0;
    for (std::uint32_t c = 0; c < header.channel_count; ++c) {
      const auto channel = load<format::Channel>(bytes_, at + c * sizeof(format::Channel));
      if (channel.bits > kMaxChannelBits) return fail("bits", "must be 0 to 25");
      const bool may_be_negative = c < 3 || is_uv(c, mesh);
      if (channel.minimum > kMaxChannelMinimum || channel.minimum < (may_be_negative ? -kMaxChannelMinimum : 0)) {
        return fail("minimum", "is out of range");
      }
      total += channel.bits;
    }
    if (total != header.vertex_bits) return fail("vertex_bits", "is not the sum over the channels");
    return Ok{};
  }

  static bool is_uv(std::uint32_t channel, const format::MeshRecord& mesh) {
    const std::uint32_t first = mesh.normal_mode == format::NormalMode::kStored ? 5U : 3U;
    return channel >= first && channel < first + 2U * mesh.uv_set_count;
  }

  Status check_ranges(const format::PageCluster& header, std::uint64_t at) {
    std::uint64_t covered = 0;
    std::uint32_t previous = 0;
    for (std::uint32_t r = 0; r < header.material_range_count; ++r) {
      const auto range = load<format::MaterialRange>(bytes_, at + r * sizeof(format::MaterialRange));
      if (range.material >= asset_.materials().size()) return fail("material", "is out of range");
      if (r > 0 && range.material <= previous) return fail("material", "must be larger than the one before it");
      if (range.triangle_count < 1) return fail("triangle_count", "of a material range must be at least 1");
      covered += range.triangle_count;
      previous = range.material;
    }
    if (covered != header.triangle_count) return fail("material_range_count", "the ranges do not cover the triangles");
    return Ok{};
  }

  Status check_triangles(const format::PageCluster& header, std::uint64_t at) {
    std::bitset<format::kMaxClusterVertices> used;
    for (std::uint64_t i = at; i < at + 3U * header.triangle_count; ++i) {
      if (bytes_[i] >= header.vertex_count) return fail("triangles", "a vertex index is out of range");
      used.set(bytes_[i]);
    }
    if (used.count() != header.vertex_count) return fail("triangles", "a vertex belongs to no triangle");
    return Ok{};
  }

  const Asset& asset_;
  const format::PageRecord& record_;
  PageId page_;
  std::span<const std::uint8_t> bytes_;
  std::uint32_t cluster_ = format::kNone;  ///< in the page; kNone while the page's own header is checked
};

}  // namespace

Status check_page(const Asset& asset, PageId page, std::span<const std::uint8_t> bytes) {
  return PageChecker(asset, page, bytes).run();
}

}  // namespace meshlode
