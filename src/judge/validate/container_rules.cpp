// SPDX-License-Identifier: GPL-3.0-or-later
// Container rules: header, section table and sections. Every byte is hostile.
#include <algorithm>
#include <cstring>
#include <set>
#include <string>

#include "base/hash.h"
#include "format/section_columns.h"
#include "judge/validate/file_tables.h"
#include "run/read/limits.h"

namespace meshlode::judge {

namespace {

using format::SectionEntry;
using format::SectionId;

struct KnownSection {
  SectionId id;
  std::uint32_t record_bytes;  ///< 0 for text and raw bytes
  bool is_optional = false;
};

constexpr KnownSection kKnownSections[] = {
    {SectionId::kMeta, 0},
    {SectionId::kScene, 0},
    {SectionId::kStrings, 0},
    {SectionId::kMeshes, sizeof(format::MeshRecord)},
    {SectionId::kMaterials, sizeof(format::MaterialRecord)},
    {SectionId::kInstances, sizeof(format::InstanceRecord)},
    {SectionId::kGroups, sizeof(format::GroupRecord)},
    {SectionId::kClusters, sizeof(format::ClusterRecord)},
    {SectionId::kNodes, sizeof(format::NodeRecord)},
    {SectionId::kPages, sizeof(format::PageRecord)},
    {SectionId::kPageDeps, sizeof(std::uint32_t)},
    {SectionId::kPromises, sizeof(format::PromiseMeshRecord), true},
    {SectionId::kPromiseErrors, sizeof(format::PromiseGroupRecord), true},
    {SectionId::kPageHints, sizeof(format::PageHintRecord), true},
    {SectionId::kPageData, 0},
    {SectionId::kBlobs, sizeof(format::BlobRecord)},
    {SectionId::kBlobData, 0},
};

const KnownSection* find_known(std::uint32_t id) {
  for (const KnownSection& known : kKnownSections) {
    if (static_cast<std::uint32_t>(known.id) == id) return &known;
  }
  return nullptr;
}

std::string section_name(std::uint32_t id) {
  std::string name = "section ";
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>(id >> (8 * i) & 0xFFU);
    name += c >= 32 && c < 127 ? c : '?';
  }
  return name;
}

bool read_header(std::span<const std::uint8_t> bytes, format::FileHeader& header, RuleLog& log) {
  const auto where = [] { return std::string("header"); };
  log.check(Rule::kL001);
  if (bytes.size() < sizeof header) {
    log.add(Rule::kL001, where(), "the file has " + std::to_string(bytes.size()) + " bytes, a header has 64");
    return false;
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  bool sound = log.expect(header.magic == format::kMagic, Rule::kL001, where,
                          [] { return std::string("the magic is not LODE"); });
  if (!sound) return false;
  sound = log.expect(header.version == format::kPlainVersion || header.version == format::kVersion, Rule::kL001, where,
                     [&] { return "version " + std::to_string(header.version) + " is neither 1 nor 2"; });
  sound &= log.expect(header.header_bytes == sizeof header, Rule::kL001, where,
                      [&] { return "header_bytes is " + std::to_string(header.header_bytes) + ", not 64"; });
  log.expect(header.file_bytes == bytes.size(), Rule::kL002, where,
             [&] { return differs("file_bytes", header.file_bytes, "size of the file", std::uint64_t{bytes.size()}); });
  log.expect(header.flags == 0, Rule::kL003, where, [&] { return "flags are " + std::to_string(header.flags); });
  return sound;
}

bool read_section_table(FileTables& file, RuleLog& log) {
  const auto where = [] { return std::string("header, section table"); };
  const format::FileHeader& header = file.header;
  const std::uint64_t size = file.bytes.size();
  const std::uint64_t table_bytes = std::uint64_t{header.section_count} * sizeof(SectionEntry);
  bool sound = log.expect(header.section_entry_bytes == sizeof(SectionEntry), Rule::kL004, where,
                          [&] { return "stride is " + std::to_string(header.section_entry_bytes) + ", not 64"; });
  sound &= log.expect(header.section_table_offset == sizeof header && sizeof header <= size &&
                          table_bytes <= size - header.section_table_offset,
                      Rule::kL004, where, [&] {
                        return "offset " + std::to_string(header.section_table_offset) + " with " +
                               std::to_string(header.section_count) + " entries does not fit " + std::to_string(size);
                      });
  if (!sound) return false;
  file.sections.resize(header.section_count);
  if (!file.sections.empty()) {
    std::memcpy(file.sections.data(), file.bytes.data() + header.section_table_offset, table_bytes);
  }

  format::FileHeader plain = header;
  plain.header_checksum = 0;
  std::vector<std::uint8_t> covered(sizeof plain + table_bytes);
  std::memcpy(covered.data(), &plain, sizeof plain);
  if (table_bytes > 0) std::memcpy(covered.data() + sizeof plain, file.sections.data(), table_bytes);
  log.expect(
      hash64(covered) == header.header_checksum, Rule::kL005, [] { return std::string("header"); },
      [] { return std::string("header_checksum does not match"); });
  return true;
}

struct Extent {
  std::uint64_t begin, end;
  std::string name;
};

void check_extents(const FileTables& file, RuleLog& log) {
  std::vector<Extent> extents;
  extents.push_back({0, sizeof(format::FileHeader) + file.sections.size() * sizeof(SectionEntry), "section table"});
  for (const SectionEntry& entry : file.sections)
    extents.push_back({entry.offset, entry.offset + entry.bytes, section_name(entry.id)});
  log.check(Rule::kL007);
  log.check(Rule::kL014);
  std::uint64_t end = 0;
  const auto check_gap = [&](std::uint64_t from, std::uint64_t to, const std::string& name) {
    if (to - from >= format::kSectionAlignment) {
      log.add(Rule::kL014, "before " + name, std::to_string(to - from) + " bytes where alignment needs fewer");
    }
    for (std::uint64_t i = from; i < to; ++i) {
      if (file.bytes[i] != 0) {
        log.add(Rule::kL014, "before " + name, "byte " + std::to_string(i) + " is not zero");
        return;
      }
    }
  };
  for (const Extent& extent : extents) {
    if (extent.begin < end) {
      log.add(Rule::kL007, extent.name,
              "starts at " + std::to_string(extent.begin) + ", before " + std::to_string(end) +
                  " where the one before it ends");
    } else {
      check_gap(end, extent.begin, extent.name);
    }
    end = std::max(end, extent.end);
  }
  log.expect(
      end == file.bytes.size(), Rule::kL014, [] { return std::string("end of the file"); },
      [&] { return differs("end of the last section", end, "size of the file", std::uint64_t{file.bytes.size()}); });
}

bool check_section(const FileTables& file, const SectionEntry& entry, RuleLog& log) {
  const auto where = [&] { return section_name(entry.id); };
  const std::uint64_t size = file.bytes.size();
  const bool inside = log.expect(entry.offset <= size && entry.bytes <= size - entry.offset, Rule::kL006, where, [&] {
    return std::to_string(entry.bytes) + " bytes at " + std::to_string(entry.offset) + " leave the file";
  });
  log.expect(entry.offset % format::kSectionAlignment == 0, Rule::kL006, where,
             [&] { return "offset " + std::to_string(entry.offset) + " is not a multiple of 16"; });
  const KnownSection* known = find_known(entry.id);
  log.expect(known != nullptr || (entry.flags & format::kSectionRequired) == 0, Rule::kL009, where,
             [] { return std::string("unknown and required"); });
  log.expect((entry.flags & ~format::kSectionRequired) == 0 && entry.reserved == 0, Rule::kL009, where,
             [] { return std::string("reserved bits are not zero"); });
  if (known == nullptr || !inside) return inside;

  log.expect(entry.version == 0, Rule::kL009, where, [&] { return "version " + std::to_string(entry.version); });
  const bool is_raw = known->id == SectionId::kPageData || known->id == SectionId::kBlobData;
  const bool is_packed = !is_raw && entry.codec == static_cast<std::uint32_t>(format::SectionCodec::kColumns);
  bool sound = log.expect(is_packed || entry.codec == static_cast<std::uint32_t>(format::SectionCodec::kPlain),
                          Rule::kL009, where, [&] { return "codec " + std::to_string(entry.codec); });
  if (known->id != SectionId::kPageData) {
    sound &= log.expect(
        is_packed ? entry.decoded_bytes > 0 && entry.decoded_bytes / format::kMaxSectionRatio <= entry.bytes
                  : entry.decoded_bytes == entry.bytes,
        Rule::kL011, where, [&] { return differs("bytes", entry.bytes, "decoded_bytes", entry.decoded_bytes); });
    log.expect(hash64(file.bytes.subspan(entry.offset, entry.bytes)) == entry.checksum, Rule::kL010, where,
               [] { return std::string("checksum does not match"); });
  } else {
    log.expect(entry.checksum == 0, Rule::kL010, where,
               [] { return std::string("page data has a checksum of its own"); });
  }
  sound &= log.expect(entry.record_bytes == known->record_bytes, Rule::kL011, where, [&] {
    return differs("record_bytes", std::uint64_t{entry.record_bytes}, "record of version 1",
                   std::uint64_t{known->record_bytes});
  });
  if (known->record_bytes == 0) {
    log.expect(entry.record_count == 0, Rule::kL011, where,
               [] { return std::string("raw bytes with a record count"); });
  } else {
    sound &= log.expect(std::uint64_t{entry.record_count} * entry.record_bytes == entry.decoded_bytes, Rule::kL011,
                        where, [&] {
                          return differs("records' bytes", std::uint64_t{entry.record_count} * entry.record_bytes,
                                         "decoded_bytes", entry.decoded_bytes);
                        });
  }
  return sound;
}

/// The section's bytes, decoded where it is stored by columns; `file` keeps them.
std::span<const std::uint8_t> section_bytes(FileTables& file, const SectionEntry& entry, bool& is_broken) {
  const auto stored = file.bytes.subspan(entry.offset, entry.bytes);
  if (entry.codec == static_cast<std::uint32_t>(format::SectionCodec::kPlain)) return stored;
  std::uint64_t before = 0;
  for (const std::vector<std::uint8_t>& other : file.decoded) before += other.size();
  if (!format::is_section_sound(stored, entry.record_bytes, entry.decoded_bytes) ||
      entry.decoded_bytes > run::decoded_limit(file.bytes.size(), run::kDefaultMaxDecoded) - before) {
    is_broken = true;
    return {};
  }
  std::vector<std::uint8_t>& decoded = file.decoded.emplace_back(entry.decoded_bytes);
  is_broken |= !format::decode_section(stored, entry.record_bytes, decoded);
  return decoded;
}

template <class Record>
void copy_records(std::span<const std::uint8_t> bytes, std::vector<Record>& out) {
  out.resize(bytes.size() / sizeof(Record));
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), out.size() * sizeof(Record));
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  // The one place where bytes of the file are seen as characters.
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// False where the section's bytes do not decode.
bool take_section(FileTables& file, const SectionEntry& entry) {
  bool is_broken = false;
  const std::span<const std::uint8_t> bytes = section_bytes(file, entry, is_broken);
  switch (static_cast<SectionId>(entry.id)) {
    case SectionId::kMeta: file.meta = text_of(bytes); break;
    case SectionId::kScene: file.scene = text_of(bytes); break;
    case SectionId::kStrings: file.strings = text_of(bytes); break;
    case SectionId::kMeshes: copy_records(bytes, file.meshes); break;
    case SectionId::kMaterials: copy_records(bytes, file.materials); break;
    case SectionId::kInstances: copy_records(bytes, file.instances); break;
    case SectionId::kGroups: copy_records(bytes, file.groups); break;
    case SectionId::kClusters: copy_records(bytes, file.clusters); break;
    case SectionId::kNodes: copy_records(bytes, file.nodes); break;
    case SectionId::kPages: copy_records(bytes, file.pages); break;
    case SectionId::kPageDeps: copy_records(bytes, file.page_dependencies); break;
    case SectionId::kPromises:
      file.has_promises = true;
      copy_records(bytes, file.promises);
      break;
    case SectionId::kPromiseErrors:
      file.has_promise_errors = true;
      copy_records(bytes, file.promise_errors);
      break;
    case SectionId::kPageHints:
      file.has_page_hints = true;
      copy_records(bytes, file.page_hints);
      break;
    case SectionId::kPageData: file.page_data = entry; break;
    case SectionId::kBlobs: copy_records(bytes, file.blobs); break;
    case SectionId::kBlobData: file.blob_data = entry; break;
  }
  return !is_broken;
}

}  // namespace

std::optional<FileTables> read_tables(std::span<const std::uint8_t> bytes, RuleLog& log) {
  FileTables file;
  file.bytes = bytes;
  if (!read_header(bytes, file.header, log) || !read_section_table(file, log)) return std::nullopt;

  bool sound = true;
  std::set<std::uint32_t> seen;
  for (const SectionEntry& entry : file.sections) {
    sound &= check_section(file, entry, log);
    sound &= log.expect(
        seen.insert(entry.id).second, Rule::kL008, [&] { return section_name(entry.id); },
        [] { return std::string("occurs twice"); });
  }
  for (const KnownSection& known : kKnownSections) {
    const auto id = static_cast<std::uint32_t>(known.id);
    sound &= log.expect(
        known.is_optional || seen.contains(id), Rule::kL008, [&] { return section_name(id); },
        [] { return std::string("is missing"); });
  }
  if (!sound) return std::nullopt;
  check_extents(file, log);
  for (const SectionEntry& entry : file.sections) {
    if (find_known(entry.id) == nullptr) continue;
    sound &= log.expect(
        take_section(file, entry), Rule::kL011, [&] { return section_name(entry.id); },
        [] { return std::string("the stored bytes do not decode"); });
  }
  if (!sound) return std::nullopt;
  check_texts(file, log);
  return file;
}

}  // namespace meshlode::judge
