// SPDX-License-Identifier: GPL-3.0-or-later
// The layout of a file: header, section table, sections in the order of format::SectionId, each at a multiple of 16.
#include "builder/write/write.h"

#include <optional>

#include "base/hash.h"
#include "base/parallel.h"
#include "base/try.h"
#include "builder/pack/pack.h"
#include "builder/write/asset_tables.h"
#include "builder/write/file_layout.h"
#include "builder/write/hash_content.h"

namespace meshlode::builder {

namespace {

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
    place_page(packed[p].codec, stored_bytes(tables, packed, p), tables.pages[p], end);
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

using SectionPlans = std::vector<SectionPlan>;
using SectionEntries = std::vector<format::SectionEntry>;

/// What the sections hold, as it lies in memory: all of it must outlive the plans.
SectionPlans plan_sections(const WriteInput& input, const AssetTables& tables, std::uint64_t page_data_bytes,
                           std::uint64_t blob_data_bytes) {
  using enum format::SectionId;
  SectionPlans plans{
      text_section(kMeta, input.meta_json),
      text_section(kScene, input.whole_document()),
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
  };
  if (input.promises != 0) {
    // Not required: who does not know them draws by positions, as ever.
    plans.push_back(table_section(kPromises, tables.promises));
    plans.back().flags = 0;
    plans.push_back(table_section(kPromiseErrors, tables.promise_errors));
    plans.back().flags = 0;
  }
  if (input.has_page_hints) {
    plans.push_back(table_section(kPageHints, tables.page_hints));
    plans.back().flags = 0;
  }
  plans.push_back(SectionPlan{kPageData, page_data_bytes, nullptr, 0, 0});
  plans.push_back(SectionPlan{kBlobData, blob_data_bytes, nullptr, 0, 0});
  return plans;
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

}  // namespace

Result<std::vector<std::uint8_t>> write_asset(WriteInput input) {
  TRY_LET(made, make_tables(input));
  AssetTables tables = std::move(*made);
  const Hash128 content_hash = hash_content(tables, input.whole_document(), input.all_blobs(), input.promises != 0);
  TRY_LET(packed, pack_pages(tables, input.codec));
  const std::uint64_t page_data_bytes = place_pages(tables, *packed);
  const std::uint64_t blob_data_bytes = place_blobs(tables);

  SectionPlans plans = plan_sections(input, tables, page_data_bytes, blob_data_bytes);
  if (input.codec != format::Codec::kNone) pack_tables(plans);
  SectionEntries entries(plans.size());
  std::vector<std::uint8_t> file(place_sections(plans, entries));
  move_to_sections(entries, tables);
  copy_sections(plans, entries, file);
  copy_pages_and_blobs(tables, *packed, input.all_blobs(), file);
  seal(version_of(tables), content_hash, plans, entries, file);
  return file;
}

}  // namespace meshlode::builder
