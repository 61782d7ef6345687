// SPDX-License-Identifier: MIT
#include "unpack/stored_page.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <vector>

#include <meshlode/page.h>

#include "coding/stored_page.h"
#include "unpack/page_columns.h"
#include "unpack/strip_values.h"
#include "unpack/unpack_strips.h"

namespace meshlode {

namespace {

static_assert(std::endian::native == std::endian::little, "stored pages are read as they lie in memory");

/// Side information is at most what its columns can hold: code lengths, and every word of the page by its four bytes.
constexpr std::uint32_t kMaxSideBytes = format::kMaxPageBytes + kMaxTables * 256 + 4 * kRangeWordKinds;

class StoredPage {
 public:
  StoredPage(const format::MeshRecord& mesh, const format::PageRecord& record, std::span<const std::uint8_t> stored,
             std::span<std::uint32_t> page)
      : mesh_(mesh), record_(record), stored_(stored), page_(page), columns_(mesh, record.cluster_count, page) {}

  UnpackOutcome run() {
    if (stored_.size() < sizeof(header_) || page_.size() < 3) return UnpackOutcome::kBroken;
    std::memcpy(&header_, stored_.data(), sizeof(header_));
    stored_ = stored_.subspan(sizeof(header_));
    if (header_.side_stored > stored_.size() || header_.side_bytes > kMaxSideBytes) return UnpackOutcome::kBroken;
    side_.resize(header_.side_bytes);
    const auto side = stored_.first(header_.side_stored);
    stored_ = stored_.subspan(header_.side_stored);
    if (const UnpackOutcome outcome = unpack_side(side); outcome != UnpackOutcome::kOk) return outcome;

    page_[0] = record_.first_cluster;
    page_[1] = record_.cluster_count;
    const auto method = static_cast<PageMethod>(header_.method);
    if (method == PageMethod::kColumns) return unpack_columns() ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
    if (method == PageMethod::kStrips) return unpack_strip_page() ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
    return UnpackOutcome::kBroken;
  }

 private:
  UnpackOutcome unpack_side(std::span<const std::uint8_t> side) {
    switch (record_.codec) {
      case format::Codec::kLz4: return unpack_lz4(side, side_);
      case format::Codec::kZstd: return unpack_zstd(side, side_);
      case format::Codec::kDraco: return unpack_draco_bytes(side, side_);
      case format::Codec::kNone: break;
    }
    return UnpackOutcome::kNotBuiltIn;
  }

  bool unpack_columns() {
    ColumnReader reader(side_);
    if (header_.twin_count != 0 || !columns_.read(reader)) return false;
    std::uint32_t word = columns_.first_data_word();
    for (std::uint32_t c = 0; c < record_.cluster_count; ++c) {
      format::ClusterLayout layout;
      if (!columns_.place_cluster(c, word)) return false;
      if (format::read_cluster_layout(mesh_, page_, c, layout) != nullptr || layout.stream_word != word) return false;
      const std::size_t bytes = std::size_t{layout.end_word - word} * sizeof(std::uint32_t);
      if (bytes > stored_.size()) return false;
      if (bytes > 0) std::memcpy(&page_[word], stored_.data(), bytes);
      stored_ = stored_.subspan(bytes);
      word = layout.end_word;
    }
    return stored_.empty() && word + 1 == page_.size();
  }

  bool unpack_strip_page() {
    std::span<const std::uint8_t> side = side_;
    std::span<const std::uint8_t> code_lengths;
    if (record_.codec == format::Codec::kZstd) {
      if (side.size() < code_length_bytes(mesh_)) return false;
      code_lengths = side.first(code_length_bytes(mesh_));
      side = side.subspan(code_lengths.size());
    }
    ColumnReader reader(side);
    StreamBytes streams;
    StreamCounts counts;
    if (!columns_.read(reader) || !read_stream_sizes(streams) || !count_numbers(counts)) return false;
    StripValues values;
    const bool is_ok = record_.codec == format::Codec::kZstd
                           ? read_prefix_streams(mesh_, code_lengths, streams, counts, values)
                           : record_.codec == format::Codec::kDraco && read_draco_streams(mesh_, streams, counts, values);
    return is_ok && unpack_strips(mesh_, record_.cluster_count, columns_, values, page_);
  }

  bool read_stream_sizes(StreamBytes& streams) {
    const std::size_t stream_count = kFieldStreams + field_count(mesh_);
    const std::size_t table_bytes = stream_count * sizeof(std::uint32_t);
    if (stored_.size() < table_bytes) return false;
    std::memcpy(streams.size.data(), stored_.data(), table_bytes);
    streams.bytes = stored_.subspan(table_bytes);
    std::uint64_t sum = 0;
    for (const std::uint32_t size : streams.size) sum += size;
    return sum == streams.bytes.size();
  }

  /// The heads know how many numbers each stream holds.
  bool count_numbers(StreamCounts& counts) const {
    std::uint32_t vertices = 0;
    for (std::uint32_t c = 0; c < record_.cluster_count; ++c) {
      const std::uint32_t strips = columns_.strip_count(c);
      const std::uint32_t triangles = columns_.triangle_count(c);
      const std::uint32_t slots = triangles + 2 * strips;
      if (strips > triangles || slots < columns_.vertex_count(c)) return false;
      counts.count[kTripleStream] += (triangles - strips + 2) / 3;
      counts.count[kStartStream] += strips;
      counts.count[kLengthStream] += strips - 1;
      counts.count[kReferenceStream] += slots - columns_.vertex_count(c);
      vertices += columns_.vertex_count(c);
    }
    if (header_.twin_count > vertices) return false;
    counts.count[kTwinStream] = header_.twin_count;
    for (std::uint32_t f = 0; f < field_count(mesh_); ++f) {
      counts.count[kFieldStreams + f] = vertices - header_.twin_count;
    }
    return true;
  }

  const format::MeshRecord& mesh_;
  const format::PageRecord& record_;
  std::span<const std::uint8_t> stored_;
  std::span<std::uint32_t> page_;
  PageColumns columns_;
  StoredHeader header_{};
  std::vector<std::uint8_t> side_;
};

}  // namespace

UnpackOutcome unpack_page(const format::MeshRecord& mesh, const format::PageRecord& record,
                          std::span<const std::uint8_t> stored, std::span<std::uint32_t> page) {
  return StoredPage(mesh, record, stored, page).run();
}

}  // namespace meshlode
