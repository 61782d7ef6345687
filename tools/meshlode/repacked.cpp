// SPDX-License-Identifier: GPL-3.0-or-later
#include "repacked.h"

#include <cstring>
#include <string>
#include <utility>

#include "builder/write/repack.h"
#include "builder/write_meta.h"
#include "run/decode/decode.h"
#include "run/unpack/content_hash.h"
#include "run/unpack/unpack.h"

namespace meshlode::cli {

namespace {

/// An asset that does not say what its own hash is of has been changed since it was written.
Status check_content(const run::Asset& asset) {
  const auto hash = run::hash_asset_content(asset);
  if (!hash) return hash.error();
  if (*hash == stated_hash(asset)) return Ok{};
  return Error{ErrorCode::kInvalid, "header, field content_hash", "is not that of the content"};
}

}  // namespace

Hash128 stated_hash(const run::Asset& asset) {
  Hash128 hash{};
  std::memcpy(hash.data(), asset.header().content_hash, hash.size());
  return hash;
}

Result<std::vector<std::uint8_t>> repacked(const run::Asset& asset, format::Codec codec) {
  std::uint64_t page_bytes = 0;
  for (const format::PageRecord& page : asset.pages()) page_bytes += page.bytes;
  if (const Status status = run::check_decoded_bytes(asset, page_bytes); !status) return status.error();
  if (const Status status = check_content(asset); !status) return status.error();

  builder::RepackInput input;
  for (const format::SectionEntry& entry : asset.sections()) {
    input.sections.push_back({entry, asset.section_bytes(entry)});
  }
  input.version = asset.header().version;
  input.content_hash = stated_hash(asset);
  input.meta_json = builder::meta_with_codec(asset.meta_json(), codec);
  input.load_page = [&](std::size_t p) -> Result<std::vector<std::uint8_t>> {
    const auto page = run::load_page(asset, PageId{p});
    if (!page) return page.error();
    return std::vector<std::uint8_t>(page->bytes().begin(), page->bytes().end());
  };
  input.codec = codec;
  auto bytes = builder::repack_asset(input);
  if (!bytes) return bytes.error();

  const auto written = run::Asset::from_bytes(*bytes);
  const Status same = written ? check_content(*written) : Status(written.error());
  if (!same) return Error{ErrorCode::kBuildFailed, "what would be written", same.error().message()};
  return bytes;
}

}  // namespace meshlode::cli
