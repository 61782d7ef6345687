// SPDX-License-Identifier: GPL-3.0-or-later
// The layout of a file: header, section table, sections in the order of format::SectionId, each at a multiple of 16.
#include "build/write/write.h"

#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "base/hash.h"
#include "base/parallel.h"
#include "build/pack/pack.h"
#include "build/pack/pack_section.h"
#include "build/write/asset_tables.h"
#include "build/write/hash_content.h"
#include "format/section_columns.h"

namespace meshlode::build {

namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in memory");

std::uint64_t align_section(std::uint64_t offset) {
  return (offset + format::kSectionAlignment - 1) / format::kSectionAlignment * format::kSectionAlignment;
}

/// A section before it has a place: bytes that lie somewhere, or only a size (pages and blobs, copied on their own).
struct SectionPlan {
  format::SectionId id;
  std::uint64_t bytes = 0;
  const void* data = nullptr;
  std::uint32_t record_bytes = 0;
  std::uint64_t record_count = 0;
  std::vector<std::uint8_t> packed{};  ///< what is stored instead of `data`, where not empty
  [[nodiscard]] std::uint64_t stored_bytes() const { return packed.empty() ? bytes : packed.size(); }
};

template <class T>
SectionPlan table_section(format::SectionId id, const std::vector<T>& records) {
  return {id, records.size() * sizeof(T), records.data(), sizeof(T), records.size()};
}

SectionPlan text_section(format::SectionId id, const std::string& text) {
  return {id, text.size(), text.data(), 0, 0};
}

Result<std::vector<PackedPage>> pack_pages(const AssetTables& tables, format::Codec codec) {
  std::vector<PackedPage> packed(tables.page_bytes.size());
  std::vector<std::optional<Error>> errors(packed.size());
  parallel_for_each_index(packed.size(), 1, [&](std::size_t p) {
    const format::MeshRecord& mesh = tables.meshes[tables.groups[tables.pages[p].first_group].mesh];
    auto page = pack_page(mesh, tables.page_bytes[p], codec);
    if (page) {
      packed[p] = std::move(*page);
    } else {
      errors[p] = page.error();
    }
  });
  for (const auto& error : errors) {
    if (error) return *error;
  }
  return packed;
}

std::span<const std::uint8_t> stored_bytes(const AssetTables& tables, const std::vector<PackedPage>& packed,
                                           std::size_t page) {
  return packed[page].codec == format::Codec::kNone ? std::span<const std::uint8_t>(tables.page_bytes[page])
                                                    : std::span<const std::uint8_t>(packed[page].bytes);
}

/// Offsets within their section; write_asset adds where the section starts. Returns the section's size.
std::uint64_t place_pages(AssetTables& tables, const std::vector<PackedPage>& packed) {
  std::uint64_t end = 0;
  for (std::size_t p = 0; p < tables.pages.size(); ++p) {
    const auto bytes = stored_bytes(tables, packed, p);
    format::PageRecord& page = tables.pages[p];
    page.offset = align_section(end);
    page.stored_bytes = static_cast<std::uint32_t>(bytes.size());
    page.codec = packed[p].codec;
    page.checksum = packed[p].codec == format::Codec::kNone ? page.decoded_checksum : hash64(bytes);
    end = page.offset + bytes.size();
  }
  return end;
}

std::uint64_t place_blobs(AssetTables& tables) {
  std::uint64_t end = 0;
  for (format::BlobRecord& blob : tables.blobs) {
    blob.offset = align_section(end);
    end = blob.offset + blob.bytes;
  }
  return end;
}

void copy_bytes(std::vector<std::uint8_t>& file, std::uint64_t offset, const void* data, std::size_t bytes) {
  if (bytes > 0) std::memcpy(file.data() + offset, data, bytes);
}

using SectionPlans = std::array<SectionPlan, 14>;
using SectionEntries = std::array<format::SectionEntry, std::tuple_size_v<SectionPlans>>;

/// What the sections hold, as it lies in memory: all of it must outlive the plans.
SectionPlans plan_sections(const WriteInput& input, const AssetTables& tables, std::uint64_t page_data_bytes,
                           std::uint64_t blob_data_bytes) {
  using enum format::SectionId;
  return {
      text_section(kMeta, input.meta_json),
      text_section(kScene, input.scene->document),
      text_section(kStrings, tables.strings.bytes()),
      table_section(kMeshes, tables.meshes),
      table_section(kMaterials, tables.materials),
      table_section(kInstances, tables.instances),
      table_section(kGroups, tables.groups),
      table_section(kClusters, tables.clusters),
      table_section(kNodes, tables.nodes),
      table_section(kPages, tables.pages),
      table_section(kPageDeps, tables.page_dependencies),
      table_section(kBlobs, tables.blobs),
      SectionPlan{kPageData, page_data_bytes, nullptr, 0, 0},
      SectionPlan{kBlobData, blob_data_bytes, nullptr, 0, 0},
  };
}

/// The tables of places and checksums (pages, blobs) stay as they are: they hardly shrink, and are filled in later.
void pack_tables(SectionPlans& plans) {
  parallel_for_each_index(plans.size(), 1, [&](std::size_t s) {
    SectionPlan& plan = plans[s];
    if (plan.data == nullptr || plan.id == format::SectionId::kPages || plan.id == format::SectionId::kBlobs) return;
    plan.packed = pack_section({static_cast<const std::uint8_t*>(plan.data), plan.bytes}, plan.record_bytes);
  });
}

/// The sections one after the other behind the table of their entries; checksums are not set yet. Returns the file's
/// size.
std::uint64_t place_sections(const SectionPlans& plans, SectionEntries& entries) {
  std::uint64_t end = sizeof(format::FileHeader) + sizeof(entries);
  for (std::size_t s = 0; s < plans.size(); ++s) {
    const SectionPlan& plan = plans[s];
    format::SectionEntry& entry = entries[s];
    entry.id = static_cast<std::uint32_t>(plan.id);
    entry.offset = align_section(end);
    entry.codec =
        static_cast<std::uint32_t>(plan.packed.empty() ? format::SectionCodec::kPlain : format::SectionCodec::kColumns);
    entry.bytes = plan.stored_bytes();
    entry.decoded_bytes = plan.bytes;
    entry.flags = format::kSectionRequired;
    entry.record_bytes = plan.record_bytes;
    entry.record_count = static_cast<std::uint32_t>(plan.record_count);
    end = entry.offset + entry.bytes;
  }
  return end;
}

/// Offsets of pages and blobs, from within their section to within the file.
void move_to_sections(const SectionEntries& entries, AssetTables& tables) {
  for (const format::SectionEntry& entry : entries) {
    if (entry.id == static_cast<std::uint32_t>(format::SectionId::kPageData)) {
      for (format::PageRecord& page : tables.pages) page.offset += entry.offset;
    }
    if (entry.id == static_cast<std::uint32_t>(format::SectionId::kBlobData)) {
      for (format::BlobRecord& blob : tables.blobs) blob.offset += entry.offset;
    }
  }
}

void copy_sections(const SectionPlans& plans, const SectionEntries& entries, std::vector<std::uint8_t>& file) {
  for (std::size_t s = 0; s < plans.size(); ++s) {
    const SectionPlan& plan = plans[s];
    const void* data = plan.packed.empty() ? plan.data : plan.packed.data();
    copy_bytes(file, entries[s].offset, data, data == nullptr ? 0 : plan.stored_bytes());
  }
}

void copy_pages_and_blobs(const AssetTables& tables, const std::vector<PackedPage>& packed,
                          const std::vector<scene::SceneBlob>& blobs, std::vector<std::uint8_t>& file) {
  for (std::size_t p = 0; p < tables.pages.size(); ++p) {
    const auto bytes = stored_bytes(tables, packed, p);
    copy_bytes(file, tables.pages[p].offset, bytes.data(), bytes.size());
  }
  for (std::size_t b = 0; b < tables.blobs.size(); ++b) {
    copy_bytes(file, tables.blobs[b].offset, blobs[b].bytes.data(), blobs[b].bytes.size());
  }
}

/// Header and table of sections, with their checksums. \pre all sections are in their place
void seal(const Hash128& content_hash, SectionEntries& entries, std::vector<std::uint8_t>& file) {
  for (format::SectionEntry& entry : entries) {
    if (entry.id == static_cast<std::uint32_t>(format::SectionId::kPageData)) continue;  // its pages carry their own
    entry.checksum = hash64({file.data() + entry.offset, entry.bytes});
  }
  format::FileHeader header{};
  header.magic = format::kMagic;
  header.version = format::kVersion;
  header.header_bytes = sizeof(header);
  header.section_count = static_cast<std::uint32_t>(entries.size());
  header.file_bytes = file.size();
  header.section_table_offset = sizeof(header);
  std::memcpy(header.content_hash, content_hash.data(), content_hash.size());
  header.section_entry_bytes = sizeof(format::SectionEntry);
  copy_bytes(file, 0, &header, sizeof(header));
  copy_bytes(file, sizeof(header), entries.data(), sizeof(entries));
  header.header_checksum = hash64({file.data(), sizeof(header) + sizeof(entries)});
  copy_bytes(file, 0, &header, sizeof(header));
}

}  // namespace

Result<std::vector<std::uint8_t>> write_asset(WriteInput input) {
  auto made = make_tables(input);
  if (!made) return made.error();
  AssetTables tables = std::move(*made);
  const scene::Scene& scene = *input.scene;
  const Hash128 content_hash = hash_content(tables, scene);
  auto packed = pack_pages(tables, input.codec);
  if (!packed) return packed.error();
  const std::uint64_t page_data_bytes = place_pages(tables, *packed);
  const std::uint64_t blob_data_bytes = place_blobs(tables);

  SectionPlans plans = plan_sections(input, tables, page_data_bytes, blob_data_bytes);
  if (input.codec != format::Codec::kNone) pack_tables(plans);
  SectionEntries entries{};
  std::vector<std::uint8_t> file(place_sections(plans, entries));
  move_to_sections(entries, tables);
  copy_sections(plans, entries, file);
  copy_pages_and_blobs(tables, *packed, scene.blobs, file);
  seal(content_hash, entries, file);
  return file;
}

}  // namespace meshlode::build
