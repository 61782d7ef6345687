// SPDX-License-Identifier: GPL-3.0-or-later
// Page rules. Internal to the judge.
#pragma once

#include <vector>

#include "judge/validate/file_tables.h"
#include "run/read/asset.h"
#include "run/unpack/unpack.h"

namespace meshlode::judge {

/// L201, L202, L213: the page table and the dependencies. True where ranges are sound. \pre check_tables()
[[nodiscard]] bool check_page_table(const FileTables& file, RuleLog& log);
/// The decoded bytes of every page; empty where a page cannot be loaded.
struct LoadedPages {
  std::vector<run::PageBytes> pages;
  bool is_complete = true;
};
/// L203, L204. `asset` serves packed pages and may be null; then those are missing. \pre check_page_table()
[[nodiscard]] LoadedPages load_pages(const FileTables& file, const run::Asset* asset, RuleLog& log);
/// L205 … L212, L214 … L216: what is in every page. True where all clusters can be decoded.
[[nodiscard]] bool check_page_bytes(const FileTables& file, const LoadedPages& loaded, RuleLog& log);

}  // namespace meshlode::judge
