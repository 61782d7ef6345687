// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/byte_map.h"

#include <algorithm>
#include <numeric>

#include <meshlode/page.h>

#include "base/try.h"
#include "run/unpack/unpack.h"

namespace meshlode::app {

namespace {

PageBits bits_of(const format::MeshRecord& mesh, const format::ClusterLayout& at) {
  PageBits bits;
  const std::uint32_t first_uv = mesh.uv_set_count > 0 ? at.uv_word[0] : at.color_word;
  bits.heads = 32U * format::head_words(mesh);
  bits.materials = 32U * (first_uv - at.material_word);
  bits.uvs = 32U * (at.color_word - first_uv);
  bits.colors = 32U * (at.stream_word - at.color_word);
  bits.positions = at.normal_bit - at.position_bit;
  const std::uint32_t uv_bit = mesh.uv_set_count > 0 ? at.uv_bit[0] : at.color_bit;
  bits.normals = uv_bit - at.normal_bit;
  bits.uvs += at.color_bit - uv_bit;
  bits.colors += at.turn_bit - at.color_bit;
  bits.topology = at.end_bit - at.turn_bit;
  bits.padding = 32U * at.end_word - at.end_bit;
  return bits;
}

/// 0 where the parts share bytes, as names and blobs of a file may.
std::uint64_t beside(std::uint64_t whole, std::uint64_t parts) {
  return whole > parts ? whole - parts : 0;
}

/// What is left of the file beside what its parts are made of.
void map_rest(const run::Asset& asset, ByteMap& map) {
  using format::SectionId;
  std::uint64_t in_sections = 0, in_blobs = 0;
  for (const format::BlobRecord& blob : asset.blobs()) in_blobs += blob.bytes;
  map.head_bytes = sizeof(format::FileHeader) + asset.sections().size_bytes();
  for (const format::SectionEntry& section : asset.sections()) {
    in_sections += section.bytes;
    const auto id = static_cast<SectionId>(section.id);
    if (id == SectionId::kPageData) map.page_alignment_bytes = beside(section.bytes, map.stored_page_bytes);
    if (id == SectionId::kBlobData) map.blob_alignment_bytes = beside(section.bytes, in_blobs);
  }
  map.alignment_bytes = beside(asset.bytes().size(), map.head_bytes + in_sections);
}

}  // namespace

PageBits& PageBits::operator+=(const PageBits& other) {
  heads += other.heads;
  materials += other.materials;
  positions += other.positions;
  normals += other.normals;
  uvs += other.uvs;
  colors += other.colors;
  topology += other.topology;
  padding += other.padding;
  return *this;
}

Result<ByteMap> map_bytes(const run::Asset& asset) {
  ByteMap map;
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    const format::PageRecord& record = asset.pages()[p];
    TRY_LET(page, run::load_page(asset, PageId(p)));
    map.stored_page_bytes += record.stored_bytes;
    const format::MeshRecord& mesh = asset.meshes()[asset.groups()[record.first_group].mesh];
    std::vector<std::uint64_t> page_bits;  // by level
    for (std::uint32_t i = 0; i < record.cluster_count; ++i) {
      format::ClusterLayout layout;
      if (format::read_cluster_layout(mesh, page->words(), i, layout) != nullptr) continue;  // load_page has checked it
      PageBits bits = bits_of(mesh, layout);
      if (i == 0) bits.heads += 32U * 3U;  // the page's header and its last word
      const std::size_t level = asset.clusters()[record.first_cluster + i].level;
      if (map.levels.size() <= level) map.levels.resize(level + 1);
      map.levels[level] += bits;
      map.total += bits;
      if (page_bits.size() <= level) page_bits.resize(level + 1);
      page_bits[level] += bits.total();
    }
    if (map.stored_by_level.size() < page_bits.size()) map.stored_by_level.resize(page_bits.size());
    const auto all = static_cast<double>(std::accumulate(page_bits.begin(), page_bits.end(), std::uint64_t{0}));
    for (std::size_t level = 0; level < page_bits.size(); ++level) {
      map.stored_by_level[level] +=
          static_cast<double>(record.stored_bytes) * (static_cast<double>(page_bits[level]) / all);
    }
  }
  for (const format::SectionEntry& section : asset.sections()) {
    using format::SectionId;
    switch (static_cast<SectionId>(section.id)) {
      case SectionId::kMeshes:
      case SectionId::kGroups:
      case SectionId::kClusters:
      case SectionId::kNodes:
      case SectionId::kPages:
      case SectionId::kPageDeps:
      case SectionId::kPromises:
      case SectionId::kPromiseErrors:
      case SectionId::kPageHints: map.table_bytes += section.bytes; break;
      default: break;
    }
  }
  map_rest(asset, map);
  return map;
}

}  // namespace meshlode::app
