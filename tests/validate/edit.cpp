// SPDX-License-Identifier: GPL-3.0-or-later
#include "validate/edit.h"

#include <optional>

#include "support/reseal.h"
#include "validate/file_tables.h"
#include "validate/page_rules.h"

namespace meshlode::test {

std::uint64_t AssetEdit::section_entry_offset(format::SectionId id) const {
  const auto header = get<format::FileHeader>(0);
  for (std::uint32_t i = 0; i < header.section_count; ++i) {
    const std::uint64_t at = header.section_table_offset + std::uint64_t{i} * sizeof(format::SectionEntry);
    if (get<format::SectionEntry>(at).id == static_cast<std::uint32_t>(id)) return at;
  }
  return 0;
}

format::SectionEntry AssetEdit::section(format::SectionId id) const {
  return get<format::SectionEntry>(section_entry_offset(id));
}

std::uint64_t AssetEdit::page_offset_of_cluster(std::uint64_t cluster) const {
  for (const format::PageRecord& page : pages()) {
    if (cluster >= page.first_cluster && cluster - page.first_cluster < page.cluster_count) return page.offset;
  }
  return 0;
}

std::uint64_t AssetEdit::page_cluster_offset(std::uint64_t cluster) const {
  const std::uint64_t page = page_offset_of_cluster(cluster);
  const auto head = get<format::PageHeader>(page);
  return page + get<std::uint32_t>(page + sizeof head + 4 * (cluster - head.first_cluster));
}

std::uint64_t AssetEdit::channel_offset(std::uint64_t cluster, std::uint64_t k) const {
  return page_cluster_offset(cluster) + sizeof(format::PageCluster) + k * sizeof(format::Channel);
}

std::uint64_t AssetEdit::range_offset(std::uint64_t cluster, std::uint64_t k) const {
  const auto head = get<format::PageCluster>(page_cluster_offset(cluster));
  return channel_offset(cluster, head.channel_count) + k * sizeof(format::MaterialRange);
}

std::uint64_t AssetEdit::vertex_stream_offset(std::uint64_t cluster) const {
  return page_offset_of_cluster(cluster) + get<format::PageCluster>(page_cluster_offset(cluster)).vertex_offset;
}

std::uint64_t AssetEdit::triangle_stream_offset(std::uint64_t cluster) const {
  return page_offset_of_cluster(cluster) + get<format::PageCluster>(page_cluster_offset(cluster)).triangle_offset;
}

AssetEdit::BitPlace AssetEdit::bit_place(std::uint64_t cluster, std::uint64_t vertex, std::uint64_t k) const {
  const auto head = get<format::PageCluster>(page_cluster_offset(cluster));
  std::uint64_t bit = vertex_stream_offset(cluster) * 8 + vertex * head.vertex_bits;
  for (std::uint64_t c = 0; c < k; ++c) bit += get<format::Channel>(channel_offset(cluster, c)).bits;
  return {bit, get<format::Channel>(channel_offset(cluster, k)).bits};
}

std::uint32_t AssetEdit::vertex_bits(std::uint64_t cluster, std::uint64_t vertex, std::uint64_t k) const {
  const BitPlace at = bit_place(cluster, vertex, k);
  std::uint32_t value = 0;
  for (std::uint32_t i = 0; i < at.count; ++i) {
    const std::uint64_t bit = at.first_bit + i;
    value |= (bytes_[bit / 8] >> (bit % 8) & 1U) << i;
  }
  return value;
}

void AssetEdit::put_vertex_bits(std::uint64_t cluster, std::uint64_t vertex, std::uint64_t k, std::uint32_t value) {
  const BitPlace at = bit_place(cluster, vertex, k);
  for (std::uint32_t i = 0; i < at.count; ++i) {
    const std::uint64_t bit = at.first_bit + i;
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    bytes_[bit / 8] =
        static_cast<std::uint8_t>((value >> i & 1U) != 0 ? bytes_[bit / 8] | mask : bytes_[bit / 8] & ~mask);
  }
}

void AssetEdit::seal() {
  reseal(bytes_);
  RuleLog log;
  const std::optional<FileTables> file = read_tables(bytes_, log);
  if (!file || !check_tables(*file, log) || !check_page_table(*file, log)) return;
  const LoadedPages loaded = load_pages(*file, nullptr, log);
  if (!loaded.is_complete || log.count_of("L114") > 0) return;
  std::vector<std::span<const std::uint8_t>> pages;
  for (const PageBytes& page : loaded.pages) pages.push_back(page.bytes());
  const Hash128 hash = content_hash_of(*file, pages);
  std::memcpy(bytes_.data() + offsetof(format::FileHeader, content_hash), hash.data(), hash.size());
  reseal(bytes_);
}

}  // namespace meshlode::test
