// SPDX-License-Identifier: MIT
#include "run/unpack/content_hash.h"

#include <array>
#include <cstring>

#include "base/try.h"
#include "run/unpack/unpack.h"

namespace meshlode::run {

namespace {

template <class T>
void add(Hasher& hasher, const T& value) {
  hasher.update({reinterpret_cast<const std::uint8_t*>(&value), sizeof(T)});
}

}  // namespace

Result<Hash128> hash_asset_content(const Asset& asset, const OtherBytes& other) {
  using enum format::SectionId;
  Hasher hasher;
  add(hasher, asset.header().version);
  const auto add_section = [&](format::SectionId id) {
    for (const format::SectionEntry& entry : asset.sections()) {
      if (entry.id != static_cast<std::uint32_t>(id)) continue;
      add(hasher, entry.id);
      add(hasher, entry.decoded_bytes);
      if (id == kPages) {
        for (format::PageRecord page : asset.pages()) {
          page.offset = 0;
          page.stored_bytes = 0;
          page.codec = format::Codec::kNone;
          page.checksum = 0;
          add(hasher, page);
        }
      } else if (id == kBlobs) {
        for (format::BlobRecord blob : asset.blobs()) {
          blob.offset = 0;
          add(hasher, blob);
        }
      } else {
        const std::span<const std::uint8_t> bytes = other ? other(entry) : std::span<const std::uint8_t>();
        hasher.update(bytes.empty() ? asset.section_bytes(entry) : bytes);
      }
    }
  };
  for (const format::SectionId id :
       {kScene, kStrings, kMeshes, kMaterials, kInstances, kGroups, kClusters, kNodes, kPages, kPageDeps}) {
    add_section(id);
  }
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    TRY_LET(page, load_page(asset, PageId{p}));
    hasher.update(page->bytes());
  }
  add_section(kBlobs);
  for (const format::BlobRecord& blob : asset.blobs()) hasher.update(asset.blob_bytes(blob));
  add_section(kPromises);  // nothing where the file has none
  add_section(kPromiseErrors);
  return hasher.digest();
}

Hash128 stated_hash(const Asset& asset) {
  Hash128 hash{};
  std::memcpy(hash.data(), asset.header().content_hash, hash.size());
  return hash;
}

Status check_content_hash(const Asset& asset) {
  TRY_LET(hash, hash_asset_content(asset));
  if (*hash == stated_hash(asset)) return Ok{};
  return Error{ErrorCode::kInvalid, "header, field content_hash", "is not that of the content"};
}

}  // namespace meshlode::run
