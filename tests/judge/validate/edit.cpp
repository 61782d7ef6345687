// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/edit.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "app/rewrite/rewrite_asset.h"
#include "judge/validate/file_tables.h"
#include "judge/validate/page_rules.h"
#include "judge/validate/rules.h"
#include "support/reseal.h"

namespace meshlode::test {

AssetEdit::AssetEdit(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)) {
  const auto asset = run::Asset::from_bytes(bytes_);
  if (!asset) return;
  const bool is_packed = std::any_of(asset->sections().begin(), asset->sections().end(),
                                     [](const format::SectionEntry& entry) { return entry.codec != 0; }) ||
                         std::any_of(asset->pages().begin(), asset->pages().end(),
                                     [](const format::PageRecord& page) { return page.codec != format::Codec::kNone; });
  if (!is_packed) return;
  auto plain = app::rewrite_asset(*asset, {format::Codec::kNone, std::string(asset->meta_json())});
  if (plain) bytes_ = std::move(*plain);
}

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

const format::MeshRecord AssetEdit::mesh_of(std::uint64_t cluster) const {
  for (const format::MeshRecord& mesh : meshes()) {
    if (cluster >= mesh.first_cluster && cluster - mesh.first_cluster < mesh.cluster_count) return mesh;
  }
  return {};
}

std::vector<std::uint32_t> AssetEdit::page_words(std::uint64_t cluster) const {
  for (const format::PageRecord& page : pages()) {
    if (cluster < page.first_cluster || cluster - page.first_cluster >= page.cluster_count) continue;
    std::vector<std::uint32_t> words(page.bytes / 4);
    std::memcpy(words.data(), bytes_.data() + page.offset, 4 * words.size());
    return words;
  }
  return {};
}

format::ClusterLayout AssetEdit::layout(std::uint64_t cluster) const {
  const auto words = page_words(cluster);
  format::ClusterLayout layout;
  (void)format::read_cluster_layout(mesh_of(cluster), words, static_cast<std::uint32_t>(cluster - words[0]), layout);
  return layout;
}

std::int32_t AssetEdit::field(std::uint64_t cluster, std::uint32_t word, format::BitField f) const {
  const auto words = page_words(cluster);
  return format::get_field(&words[word], f);
}

void AssetEdit::put_field(std::uint64_t cluster, std::uint32_t word, format::BitField f, std::int32_t value) {
  change_at<std::uint32_t>(page_offset_of_cluster(cluster) + 4U * (word + f.word), [&](std::uint32_t& w) {
    w &= ~(f.mask() << f.shift);
    w |= (static_cast<std::uint32_t>(value) & f.mask()) << f.shift;
  });
}

std::int32_t AssetEdit::head(std::uint64_t cluster, format::BitField f) const {
  return field(cluster, layout(cluster).head_word, f);
}

void AssetEdit::put_head(std::uint64_t cluster, format::BitField f, std::int32_t value) {
  put_field(cluster, layout(cluster).head_word, f, value);
}

std::uint32_t AssetEdit::page_bits(std::uint64_t cluster, std::uint32_t bit, std::uint32_t count) const {
  return count == 0 ? 0 : format::get_bits(page_words(cluster).data(), bit, count);
}

void AssetEdit::put_page_bits(std::uint64_t cluster, std::uint32_t bit, std::uint32_t count, std::uint32_t value) {
  const std::uint64_t page = page_offset_of_cluster(cluster);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint8_t& byte = bytes_[page + (bit + i) / 8];
    const auto mask = static_cast<std::uint8_t>(1U << (bit + i) % 8);
    byte = static_cast<std::uint8_t>((value >> i & 1U) != 0 ? byte | mask : byte & ~mask);
  }
}

std::uint32_t AssetEdit::stored_count(std::uint64_t cluster) const {
  const auto mesh = mesh_of(cluster);
  return 3U + (mesh.normal_mode == format::NormalMode::kStored ? 2U : 0U) + 2U * mesh.uv_set_count +
         4U * mesh.has_color;
}

AssetEdit::BitPlace AssetEdit::place_of(std::uint64_t cluster, std::uint32_t vertex, std::uint32_t k) const {
  const auto at = layout(cluster);
  const auto mesh = mesh_of(cluster);
  const auto in_row = [vertex](std::uint32_t first, std::span<const std::uint32_t> bits, std::uint32_t column) {
    std::uint32_t row = 0;
    std::uint32_t before = 0;
    for (std::uint32_t i = 0; i < bits.size(); ++i) {
      row += bits[i];
      if (i < column) before += bits[i];
    }
    return BitPlace{first + vertex * row + before, bits[column]};
  };
  if (k < 3) return in_row(at.position_bit, at.bits, k);
  k -= 3;
  if (mesh.normal_mode == format::NormalMode::kStored) {
    if (k < 2) return in_row(at.normal_bit, at.normal_bits, k);
    k -= 2;
  }
  if (k < 2 * mesh.uv_set_count) {
    std::uint32_t word = at.uv_word[k / 2];
    std::uint32_t first = at.uv_bit[k / 2];
    while (true) {
      const auto get = [&](format::BitField f) { return static_cast<std::uint32_t>(field(cluster, word, f)); };
      const std::uint32_t count = get(format::uv_range::kVerticesLess1) + 1U;
      const std::uint32_t bits[2] = {get(format::uv_range::kBitsU), get(format::uv_range::kBitsV)};
      if (vertex < count) return in_row(first, bits, k % 2);
      vertex -= count;
      first += count * (bits[0] + bits[1]);
      word += format::uv_range::kWords + (get(format::uv_range::kHasFit) != 0 ? format::uv_range::kFitWords : 0U);
    }
  }
  k -= 2 * mesh.uv_set_count;
  std::uint32_t bits[4];
  for (std::size_t i = 0; i < 4; ++i) {
    bits[i] = static_cast<std::uint32_t>(field(cluster, at.color_word, format::color_range::kBits[i]));
  }
  return in_row(at.color_bit, bits, k);
}

std::uint32_t AssetEdit::stored(std::uint64_t cluster, std::uint32_t vertex, std::uint32_t k) const {
  const BitPlace at = place_of(cluster, vertex, k);
  return page_bits(cluster, at.bit, at.count);
}

void AssetEdit::put_stored(std::uint64_t cluster, std::uint32_t vertex, std::uint32_t k, std::uint32_t value) {
  const BitPlace at = place_of(cluster, vertex, k);
  put_page_bits(cluster, at.bit, at.count, value);
}

std::pair<std::uint32_t, format::BitField> AssetEdit::minimum_field(std::uint64_t cluster, std::uint32_t k) const {
  const auto at = layout(cluster);
  const auto mesh = mesh_of(cluster);
  if (k < 3) return {at.head_word, format::head::kMinimum[k]};
  k -= 3;
  if (mesh.normal_mode == format::NormalMode::kStored) {
    if (k < 2) return {at.head_word, k == 0 ? format::head::kNormalMinimumA : format::head::kNormalMinimumB};
    k -= 2;
  }
  if (k < 2 * mesh.uv_set_count) {
    return {at.uv_word[k / 2], k % 2 == 0 ? format::uv_range::kMinimumU : format::uv_range::kMinimumV};
  }
  return {at.color_word, format::color_range::kMinimum[k - 2 * mesh.uv_set_count]};
}

std::int32_t AssetEdit::minimum(std::uint64_t cluster, std::uint32_t k) const {
  const auto [word, f] = minimum_field(cluster, k);
  return field(cluster, word, f);
}

void AssetEdit::move_minimum(std::uint64_t cluster, std::uint32_t k, std::int32_t by) {
  const auto [word, f] = minimum_field(cluster, k);
  put_field(cluster, word, f, field(cluster, word, f) + by);
}

void AssetEdit::seal() {
  reseal(bytes_);
  judge::RuleLog log;
  const std::optional<judge::FileTables> file = judge::read_tables(bytes_, log);
  if (!file || !judge::check_tables(*file, log) || !judge::check_page_table(*file, log)) return;
  const judge::LoadedPages loaded = judge::load_pages(*file, nullptr, log);
  if (!loaded.is_complete || log.count_of(judge::Rule::kL114) > 0) return;
  std::vector<std::span<const std::uint8_t>> pages;
  for (const run::PageBytes& page : loaded.pages) pages.push_back(page.bytes());
  const Hash128 hash = judge::content_hash_of(*file, pages);
  std::memcpy(bytes_.data() + offsetof(format::FileHeader, content_hash), hash.data(), hash.size());
  reseal(bytes_);
}

}  // namespace meshlode::test
