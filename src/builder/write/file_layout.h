// SPDX-License-Identifier: GPL-3.0-or-later
// Where everything lies in a file: header, section table, sections one after the other, each at a multiple of 16, and
// the checksums over all of it (docs/reference/format.md, File layout).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "base/hash.h"

namespace meshlode::builder {

[[nodiscard]] constexpr std::uint64_t align_section(std::uint64_t offset) {
  return (offset + format::kSectionAlignment - 1) / format::kSectionAlignment * format::kSectionAlignment;
}

/// A section before it has a place: bytes that lie somewhere, or only a size, where the caller copies them on its own.
/// What `data` points to must outlive the plan.
struct SectionPlan {
  format::SectionId id;
  std::uint64_t bytes = 0;
  const void* data = nullptr;
  std::uint32_t record_bytes = 0;
  std::uint64_t record_count = 0;
  std::uint32_t flags = format::kSectionRequired;
  /// Where not null, of a section that this program does not know: everything but the offset stays as it says.
  const format::SectionEntry* kept = nullptr;
  std::vector<std::uint8_t> packed{};  ///< what is stored instead of `data`, where not empty
  [[nodiscard]] std::uint64_t stored_bytes() const { return packed.empty() ? bytes : packed.size(); }
};

/// Tables and texts by columns, where that is shorter. The tables of places and checksums (pages, blobs) stay as they
/// are: they hardly shrink, and are filled in later.
void pack_tables(std::span<SectionPlan> plans);

/// The page's place, as an offset within its section, and what is stored there. `end`: of the page before it; moved on.
void place_page(format::Codec codec, std::span<const std::uint8_t> stored, format::PageRecord& page,
                std::uint64_t& end);

/// The sections one after the other behind the table of their entries; checksums are not set yet. Returns the file's
/// size. \pre there are as many entries as plans
[[nodiscard]] std::uint64_t place_sections(std::span<const SectionPlan> plans, std::span<format::SectionEntry> entries);

void copy_bytes(std::vector<std::uint8_t>& file, std::uint64_t offset, const void* data, std::size_t bytes);

/// Those that have `data`.
void copy_sections(std::span<const SectionPlan> plans, std::span<const format::SectionEntry> entries,
                   std::vector<std::uint8_t>& file);

/// Header and table of sections, with their checksums. \pre all sections are in their place
void seal(std::uint32_t version, const Hash128& content_hash, std::span<const SectionPlan> plans,
          std::span<format::SectionEntry> entries, std::vector<std::uint8_t>& file);

}  // namespace meshlode::builder
