// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/rewrite/rewrite_asset.h"

#include <span>
#include <utility>

#include "base/try.h"
#include "builder/write/repack.h"
#include "run/decode/decode.h"
#include "run/unpack/unpack.h"

namespace meshlode::app {

Result<std::vector<std::uint8_t>> rewrite_asset(const run::Asset& asset, const Rewrite& rewrite) {
  std::uint64_t page_bytes = 0;
  for (const format::PageRecord& page : asset.pages()) page_bytes += page.bytes;
  TRY(run::check_decoded_bytes(asset, page_bytes));
  TRY(run::check_content_hash(asset));

  builder::RepackInput input;
  for (const format::SectionEntry& entry : asset.sections()) {
    const std::span<const std::uint8_t> other = rewrite.other ? rewrite.other(entry) : std::span<const std::uint8_t>();
    input.sections.push_back({entry, other.empty() ? asset.section_bytes(entry) : other});
  }
  input.version = asset.header().version;
  TRY_LET(content_hash, run::hash_asset_content(asset, rewrite.other));
  input.content_hash = *content_hash;
  input.meta_json = rewrite.meta_json;
  input.load_page = [&](std::size_t p) -> Result<std::vector<std::uint8_t>> {
    TRY_LET(page, run::load_page(asset, PageId{p}));
    return std::vector<std::uint8_t>(page->bytes().begin(), page->bytes().end());
  };
  input.codec = rewrite.codec;
  TRY_LET(bytes, builder::repack_asset(input));

  const auto written = run::Asset::from_bytes(*bytes);
  const Status same = written ? run::check_content_hash(*written) : Status(written.error());
  if (!same) return Error{ErrorCode::kBuildFailed, "what would be written", same.error().message()};
  return bytes;
}

}  // namespace meshlode::app
