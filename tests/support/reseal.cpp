// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reseal.h"

#include <cstddef>
#include <cstring>

#include "base/hash.h"

namespace meshlode::test {

namespace {

template <class T>
T load(std::span<const std::uint8_t> bytes, std::uint64_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <class T>
void store(std::vector<std::uint8_t>& bytes, std::uint64_t at, const T& value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

bool is_inside(std::span<const std::uint8_t> bytes, std::uint64_t offset, std::uint64_t count) {
  return offset <= bytes.size() && count <= bytes.size() - offset;
}

std::uint64_t entry_offset(std::uint32_t index) {
  return sizeof(format::FileHeader) + std::uint64_t{index} * sizeof(format::SectionEntry);
}

void reseal_pages(std::vector<std::uint8_t>& asset, const format::SectionEntry& entry) {
  for (std::uint64_t at = entry.offset; is_inside(asset, at, sizeof(format::PageRecord)) &&
                                        at + sizeof(format::PageRecord) <= entry.offset + entry.bytes;
       at += sizeof(format::PageRecord)) {
    auto page = load<format::PageRecord>(asset, at);
    if (!is_inside(asset, page.offset, page.stored_bytes)) continue;
    page.checksum = hash64({asset.data() + page.offset, page.stored_bytes});
    if (page.codec == format::Codec::kNone) page.decoded_checksum = page.checksum;
    store(asset, at, page);
  }
}

void reseal_blobs(std::vector<std::uint8_t>& asset, const format::SectionEntry& entry) {
  for (std::uint64_t at = entry.offset; is_inside(asset, at, sizeof(format::BlobRecord)) &&
                                        at + sizeof(format::BlobRecord) <= entry.offset + entry.bytes;
       at += sizeof(format::BlobRecord)) {
    auto blob = load<format::BlobRecord>(asset, at);
    if (!is_inside(asset, blob.offset, blob.bytes)) continue;
    blob.checksum = hash64({asset.data() + blob.offset, static_cast<std::size_t>(blob.bytes)});
    store(asset, at, blob);
  }
}

}  // namespace

void reseal(std::vector<std::uint8_t>& asset) {
  if (asset.size() < sizeof(format::FileHeader)) return;
  auto header = load<format::FileHeader>(asset, 0);
  const std::uint64_t most = (asset.size() - sizeof(format::FileHeader)) / sizeof(format::SectionEntry);
  if (header.section_count > most) return;
  for (std::uint32_t s = 0; s < header.section_count; ++s) {
    auto entry = load<format::SectionEntry>(asset, entry_offset(s));
    if (!is_inside(asset, entry.offset, entry.bytes)) continue;
    if (entry.id == static_cast<std::uint32_t>(format::SectionId::kPageData)) continue;
    if (entry.id == static_cast<std::uint32_t>(format::SectionId::kPages)) reseal_pages(asset, entry);
    if (entry.id == static_cast<std::uint32_t>(format::SectionId::kBlobs)) reseal_blobs(asset, entry);
    entry.checksum = hash64({asset.data() + entry.offset, static_cast<std::size_t>(entry.bytes)});
    store(asset, entry_offset(s), entry);
  }
  header.header_checksum = 0;
  store(asset, 0, header);
  header.header_checksum = hash64({asset.data(), static_cast<std::size_t>(entry_offset(header.section_count))});
  store(asset, 0, header);
}

std::uint64_t section_offset(std::span<const std::uint8_t> asset, format::SectionId id) {
  std::uint32_t s = 0;
  while (load<format::SectionEntry>(asset, entry_offset(s)).id != static_cast<std::uint32_t>(id)) ++s;
  return load<format::SectionEntry>(asset, entry_offset(s)).offset;
}

}  // namespace meshlode::test
