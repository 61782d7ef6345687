// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/write/file_layout.h"

#include <bit>
#include <cstring>

#include "base/parallel.h"
#include "builder/pack/pack_section.h"
#include "format/section_columns.h"

namespace meshlode::builder {

namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in memory");

bool is_stored_by_columns(const SectionPlan& plan) {
  using enum format::SectionId;
  return plan.data != nullptr && plan.kept == nullptr && plan.id != kPages && plan.id != kBlobs &&
         plan.id != kPageData && plan.id != kBlobData;
}

}  // namespace

void pack_tables(std::span<SectionPlan> plans) {
  parallel_for_each_index(plans.size(), 1, [&](std::size_t s) {
    SectionPlan& plan = plans[s];
    if (!is_stored_by_columns(plan)) return;
    plan.packed = pack_section({static_cast<const std::uint8_t*>(plan.data), plan.bytes}, plan.record_bytes);
  });
}

void place_page(format::Codec codec, std::span<const std::uint8_t> stored, format::PageRecord& page,
                std::uint64_t& end) {
  page.offset = align_section(end);
  page.stored_bytes = static_cast<std::uint32_t>(stored.size());
  page.codec = codec;
  page.checksum = codec == format::Codec::kNone ? page.decoded_checksum : hash64(stored);
  end = page.offset + stored.size();
}

std::uint64_t place_sections(std::span<const SectionPlan> plans, std::span<format::SectionEntry> entries) {
  std::uint64_t end = sizeof(format::FileHeader) + entries.size_bytes();
  for (std::size_t s = 0; s < plans.size(); ++s) {
    const SectionPlan& plan = plans[s];
    format::SectionEntry& entry = entries[s];
    const auto codec = plan.packed.empty() ? format::SectionCodec::kPlain : format::SectionCodec::kColumns;
    if (plan.kept != nullptr) {
      entry = *plan.kept;
    } else {
      entry.id = static_cast<std::uint32_t>(plan.id);
      entry.codec = static_cast<std::uint32_t>(codec);
      entry.bytes = plan.stored_bytes();
      entry.decoded_bytes = plan.bytes;
      entry.flags = plan.flags;
      entry.record_bytes = plan.record_bytes;
      entry.record_count = static_cast<std::uint32_t>(plan.record_count);
    }
    entry.offset = align_section(end);
    end = entry.offset + entry.bytes;
  }
  return end;
}

void copy_bytes(std::vector<std::uint8_t>& file, std::uint64_t offset, const void* data, std::size_t bytes) {
  if (bytes > 0) std::memcpy(file.data() + offset, data, bytes);
}

void copy_sections(std::span<const SectionPlan> plans, std::span<const format::SectionEntry> entries,
                   std::vector<std::uint8_t>& file) {
  for (std::size_t s = 0; s < plans.size(); ++s) {
    const SectionPlan& plan = plans[s];
    const void* data = plan.packed.empty() ? plan.data : plan.packed.data();
    copy_bytes(file, entries[s].offset, data, data == nullptr ? 0 : plan.stored_bytes());
  }
}

void seal(std::uint32_t version, const Hash128& content_hash, std::span<const SectionPlan> plans,
          std::span<format::SectionEntry> entries, std::vector<std::uint8_t>& file) {
  for (std::size_t s = 0; s < plans.size(); ++s) {
    if (plans[s].kept != nullptr || plans[s].id == format::SectionId::kPageData) continue;  // pages carry their own
    entries[s].checksum = hash64({file.data() + entries[s].offset, entries[s].bytes});
  }
  format::FileHeader header{};
  header.magic = format::kMagic;
  header.version = version;
  header.header_bytes = sizeof(header);
  header.section_count = static_cast<std::uint32_t>(entries.size());
  header.file_bytes = file.size();
  header.section_table_offset = sizeof(header);
  std::memcpy(header.content_hash, content_hash.data(), content_hash.size());
  header.section_entry_bytes = sizeof(format::SectionEntry);
  copy_bytes(file, 0, &header, sizeof(header));
  copy_bytes(file, sizeof(header), entries.data(), entries.size_bytes());
  header.header_checksum = hash64({file.data(), sizeof(header) + entries.size_bytes()});
  copy_bytes(file, 0, &header, sizeof(header));
}

}  // namespace meshlode::builder
