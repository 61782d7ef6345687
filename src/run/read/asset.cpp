// SPDX-License-Identifier: MIT
#include "run/read/asset.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/byte_size.h"
#include "base/try.h"
#include "format/section_columns.h"
#include "run/read/check_tables.h"
#include "run/read/file_place.h"
#include "run/read/sections.h"

namespace meshlode::run {

namespace {

template <class T>
std::span<const T> view_table(std::span<const std::uint8_t> bytes) {
  // Aligned: sections start at multiples of 16 of bytes that are aligned to 8, which no record exceeds, and decoded
  // ones at the start of a vector.
  static_assert(alignof(T) <= 8);
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

std::string_view view_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Result<Asset> Asset::open(const std::filesystem::path& path, std::uint64_t max_decoded) {
  TRY_LET(file, MappedFile::open(path));
  Asset asset;
  asset.max_decoded_ = max_decoded;
  asset.bytes_ = file->bytes();
  asset.owned_->storage = std::move(*file);
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
  TRY(asset.index());
  return asset;
}

Result<Asset> Asset::from_vector(std::vector<std::uint8_t> bytes) {
  Asset asset;
  asset.bytes_ = bytes;
  asset.owned_->storage = std::move(bytes);  // moving a vector keeps its buffer, so the view stays valid
  TRY(asset.index());
  return asset;
}

Result<Asset> Asset::from_head(std::span<const std::uint8_t> bytes, std::uint64_t file_bytes) {
  Asset asset;
  asset.bytes_ = bytes;
  TRY(asset.index_head(file_bytes));
  return asset;
}

Result<Asset> Asset::from_head(std::vector<std::uint8_t> bytes, std::uint64_t file_bytes) {
  Asset asset;
  asset.bytes_ = bytes;
  asset.owned_->storage = std::move(bytes);
  TRY(asset.index_head(file_bytes));
  return asset;
}

Status Asset::index_head(std::uint64_t file_bytes) {
  TRY_LET(head, find_head(bytes_, file_bytes));
  if (bytes_.size() < head->bytes) {
    return Error{
        ErrorCode::kInvalid, "head",
        "has " + std::to_string(bytes_.size()) + " bytes, at least " + std::to_string(head->bytes) + " are needed"};
  }
  bytes_ = bytes_.first(head->bytes);
  has_body_ = false;
  return index(file_bytes);
}

std::optional<FileId> Asset::file_id() const {
  const auto* file = std::get_if<MappedFile>(&owned_->storage);
  return file != nullptr ? std::optional(file->id()) : std::nullopt;
}

std::span<const std::uint8_t> Asset::blob_bytes(const format::BlobRecord& blob) const {
  return has_body_ ? bytes_.subspan(blob.offset, blob.bytes) : std::span<const std::uint8_t>();
}

std::span<const std::uint8_t> Asset::stored_page(PageId page) const {
  const format::PageRecord& record = pages_[page.value];
  return has_body_ ? bytes_.subspan(record.offset, record.stored_bytes) : std::span<const std::uint8_t>();
}

std::span<const std::uint8_t> Asset::section_bytes(const format::SectionEntry& entry) const {
  if (entry.bytes == 0) return {};               // at the offset of the section behind it
  if (entry.offset >= bytes_.size()) return {};  // pages and images, which a head is without
  const auto decoded = owned_->decoded.find(entry.offset);
  return decoded != owned_->decoded.end() ? std::span<const std::uint8_t>(decoded->second)
                                          : bytes_.subspan(entry.offset, entry.bytes);
}

Status Asset::index(std::uint64_t file_bytes) {
  TRY_LET(sections, index_sections(bytes_, file_bytes));
  using enum format::SectionId;
  // Of a processor of 32 bits no vector is larger, whatever the caller allows.
  std::uint64_t left = std::min<std::uint64_t>(max_decoded_bytes(), std::numeric_limits<std::size_t>::max());
  for (const auto& [id, entry] : sections->known) {
    if (entry->codec == static_cast<std::uint32_t>(format::SectionCodec::kPlain)) continue;
    const auto stored = bytes_.subspan(entry->offset, entry->bytes);
    if (!format::is_section_sound(stored, entry->record_bytes, entry->decoded_bytes)) {
      return Error{ErrorCode::kInvalid, "section " + section_tag(entry->id) + ", field codec",
                   "the stored bytes do not decode"};
    }
    if (entry->decoded_bytes > left) {
      return Error{ErrorCode::kUnsupported, "section " + section_tag(entry->id),
                   byte_size_text(entry->decoded_bytes) + " decoded, " + byte_size_text(left) + " of " +
                       byte_size_text(max_decoded_bytes()) + " are left: the larger of --max-decoded and " +
                       std::to_string(kJustifiedRatio) + " times the file"};
    }
    left -= entry->decoded_bytes;
    std::vector<std::uint8_t> decoded(entry->decoded_bytes);
    if (!format::decode_section(bytes_.subspan(entry->offset, entry->bytes), entry->record_bytes, decoded)) {
      return Error{ErrorCode::kInvalid, "section " + section_tag(entry->id) + ", field codec",
                   "the stored bytes do not decode"};
    }
    owned_->decoded.emplace(entry->offset, std::move(decoded));
  }
  const auto bytes_of = [&](format::SectionId id) { return section_bytes(sections->entry(id)); };
  RawTables tables;
  tables.version = sections->header->version;
  tables.meshes = view_table<format::MeshRecord>(bytes_of(kMeshes));
  tables.materials = view_table<format::MaterialRecord>(bytes_of(kMaterials));
  tables.instances = view_table<format::InstanceRecord>(bytes_of(kInstances));
  tables.groups = view_table<format::GroupRecord>(bytes_of(kGroups));
  tables.clusters = view_table<format::ClusterRecord>(bytes_of(kClusters));
  tables.nodes = view_table<format::NodeRecord>(bytes_of(kNodes));
  tables.pages = view_table<format::PageRecord>(bytes_of(kPages));
  tables.page_dependencies = view_table<std::uint32_t>(bytes_of(kPageDeps));
  tables.blobs = view_table<format::BlobRecord>(bytes_of(kBlobs));
  const format::SectionEntry* const promises = sections->find(kPromises);
  const format::SectionEntry* const promise_errors = sections->find(kPromiseErrors);
  tables.has_promises = promises != nullptr || promise_errors != nullptr;
  if (promises != nullptr) tables.promises = view_table<format::PromiseMeshRecord>(section_bytes(*promises));
  if (promise_errors != nullptr) {
    tables.promise_errors = view_table<format::PromiseGroupRecord>(section_bytes(*promise_errors));
  }
  const format::SectionEntry* const page_hints = sections->find(kPageHints);
  tables.has_page_hints = page_hints != nullptr;
  if (page_hints != nullptr) tables.page_hints = view_table<format::PageHintRecord>(section_bytes(*page_hints));
  tables.string_bytes = sections->entry(kStrings).decoded_bytes;
  tables.page_data = &sections->entry(kPageData);
  tables.blob_data = &sections->entry(kBlobData);

  using Check = Status (*)(const RawTables&);
  for (const Check check : {Check{check_meshes}, Check{check_materials}, Check{check_instances}, Check{check_blobs},
                            Check{check_groups}, Check{check_clusters}, Check{check_nodes}, Check{check_pages},
                            Check{check_promises}, Check{check_page_hints}}) {
    if (Status status = check(tables); !status) return status;
  }

  if (const std::uint64_t names = count_name_bytes(tables); names > max_decoded_bytes()) {
    return Error{ErrorCode::kUnsupported, "section STRS",
                 "names that share bytes take " + byte_size_text(names) + ", at most " +
                     byte_size_text(max_decoded_bytes()) + " are read"};
  }

  header_ = sections->header;
  sections_ = sections->entries;
  meshes_ = tables.meshes;
  materials_ = tables.materials;
  instances_ = tables.instances;
  groups_ = tables.groups;
  clusters_ = tables.clusters;
  nodes_ = tables.nodes;
  stored_ = {meshes_, groups_, nodes_};
  pages_ = tables.pages;
  page_dependencies_ = tables.page_dependencies;
  blobs_ = tables.blobs;
  promises_ = tables.promises;
  promise_errors_ = tables.promise_errors;
  page_hints_ = tables.page_hints;
  meta_ = view_text(bytes_of(kMeta));
  scene_ = view_text(bytes_of(kScene));
  strings_ = view_text(bytes_of(kStrings));
  return Ok{};
}

}  // namespace meshlode::run
