// SPDX-License-Identifier: GPL-3.0-or-later
#include "out/report/byte_map.h"

#include <algorithm>

#include <meshlode/page.h>

#include "run/unpack/unpack.h"

namespace meshlode::out {

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
    const auto page = run::load_page(asset, PageId(p));
    if (!page) return page.error();
    map.stored_page_bytes += record.stored_bytes;
    const format::MeshRecord& mesh = asset.meshes()[asset.groups()[record.first_group].mesh];
    for (std::uint32_t i = 0; i < record.cluster_count; ++i) {
      format::ClusterLayout layout;
      if (format::read_cluster_layout(mesh, page->words(), i, layout) != nullptr) continue;  // load_page has checked it
      PageBits bits = bits_of(mesh, layout);
      if (i == 0) bits.heads += 32U * 3U;  // the page's header and its last word
      const std::size_t level = asset.clusters()[record.first_cluster + i].level;
      if (map.levels.size() <= level) map.levels.resize(level + 1);
      map.levels[level] += bits;
      map.total += bits;
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
      case SectionId::kPageDeps: map.table_bytes += section.bytes; break;
      default: break;
    }
  }
  return map;
}

}  // namespace meshlode::out
