// SPDX-License-Identifier: MIT
#include "run/unpack/unpack_page.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <vector>

#include <meshlode/page.h>

#include "format/page_streams.h"
#include "run/unpack/page_columns.h"
#include "run/unpack/page_plan.h"
#include "run/unpack/side_columns.h"
#include "run/unpack/strip_values.h"
#include "run/unpack/unpack_strips.h"

namespace meshlode::run {

namespace {

static_assert(std::endian::native == std::endian::little, "stored pages are read as they lie in memory");

/// Side information is at most what its columns can hold: code lengths, and every word of the page by its four bytes.
constexpr std::uint32_t kMaxSideBytes = format::kMaxPageBytes + format::kMaxTables * 256 + 4 * format::kRangeWordKinds;

class StoredPage {
 public:
  StoredPage(const format::MeshRecord& mesh, const format::PageRecord& record, std::span<const std::uint8_t> stored,
             std::span<std::uint32_t> page)
      : mesh_(mesh), record_(record), stored_(stored), page_(page), columns_(mesh, record.cluster_count, page) {}

  UnpackOutcome run() {
    if (stored_.size() < sizeof(header_) || page_.size() < 3) return UnpackOutcome::kBroken;
    std::memcpy(&header_, stored_.data(), sizeof(header_));
    stored_ = stored_.subspan(sizeof(header_));
    if (record_.codec == format::Codec::kNone ||
        header_.method != static_cast<std::uint32_t>(format::method_of(record_.codec)) ||
        header_.side_stored > stored_.size() || header_.side_bytes > kMaxSideBytes) {
      return UnpackOutcome::kBroken;
    }
    side_.resize(header_.side_bytes);
    const auto side = stored_.first(header_.side_stored);
    stored_ = stored_.subspan(header_.side_stored);
    if (const UnpackOutcome outcome = unpack_side(side); outcome != UnpackOutcome::kOk) return outcome;

    page_[0] = record_.first_cluster;
    page_[1] = record_.cluster_count;
    const bool is_ok =
        format::method_of(record_.codec) == format::PageMethod::kColumns ? unpack_columns() : unpack_strip_page();
    return is_ok ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
  }

 private:
  UnpackOutcome unpack_side(std::span<const std::uint8_t> side) {
    switch (record_.codec) {
      case format::Codec::kLz4: return unpack_lz4(side, side_);
      case format::Codec::kZstd: return unpack_zstd(side, side_);
      case format::Codec::kStrips:
        return unpack_side_columns(mesh_, record_.cluster_count, side, side_) ? UnpackOutcome::kOk
                                                                              : UnpackOutcome::kBroken;
      case format::Codec::kDraco: return unpack_draco_side(side);
      case format::Codec::kNone: break;
    }
    return UnpackOutcome::kBroken;
  }

  UnpackOutcome unpack_draco_side(std::span<const std::uint8_t> side) {
    std::vector<std::uint32_t> numbers(side_.size());
    const UnpackOutcome outcome = unpack_draco(side, numbers);
    for (std::size_t i = 0; i < side_.size(); ++i) side_[i] = static_cast<std::uint8_t>(numbers[i] & 0xFFU);
    return outcome;
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
    if (record_.codec == format::Codec::kStrips) {
      if (side.size() < code_length_bytes(mesh_)) return false;
      code_lengths = side.first(code_length_bytes(mesh_));
      side = side.subspan(code_lengths.size());
    }
    ColumnReader reader(side);
    StreamBytes streams;
    StreamCounts counts;
    PagePlan plan;
    if (!columns_.read(reader) || !plan_page(mesh_, record_.cluster_count, columns_, page_, plan)) return false;
    if (!read_stream_sizes(streams) || !count_numbers(plan, counts)) return false;
    const bool is_narrow = plan.max_bits <= kMaxNarrowBits && plan.max_normal_bits <= kMaxNarrowNormalBits;
    return is_narrow ? unpack_lanes<NarrowLanes>(code_lengths, streams, counts, plan)
                     : unpack_lanes<WideLanes>(code_lengths, streams, counts, plan);
  }

  template <class L>
  bool unpack_lanes(std::span<const std::uint8_t> code_lengths, const StreamBytes& streams, const StreamCounts& counts,
                    const PagePlan& plan) {
    StripValues<L> values;
    const bool is_ok = record_.codec == format::Codec::kStrips
                           ? read_prefix_streams(mesh_, code_lengths, streams, counts, values)
                           : read_draco_streams(streams, counts, values);
    return is_ok && unpack_strips(mesh_, plan, values, page_);
  }

  template <class L>
  bool read_draco_streams(const StreamBytes& streams, const StreamCounts& counts, StripValues<L>& out) const {
    const std::uint32_t fields = format::field_count(mesh_);
    for (std::uint32_t q = 0; q < quad_count<L>(mesh_); ++q)
      out.errors[q].resize(counts.count[format::kFieldStreams], kErrorsBehind);
    std::span<const std::uint8_t> rest = streams.bytes;
    UnfilledArray<std::uint32_t> numbers;
    for (std::uint32_t s = 0; s < format::kFieldStreams + fields; ++s) {
      const auto stored = rest.first(streams.size[s]);
      rest = rest.subspan(streams.size[s]);
      UnfilledArray<std::uint32_t>& target = s < format::kFieldStreams ? out.streams[s] : numbers;
      target.resize(counts.count[s]);
      if (unpack_draco(stored, target.all()) != UnpackOutcome::kOk) return false;
      if (is_folded(s)) {
        for (std::uint32_t& number : target.all()) number = format::unfold(number);
      }
      if (s < format::kFieldStreams) continue;
      const std::uint32_t slot = slot_of(s - format::kFieldStreams);
      Quad<L>* const errors = out.errors[slot / L::kLanes].data();
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        errors[i].lane[slot % L::kLanes] = static_cast<typename L::Word>(numbers.data()[i]);
      }
    }
    return true;
  }

  bool read_stream_sizes(StreamBytes& streams) {
    const std::size_t stream_count = format::kFieldStreams + format::field_count(mesh_);
    const std::size_t table_bytes = stream_count * sizeof(std::uint32_t);
    if (stored_.size() < table_bytes) return false;
    std::memcpy(streams.size.data(), stored_.data(), table_bytes);
    streams.bytes = stored_.subspan(table_bytes);
    std::uint64_t sum = 0;
    for (const std::uint32_t size : streams.size) sum += size;
    return sum == streams.bytes.size();
  }

  /// The heads know how many numbers each stream holds.
  bool count_numbers(const PagePlan& plan, StreamCounts& counts) const {
    for (const format::ClusterFields& cluster : plan.clusters) {
      const format::ClusterLayout& layout = cluster.layout;
      counts.count[format::kTripleStream] += (layout.triangle_count - layout.strip_count + 2) / 3;
      counts.count[format::kStartStream] += layout.strip_count;
      counts.count[format::kLengthStream] += layout.strip_count - 1;
      counts.count[format::kReferenceStream] += layout.reference_count;
    }
    const std::uint32_t vertices = plan.first_vertex.back();
    if (header_.twin_count > vertices) return false;
    counts.count[format::kTwinStream] = header_.twin_count;
    for (std::uint32_t f = 0; f < format::field_count(mesh_); ++f) {
      counts.count[format::kFieldStreams + f] = vertices - header_.twin_count;
    }
    return true;
  }

  const format::MeshRecord& mesh_;
  const format::PageRecord& record_;
  std::span<const std::uint8_t> stored_;
  std::span<std::uint32_t> page_;
  PageColumns columns_;
  format::StoredHeader header_{};
  std::vector<std::uint8_t> side_;
};

}  // namespace

UnpackOutcome unpack_page(const format::MeshRecord& mesh, const format::PageRecord& record,
                          std::span<const std::uint8_t> stored, std::span<std::uint32_t> page) {
  return StoredPage(mesh, record, stored, page).run();
}

}  // namespace meshlode::run
