// SPDX-License-Identifier: MIT
// The container: header and section table, checked before anything behind them is looked at.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string_view>

#include <meshlode/format.h>
#include <meshlode/result.h>

namespace meshlode::run {

/// The sections of a file by id; ids that this reader does not know are left out.
struct SectionIndex {
  const format::FileHeader* header = nullptr;
  std::span<const format::SectionEntry> entries;  ///< all of them, in file order
  std::map<format::SectionId, const format::SectionEntry*> known;

  /// \pre `id` is one of format::SectionId that every file has: index_sections has refused files that lack one
  [[nodiscard]] const format::SectionEntry& entry(format::SectionId id) const { return *known.at(id); }
  /// Null where the file has no such section.
  [[nodiscard]] const format::SectionEntry* find(format::SectionId id) const {
    const auto found = known.find(id);
    return found == known.end() ? nullptr : found->second;
  }
};

/// Checks sizes, offsets, order, gaps, versions and every checksum but those of pages and blobs. `bytes`, aligned to 8,
/// are the first of a file of `file_bytes`: all of them, or its head at least (find_head).
[[nodiscard]] Result<SectionIndex> index_sections(std::span<const std::uint8_t> bytes, std::uint64_t file_bytes);

/// How many bytes lie before the first of PAGE and BLOB: all tables, and so all that opening reads.
struct HeadSize {
  std::uint64_t bytes = 0;  ///< at most those of the file
  bool is_known = false;    ///< false: this many of the first bytes are needed to say it
};
/// From the first bytes of a file, at any address and as many as there are. Errors: those of index_sections as far as
/// it is asked; kUnsupported where a table lies behind PAGE or BLOB.
[[nodiscard]] Result<HeadSize> find_head(std::span<const std::uint8_t> first, std::uint64_t file_bytes);

}  // namespace meshlode::run
