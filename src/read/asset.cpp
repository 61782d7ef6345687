// SPDX-License-Identifier: MIT
#include "read/asset.h"

#include <utility>

#include "read/check_tables.h"
#include "read/sections.h"

namespace meshlode {

namespace {

template <class T>
std::span<const T> view_table(std::span<const std::uint8_t> bytes, const SectionIndex& index, format::SectionId id) {
  const format::SectionEntry& entry = index.entry(id);
  // Aligned: sections start at multiples of 16 of bytes that are aligned to 8, which no record exceeds.
  static_assert(alignof(T) <= 8);
  return {reinterpret_cast<const T*>(bytes.data() + entry.offset), entry.record_count};
}

std::string_view view_text(std::span<const std::uint8_t> bytes, const SectionIndex& index, format::SectionId id) {
  const format::SectionEntry& entry = index.entry(id);
  return {reinterpret_cast<const char*>(bytes.data() + entry.offset), entry.bytes};
}

}  // namespace

Result<Asset> Asset::open(const std::filesystem::path& path) {
  auto file = MappedFile::open(path);
  if (!file) return file.error();
  Asset asset;
  asset.bytes_ = file->bytes();
  asset.storage_ = std::move(*file);
  if (Status status = asset.index(); !status) {
    Error error = status.error();
    error.where = error.where.empty() ? path.string() : path.string() + ": " + error.where;
    return error;
  }
  return asset;
}

Result<Asset> Asset::from_bytes(std::span<const std::uint8_t> bytes) {
  Asset asset;
  asset.bytes_ = bytes;
  if (Status status = asset.index(); !status) return status.error();
  return asset;
}

Result<Asset> Asset::from_vector(std::vector<std::uint8_t> bytes) {
  Asset asset;
  asset.bytes_ = bytes;
  asset.storage_ = std::move(bytes);  // moving a vector keeps its buffer, so the view stays valid
  if (Status status = asset.index(); !status) return status.error();
  return asset;
}

std::span<const std::uint8_t> Asset::blob_bytes(const format::BlobRecord& blob) const {
  return bytes_.subspan(blob.offset, blob.bytes);
}

std::span<const std::uint8_t> Asset::stored_page(PageId page) const {
  const format::PageRecord& record = pages_[page.value];
  return bytes_.subspan(record.offset, record.stored_bytes);
}

Status Asset::index() {
  const auto sections = index_sections(bytes_);
  if (!sections) return sections.error();
  using enum format::SectionId;
  RawTables tables;
  tables.meshes = view_table<format::MeshRecord>(bytes_, *sections, kMeshes);
  tables.materials = view_table<format::MaterialRecord>(bytes_, *sections, kMaterials);
  tables.instances = view_table<format::InstanceRecord>(bytes_, *sections, kInstances);
  tables.groups = view_table<format::GroupRecord>(bytes_, *sections, kGroups);
  tables.clusters = view_table<format::ClusterRecord>(bytes_, *sections, kClusters);
  tables.nodes = view_table<format::NodeRecord>(bytes_, *sections, kNodes);
  tables.pages = view_table<format::PageRecord>(bytes_, *sections, kPages);
  tables.page_dependencies = view_table<std::uint32_t>(bytes_, *sections, kPageDeps);
  tables.blobs = view_table<format::BlobRecord>(bytes_, *sections, kBlobs);
  tables.string_bytes = sections->entry(kStrings).bytes;
  tables.page_data = &sections->entry(kPageData);
  tables.blob_data = &sections->entry(kBlobData);

  using Check = Status (*)(const RawTables&);
  for (const Check check : {Check{check_meshes}, Check{check_materials}, Check{check_instances}, Check{check_blobs},
                            Check{check_groups}, Check{check_clusters}, Check{check_nodes}, Check{check_pages}}) {
    if (Status status = check(tables); !status) return status;
  }

  header_ = sections->header;
  sections_ = sections->entries;
  meshes_ = tables.meshes;
  materials_ = tables.materials;
  instances_ = tables.instances;
  groups_ = tables.groups;
  clusters_ = tables.clusters;
  nodes_ = tables.nodes;
  pages_ = tables.pages;
  page_dependencies_ = tables.page_dependencies;
  blobs_ = tables.blobs;
  meta_ = view_text(bytes_, *sections, kMeta);
  scene_ = view_text(bytes_, *sections, kScene);
  strings_ = view_text(bytes_, *sections, kStrings);
  return Ok{};
}

}  // namespace meshlode
