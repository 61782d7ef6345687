// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/write/repack.h"

#include <cstring>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/try.h"
#include "builder/write/file_layout.h"

namespace meshlode::builder {

namespace {

struct StoredPage {
  format::Codec codec = format::Codec::kNone;
  std::vector<std::uint8_t> bytes;
};

bool is_known(format::SectionId id) {
  switch (id) {  // without a default, so that the compiler names a new section
    case format::SectionId::kMeta:
    case format::SectionId::kScene:
    case format::SectionId::kStrings:
    case format::SectionId::kMeshes:
    case format::SectionId::kMaterials:
    case format::SectionId::kInstances:
    case format::SectionId::kGroups:
    case format::SectionId::kClusters:
    case format::SectionId::kNodes:
    case format::SectionId::kPages:
    case format::SectionId::kPageDeps:
    case format::SectionId::kPromises:
    case format::SectionId::kPromiseErrors:
    case format::SectionId::kPageHints:
    case format::SectionId::kPageData:
    case format::SectionId::kBlobs:
    case format::SectionId::kBlobData: return true;
  }
  return false;
}

template <class T>
std::vector<T> read_table(const RepackInput& input, format::SectionId id) {
  std::vector<T> records;
  for (const RepackSection& section : input.sections) {
    if (section.entry.id != static_cast<std::uint32_t>(id)) continue;
    records.resize(section.bytes.size() / sizeof(T));
    if (!records.empty()) std::memcpy(records.data(), section.bytes.data(), records.size() * sizeof(T));
  }
  return records;
}

Result<StoredPage> store_page_of(const RepackInput& input, const format::MeshRecord& mesh, std::size_t page) {
  TRY_LET(decoded, input.load_page(page));
  auto packed = input.pack(mesh, *decoded, input.codec);
  if (!packed) {
    return Error{packed.error().code, "page " + std::to_string(page), packed.error().detail};
  }
  if (packed->codec == format::Codec::kNone) return StoredPage{format::Codec::kNone, std::move(*decoded)};
  return StoredPage{packed->codec, std::move(packed->bytes)};
}

Result<std::vector<StoredPage>> store_pages(const RepackInput& input, const std::vector<format::PageRecord>& pages) {
  const auto meshes = read_table<format::MeshRecord>(input, format::SectionId::kMeshes);
  const auto groups = read_table<format::GroupRecord>(input, format::SectionId::kGroups);
  std::vector<StoredPage> stored(pages.size());
  std::vector<std::optional<Error>> errors(pages.size());
  parallel_for_each_index(pages.size(), 1, [&](std::size_t p) {
    auto page = store_page_of(input, meshes[groups[pages[p].first_group].mesh], p);
    if (page) {
      stored[p] = std::move(*page);
    } else {
      errors[p] = page.error();
    }
  });
  for (const auto& error : errors) {
    if (error) return *error;
  }
  return stored;
}

/// Those of `pages` and `blobs` are filled in later: both must outlive the plans, and keep their place.
std::vector<SectionPlan> plan_sections(const RepackInput& input, const std::vector<format::PageRecord>& pages,
                                       const std::vector<format::BlobRecord>& blobs, std::uint64_t page_data_bytes) {
  std::vector<SectionPlan> plans;
  for (const RepackSection& section : input.sections) {
    const auto id = static_cast<format::SectionId>(section.entry.id);
    SectionPlan plan{id,
                     section.bytes.size(),
                     section.bytes.data(),
                     section.entry.record_bytes,
                     section.entry.record_count,
                     section.entry.flags};
    if (!is_known(id)) plan.kept = &section.entry;
    if (id == format::SectionId::kMeta) {
      plan.bytes = input.meta_json.size();
      plan.data = input.meta_json.data();
    } else if (id == format::SectionId::kPages) {
      plan.data = pages.data();
    } else if (id == format::SectionId::kBlobs) {
      plan.data = blobs.data();
    } else if (id == format::SectionId::kPageData) {
      plan.bytes = page_data_bytes;
      plan.data = nullptr;
    }
    plans.push_back(std::move(plan));
  }
  return plans;
}

/// Pages have offsets within their section, blobs those of the file that was read.
void move_to_sections(const RepackInput& input, std::span<const format::SectionEntry> entries,
                      std::vector<format::PageRecord>& pages, std::vector<format::BlobRecord>& blobs) {
  for (std::size_t s = 0; s < entries.size(); ++s) {
    if (entries[s].id == static_cast<std::uint32_t>(format::SectionId::kPageData)) {
      for (format::PageRecord& page : pages) page.offset += entries[s].offset;
    }
    if (entries[s].id == static_cast<std::uint32_t>(format::SectionId::kBlobData)) {
      const std::uint64_t before = input.sections[s].entry.offset;
      for (format::BlobRecord& blob : blobs) blob.offset = blob.offset - before + entries[s].offset;
    }
  }
}

}  // namespace

Result<std::vector<std::uint8_t>> repack_asset(const RepackInput& input) {
  auto pages = read_table<format::PageRecord>(input, format::SectionId::kPages);
  auto blobs = read_table<format::BlobRecord>(input, format::SectionId::kBlobs);
  TRY_LET(stored, store_pages(input, pages));
  std::uint64_t page_data_bytes = 0;
  for (std::size_t p = 0; p < pages.size(); ++p) {
    place_page((*stored)[p].codec, (*stored)[p].bytes, pages[p], page_data_bytes);
  }

  std::vector<SectionPlan> plans = plan_sections(input, pages, blobs, page_data_bytes);
  if (input.codec != format::Codec::kNone) pack_tables(plans);
  std::vector<format::SectionEntry> entries(plans.size());
  std::vector<std::uint8_t> file(place_sections(plans, entries));
  move_to_sections(input, entries, pages, blobs);
  copy_sections(plans, entries, file);
  for (std::size_t p = 0; p < pages.size(); ++p) {
    copy_bytes(file, pages[p].offset, (*stored)[p].bytes.data(), (*stored)[p].bytes.size());
  }
  seal(input.version, input.content_hash, plans, entries, file);
  return file;
}

}  // namespace meshlode::builder
