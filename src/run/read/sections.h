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

/// Checks sizes, offsets, order, gaps, versions and every checksum but those of pages and blobs.
/// `bytes` must be aligned to 8 bytes.
[[nodiscard]] Result<SectionIndex> index_sections(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::run
