// SPDX-License-Identifier: MIT
#include "run/read/sections.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/try.h"
#include "format/section_columns.h"
#include "run/read/file_place.h"

namespace meshlode::run {

namespace {

static_assert(std::endian::native == std::endian::little, "records are viewed as they lie in the file");

using format::SectionId;

struct KnownSection {
  SectionId id;
  std::uint32_t record_bytes;  ///< 0: text or raw bytes
  bool is_optional = false;
};

constexpr std::array kKnownSections{
    KnownSection{SectionId::kMeta, 0},
    KnownSection{SectionId::kScene, 0},
    KnownSection{SectionId::kStrings, 0},
    KnownSection{SectionId::kMeshes, sizeof(format::MeshRecord)},
    KnownSection{SectionId::kMaterials, sizeof(format::MaterialRecord)},
    KnownSection{SectionId::kInstances, sizeof(format::InstanceRecord)},
    KnownSection{SectionId::kGroups, sizeof(format::GroupRecord)},
    KnownSection{SectionId::kClusters, sizeof(format::ClusterRecord)},
    KnownSection{SectionId::kNodes, sizeof(format::NodeRecord)},
    KnownSection{SectionId::kPages, sizeof(format::PageRecord)},
    KnownSection{SectionId::kPageDeps, sizeof(std::uint32_t)},
    KnownSection{SectionId::kBlobs, sizeof(format::BlobRecord)},
    KnownSection{SectionId::kPromises, sizeof(format::PromiseMeshRecord), true},
    KnownSection{SectionId::kPromiseErrors, sizeof(format::PromiseGroupRecord), true},
    KnownSection{SectionId::kPageHints, sizeof(format::PageHintRecord), true},
    KnownSection{SectionId::kPageData, 0},
    KnownSection{SectionId::kBlobData, 0},
};

/// Null where this reader does not know it.
const KnownSection* find_known(std::uint32_t id) {
  for (const KnownSection& section : kKnownSections) {
    if (static_cast<std::uint32_t>(section.id) == id) return &section;
  }
  return nullptr;
}

std::uint64_t table_end(const format::FileHeader& header) {
  return sizeof(format::FileHeader) + std::uint64_t{header.section_count} * sizeof(format::SectionEntry);
}

/// All but the checksum.
Status check_header(const format::FileHeader& header, std::uint64_t file_bytes) {
  if (header.magic != format::kMagic) return invalid_header("magic", "this is not a .lode file");
  if (header.version != format::kPlainVersion && header.version != format::kVersion) {
    return Error{ErrorCode::kUnsupported, "header, field version",
                 "version " + std::to_string(header.version) + ", this reader knows versions " +
                     std::to_string(format::kPlainVersion) + " and " + std::to_string(format::kVersion)};
  }
  if (header.header_bytes != sizeof(format::FileHeader)) return invalid_header("header_bytes", "must be 64");
  if (header.section_entry_bytes != sizeof(format::SectionEntry)) {
    return invalid_header("section_entry_bytes", "must be 64");
  }
  if (header.flags != 0) return invalid_header("flags", "must be 0");
  if (header.file_bytes != file_bytes) {
    return invalid_header("file_bytes",
                          "says " + std::to_string(header.file_bytes) + ", the file has " + std::to_string(file_bytes));
  }
  if (header.section_table_offset != sizeof(format::FileHeader)) {
    return invalid_header("section_table_offset", "must be 64");
  }
  if (table_end(header) > file_bytes) {
    return invalid_header("section_count", "the table reaches beyond the end of the file");
  }
  return Ok{};
}

/// \pre `bytes` reach to the end of the section table
Status check_header_checksum(std::span<const std::uint8_t> bytes, const format::FileHeader& header) {
  const auto covered = bytes.first(table_end(header));
  std::vector<std::uint8_t> sealed(covered.begin(), covered.end());
  std::fill_n(sealed.begin() + offsetof(format::FileHeader, header_checksum), sizeof(header.header_checksum),
              std::uint8_t{0});
  if (hash64(sealed) != header.header_checksum) return invalid_header("header_checksum", "does not match");
  return Ok{};
}

bool is_body(std::uint32_t id) {
  return id == static_cast<std::uint32_t>(SectionId::kPageData) ||
         id == static_cast<std::uint32_t>(SectionId::kBlobData);
}

/// Sections follow each other in table order, with fewer than 16 zero bytes between them: nothing hides in a gap.
/// `bytes`: those of the file that are there, from its start.
Status check_extent(std::span<const std::uint8_t> bytes, std::uint64_t size, const format::SectionEntry& entry,
                    std::uint64_t previous_end) {
  if (entry.offset % format::kSectionAlignment != 0) {
    return invalid_section(entry.id, "offset", "is not a multiple of 16");
  }
  if (entry.offset < previous_end || entry.offset - previous_end >= format::kSectionAlignment) {
    return invalid_section(entry.id, "offset", "does not follow the section before it");
  }
  if (entry.offset > size || entry.bytes > size - entry.offset) {
    return invalid_section(entry.id, "bytes", "reaches beyond the end of the file");
  }
  for (std::uint64_t at = previous_end; at < entry.offset && at < bytes.size(); ++at) {
    if (bytes[at] != 0) return invalid_section(entry.id, "offset", "the padding before it is not zero");
  }
  return Ok{};
}

Status check_known(std::span<const std::uint8_t> bytes, const format::SectionEntry& entry, std::uint32_t record_bytes) {
  if (entry.version != 0) {
    return Error{ErrorCode::kUnsupported, "section " + section_tag(entry.id) + ", field version",
                 "version " + std::to_string(entry.version) + ", this reader knows version 0"};
  }
  if ((entry.flags & ~format::kSectionRequired) != 0U) return invalid_section(entry.id, "flags", "has an unknown bit");
  const auto id = static_cast<SectionId>(entry.id);
  if (entry.codec == static_cast<std::uint32_t>(format::SectionCodec::kColumns) && !is_body(entry.id)) {
    if (entry.decoded_bytes / format::kMaxSectionRatio > entry.bytes || entry.decoded_bytes == 0) {
      return invalid_section(entry.id, "decoded_bytes", "cannot come from so few bytes");
    }
  } else if (entry.codec != static_cast<std::uint32_t>(format::SectionCodec::kPlain)) {
    return Error{ErrorCode::kUnsupported, "section " + section_tag(entry.id) + ", field codec",
                 "codec " + std::to_string(entry.codec) + " is not known to this reader"};
  } else if (entry.decoded_bytes != entry.bytes) {
    return invalid_section(entry.id, "decoded_bytes", "must be bytes where the section is stored as it is");
  }
  if (entry.record_bytes != record_bytes) {
    return invalid_section(entry.id, "record_bytes",
                           "is " + std::to_string(entry.record_bytes) + ", must be " + std::to_string(record_bytes));
  }
  if (record_bytes == 0 ? entry.record_count != 0
                        : std::uint64_t{entry.record_count} * record_bytes != entry.decoded_bytes) {
    return invalid_section(entry.id, "record_count", "does not match the section's bytes");
  }
  if (entry.record_count == format::kNone) return invalid_section(entry.id, "record_count", "is too large");
  if (id == SectionId::kPageData) {
    if (entry.checksum != 0) return invalid_section(entry.id, "checksum", "must be 0: pages carry their own");
  } else if (id != SectionId::kBlobData && hash64(bytes.subspan(entry.offset, entry.bytes)) != entry.checksum) {
    return invalid_section(entry.id, "checksum", "does not match");
  }
  return Ok{};
}

}  // namespace

Result<SectionIndex> index_sections(std::span<const std::uint8_t> bytes, std::uint64_t file_bytes) {
  if (bytes.size() < sizeof(format::FileHeader)) {
    return invalid_header("magic", "the file has " + std::to_string(bytes.size()) + " bytes, a header has 64");
  }
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(std::uint64_t) != 0) {
    return Error{ErrorCode::kUsage, "", "the bytes of an asset must be aligned to 8"};
  }
  SectionIndex index;
  index.header = reinterpret_cast<const format::FileHeader*>(bytes.data());
  TRY(check_header(*index.header, file_bytes));
  TRY(check_header_checksum(bytes, *index.header));
  index.entries = {reinterpret_cast<const format::SectionEntry*>(bytes.data() + sizeof(format::FileHeader)),
                   index.header->section_count};

  std::uint64_t end = sizeof(format::FileHeader) + index.entries.size_bytes();
  for (const format::SectionEntry& entry : index.entries) {
    TRY(check_extent(bytes, file_bytes, entry, end));
    end = entry.offset + entry.bytes;
    const KnownSection* const known = find_known(entry.id);
    if (known == nullptr) {
      if ((entry.flags & format::kSectionRequired) != 0U) {
        return Error{ErrorCode::kUnsupported, "section " + section_tag(entry.id),
                     "is required and not known to this reader"};
      }
      continue;
    }
    TRY(check_known(bytes, entry, known->record_bytes));
    if (!index.known.emplace(known->id, &entry).second) return invalid_section(entry.id, "id", "is there twice");
  }
  if (end != file_bytes) return invalid_header("file_bytes", "the last section does not end the file");
  for (const KnownSection& section : kKnownSections) {
    if (!section.is_optional && index.find(section.id) == nullptr) {
      return Error{ErrorCode::kInvalid, "section " + section_tag(static_cast<std::uint32_t>(section.id)), "is missing"};
    }
  }
  return index;
}

Result<HeadSize> find_head(std::span<const std::uint8_t> first, std::uint64_t file_bytes) {
  if (file_bytes < sizeof(format::FileHeader)) {
    return invalid_header("magic", "the file has " + std::to_string(file_bytes) + " bytes, a header has 64");
  }
  format::FileHeader header;
  if (first.size() < sizeof(header)) return HeadSize{sizeof(header), false};
  std::memcpy(&header, first.data(), sizeof(header));
  TRY(check_header(header, file_bytes));
  if (first.size() < table_end(header)) return HeadSize{table_end(header), false};
  TRY(check_header_checksum(first, header));
  HeadSize head{file_bytes, true};
  bool is_behind_body = false;
  std::uint64_t end = table_end(header);
  for (std::uint32_t i = 0; i < header.section_count; ++i) {
    format::SectionEntry entry;
    std::memcpy(&entry, first.data() + sizeof(header) + i * sizeof(entry), sizeof(entry));
    TRY(check_extent(first, file_bytes, entry, end));
    end = entry.offset + entry.bytes;
    if (is_body(entry.id)) {
      if (!is_behind_body) head.bytes = entry.offset;
      is_behind_body = true;
    } else if (is_behind_body && find_known(entry.id) != nullptr) {
      return Error{ErrorCode::kUnsupported, "section " + section_tag(entry.id),
                   "lies behind the pages or images, so that the file cannot be opened from its head"};
    }
  }
  return head;
}

}  // namespace meshlode::run
