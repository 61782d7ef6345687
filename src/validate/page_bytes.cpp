// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of pages (L203 … L212, L214), parsed by the judge's own lines and not by `decode`.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "mesh/grid.h"
#include "validate/page_rules.h"

namespace meshlode {

namespace {

using format::Channel;
using format::MaterialRange;
using format::PageCluster;

template <class Record>
Record read_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  Record record;
  std::memcpy(&record, bytes.data() + offset, sizeof record);
  return record;
}

/// `count` bits at `bit`, at most 25, without reading beyond the stream's bytes.
std::uint32_t read_bits(std::span<const std::uint8_t> stream, std::uint64_t bit, std::uint32_t count) {
  std::uint64_t window = 0;
  const std::uint64_t first = bit / 8;
  for (std::uint64_t i = 0; i < 5 && first + i < stream.size(); ++i)
    window |= std::uint64_t{stream[first + i]} << (8 * i);
  return static_cast<std::uint32_t>(window >> (bit % 8) & ((std::uint64_t{1} << count) - 1));
}

struct ChannelLimits {
  std::int64_t lowest, highest;
};

/// What the channels of a mesh may hold, in channel order.
std::vector<ChannelLimits> channel_limits(const format::MeshRecord& mesh) {
  std::vector<ChannelLimits> limits(3, {-kMaxGridCoordinate, kMaxGridCoordinate});
  if (mesh.normal_mode == format::NormalMode::kStored) {
    limits.insert(limits.end(), 2, {0, (std::int64_t{1} << mesh.normal_bits) - 2});
  }
  constexpr std::int64_t kMaxUv = (1 << 24) - 1;  // a float holds every decoded coordinate exactly
  limits.insert(limits.end(), 2U * mesh.uv_set_count, {-kMaxUv, kMaxUv});
  if (mesh.has_color != 0) limits.insert(limits.end(), 4, {0, 255});
  return limits;
}

class ClusterBytesChecker {
 public:
  ClusterBytesChecker(const FileTables& file, std::size_t page, std::span<const std::uint8_t> bytes, RuleLog& log)
      : file_(file),
        page_(page),
        bytes_(bytes),
        log_(log),
        mesh_(file.meshes[file.groups[file.pages[page].first_group].mesh]),
        limits_(channel_limits(mesh_)) {}

  /// Checks the cluster that starts at `offset`; its end, or nothing where it is broken.
  std::optional<std::size_t> run(std::size_t cluster, std::size_t offset) {
    cluster_ = cluster;
    if (!parse(offset)) return std::nullopt;
    check_triangles();
    check_vertices();
    check_materials();
    return sound_ ? std::optional(end_) : std::nullopt;
  }

 private:
  [[nodiscard]] std::string at() const { return place("page", page_, "cluster", cluster_); }

  template <class Detail>
  bool expect(bool holds, std::string_view rule, const Detail& detail) {
    log_.expect(
        holds, rule, [&] { return at(); }, detail);
    return holds;
  }

  bool parse(std::size_t offset) {
    sound_ = true;
    const format::ClusterRecord& record = file_.clusters[cluster_];
    if (!expect(offset <= bytes_.size() && sizeof(PageCluster) <= bytes_.size() - offset, "L205",
                [] { return std::string("starts outside the page"); })) {
      return false;
    }
    head_ = read_at<PageCluster>(bytes_, offset);
    sound_ &=
        expect(head_.vertex_count == record.vertex_count && head_.triangle_count == record.triangle_count, "L206", [&] {
          return differs("vertices", std::uint64_t{head_.vertex_count}, "record", std::uint64_t{record.vertex_count}) +
                 "; " +
                 differs("triangles", std::uint64_t{head_.triangle_count}, "record",
                         std::uint64_t{record.triangle_count});
        });
    sound_ &= expect(head_.channel_count == mesh_.channel_count, "L206", [&] {
      return differs("channels", std::uint64_t{head_.channel_count}, "mesh", std::uint64_t{mesh_.channel_count});
    });
    if (!sound_) return false;
    std::size_t cursor = offset + sizeof(PageCluster);
    const std::size_t tables =
        head_.channel_count * sizeof(Channel) + head_.material_range_count * sizeof(MaterialRange);
    if (!expect(tables <= bytes_.size() - cursor, "L208",
                [] { return std::string("channels or ranges leave the page"); })) {
      return sound_ = false;
    }
    channels_.clear();
    ranges_.clear();
    std::uint64_t bits = 0;
    for (std::uint32_t i = 0; i < head_.channel_count; ++i, cursor += sizeof(Channel)) {
      channels_.push_back(read_at<Channel>(bytes_, cursor));
      sound_ &= expect(channels_.back().bits <= 25, "L207",
                       [&] { return "channel " + std::to_string(i) + " has more than 25 bits"; });
      bits += channels_.back().bits;
    }
    for (std::uint32_t i = 0; i < head_.material_range_count; ++i, cursor += sizeof(MaterialRange)) {
      ranges_.push_back(read_at<MaterialRange>(bytes_, cursor));
    }
    sound_ &= expect(head_.vertex_bits == bits, "L207", [&] {
      return differs("vertex_bits", std::uint64_t{head_.vertex_bits}, "sum of the channels", bits);
    });
    if (!sound_) return false;

    const std::uint64_t vertex_bytes = (bits * head_.vertex_count + 7) / 8;
    const std::uint64_t triangle_bytes = std::uint64_t{3} * head_.triangle_count;
    const auto stream_fits = [&](std::uint64_t from, std::uint64_t size) {
      return from % 4 == 0 && from >= cursor && from <= bytes_.size() && size <= bytes_.size() - from;
    };
    sound_ &= expect(stream_fits(head_.vertex_offset, vertex_bytes), "L208",
                     [] { return std::string("vertex stream is misplaced"); });
    if (!sound_) return false;
    expect_zero(cursor, head_.vertex_offset);
    cursor = head_.vertex_offset + vertex_bytes;
    sound_ &= expect(stream_fits(head_.triangle_offset, triangle_bytes), "L208",
                     [] { return std::string("triangle stream is misplaced"); });
    if (!sound_) return false;
    expect_zero(cursor, head_.triangle_offset);
    vertices_ = bytes_.subspan(head_.vertex_offset, vertex_bytes);
    triangles_ = bytes_.subspan(head_.triangle_offset, triangle_bytes);
    end_ = head_.triangle_offset + triangle_bytes;
    const std::uint64_t used = bits * head_.vertex_count;
    if (used % 8 != 0) {
      expect(vertices_.back() >> (used % 8) == 0, "L214",
             [] { return std::string("bits after the last vertex are not zero"); });
    }
    return true;
  }

  void expect_zero(std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      if (!expect(bytes_[i] == 0, "L214", [&] { return "padding at byte " + std::to_string(i) + " is not zero"; }))
        return;
    }
  }

  void check_triangles() {
    std::array<bool, 65536> used{};
    log_.check("L209");
    log_.check("L210");
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (triangles_[i] >= head_.vertex_count) {
        sound_ = expect(false, "L209", [&] {
          return "triangle " + std::to_string(i / 3) + " uses vertex " + std::to_string(triangles_[i]) + " of " +
                 std::to_string(head_.vertex_count);
        });
        return;
      }
      used[triangles_[i]] = true;
    }
    for (std::uint32_t v = 0; v < head_.vertex_count; ++v) {
      if (!expect(used[v], "L210", [&] { return "vertex " + std::to_string(v) + " is not used"; })) return;
    }
  }

  void check_vertices() {
    log_.check("L207");
    log_.check("L212");
    const std::size_t count = channels_.size();
    std::uint64_t channel_start = 0;
    for (std::size_t c = 0; c < count; ++c) {
      const Channel& channel = channels_[c];
      std::uint32_t lowest = 0xFFFFFFFFU;
      std::uint32_t highest = 0;
      for (std::uint32_t v = 0; v < head_.vertex_count; ++v) {
        const std::uint32_t value =
            read_bits(vertices_, std::uint64_t{v} * head_.vertex_bits + channel_start, channel.bits);
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
      }
      channel_start += channel.bits;
      expect(lowest == 0 && std::cmp_equal(std::bit_width(highest), channel.bits), "L207", [&] {
        return "channel " + std::to_string(c) + " stores " + std::to_string(lowest) + " … " + std::to_string(highest) +
               " in " + std::to_string(channel.bits) + " bits";
      });
      const std::int64_t smallest = std::int64_t{channel.minimum} + lowest;
      const std::int64_t largest = std::int64_t{channel.minimum} + highest;
      sound_ &= expect(smallest >= limits_[c].lowest && largest <= limits_[c].highest, "L212", [&] {
        return "channel " + std::to_string(c) + " holds " + std::to_string(smallest) + " … " + std::to_string(largest);
      });
    }
  }

  void check_materials() {
    std::uint64_t triangles = 0;
    log_.check("L211");
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      sound_ &= expect(ranges_[i].material < file_.materials.size(), "L211",
                       [&] { return "material " + std::to_string(ranges_[i].material) + " does not exist"; });
      expect(i == 0 || ranges_[i].material > ranges_[i - 1].material, "L211",
             [] { return std::string("materials are not ascending"); });
      expect(ranges_[i].triangle_count > 0, "L211", [] { return std::string("a range is empty"); });
      triangles += ranges_[i].triangle_count;
    }
    sound_ &= expect(triangles == head_.triangle_count, "L211", [&] {
      return differs("triangles in ranges", triangles, "triangles", std::uint64_t{head_.triangle_count});
    });
  }

  const FileTables& file_;
  std::size_t page_;
  std::span<const std::uint8_t> bytes_;
  RuleLog& log_;
  const format::MeshRecord& mesh_;
  std::vector<ChannelLimits> limits_;
  std::size_t cluster_ = 0;
  PageCluster head_{};
  std::vector<Channel> channels_;
  std::vector<MaterialRange> ranges_;
  std::span<const std::uint8_t> vertices_, triangles_;
  std::size_t end_ = 0;
  bool sound_ = true;
};

bool check_decoded_page(const FileTables& file, std::size_t p, std::span<const std::uint8_t> bytes, RuleLog& log) {
  const format::PageRecord& page = file.pages[p];
  const auto at = [&] { return place("page", p); };
  bool sound = true;
  const std::uint64_t head_bytes = sizeof(format::PageHeader) + std::uint64_t{4} * page.cluster_count;
  if (!log.expect(head_bytes <= bytes.size(), "L205", at,
                  [] { return std::string("is shorter than its header and offsets"); })) {
    return false;
  }
  const auto head = read_at<format::PageHeader>(bytes, 0);
  sound &= log.expect(head.first_cluster == page.first_cluster && head.cluster_count == page.cluster_count, "L205", at,
                      [] { return std::string("its header names other clusters"); });
  ClusterBytesChecker checker(file, p, bytes, log);
  std::uint64_t next = head_bytes;
  for (std::uint32_t k = 0; k < page.cluster_count; ++k) {
    const auto offset = read_at<std::uint32_t>(bytes, sizeof(format::PageHeader) + std::size_t{4} * k);
    if (!log.expect(offset % 4 == 0 && offset >= next && offset - next < 4, "L205", at, [&] {
          return "offset " + std::to_string(offset) + " of " + place("cluster", page.first_cluster + k) +
                 " should be " + std::to_string((next + 3) / 4 * 4);
        })) {
      return false;
    }
    for (std::uint64_t i = next; i < offset; ++i) {
      log.expect(bytes[i] == 0, "L214", at, [&] { return "padding at byte " + std::to_string(i) + " is not zero"; });
    }
    const std::optional<std::size_t> end = checker.run(page.first_cluster + k, offset);
    if (!end) return false;
    next = *end;
  }
  for (std::uint64_t i = next; i < bytes.size(); ++i) {
    if (!log.expect(bytes[i] == 0, "L214", at,
                    [&] { return "byte " + std::to_string(i) + " after the last cluster is not zero"; }))
      break;
  }
  return sound;
}

}  // namespace

LoadedPages load_pages(const FileTables& file, const Asset* asset, RuleLog& log) {
  LoadedPages loaded;
  loaded.pages.reserve(file.pages.size());
  log.check("L203");
  log.check("L204");
  for (std::size_t p = 0; p < file.pages.size(); ++p) {
    const format::PageRecord& page = file.pages[p];
    const auto at = [&] { return place("page", p); };
    const auto stored = file.bytes.subspan(page.offset, page.stored_bytes);
    loaded.pages.emplace_back(std::span<const std::uint8_t>{});
    log.expect(hash64(stored) == page.checksum, "L203", at,
               [] { return std::string("checksum of the stored bytes does not match"); });
    const bool is_plain = page.codec == format::Codec::kNone;
    // A page that does not shrink is stored plain.
    const bool sized = page.bytes <= format::kMaxPageBytes && page.bytes % 4 == 0 &&
                       (is_plain ? page.stored_bytes == page.bytes : page.stored_bytes < page.bytes);
    log.expect(sized, "L204", at, [&] {
      return differs("bytes", std::uint64_t{page.bytes}, "stored_bytes", std::uint64_t{page.stored_bytes});
    });
    if (sized && is_plain) {
      loaded.pages.back() = PageBytes(stored);
    } else if (sized && asset != nullptr) {
      Result<PageBytes> unpacked = load_page(*asset, PageId(static_cast<std::uint32_t>(p)));
      if (log.expect(unpacked.ok(), "L204", at, [&] { return unpacked.error().message(); })) {
        loaded.pages.back() = std::move(*unpacked);
      }
    }
    const auto bytes = loaded.pages.back().bytes();
    if (bytes.size() != page.bytes) {
      loaded.is_complete = false;
      continue;
    }
    log.expect(hash64(bytes) == page.decoded_checksum, "L203", at,
               [] { return std::string("checksum of the decoded bytes does not match"); });
  }
  return loaded;
}

bool check_page_bytes(const FileTables& file, const LoadedPages& loaded, RuleLog& log) {
  for (const char* rule : {"L205", "L206", "L207", "L208", "L209", "L210", "L211", "L212", "L214"}) log.check(rule);
  bool sound = loaded.is_complete;
  for (std::size_t p = 0; p < file.pages.size(); ++p) {
    const auto bytes = loaded.pages[p].bytes();
    if (!bytes.empty() || file.pages[p].bytes == 0) sound &= check_decoded_page(file, p, bytes, log);
  }
  return sound;
}

}  // namespace meshlode
