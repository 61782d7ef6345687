// SPDX-License-Identifier: GPL-3.0-or-later
// L012: the content hash, computed again from docs/reference/format.md ("Content hash").
#include <cstring>

#include "base/hash.h"
#include "judge/validate/file_tables.h"

namespace meshlode::judge {

namespace {

using format::SectionId;

template <class T>
std::span<const std::uint8_t> bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()};
}

class ContentHasher {
 public:
  template <class T>
  void value(const T& v) {
    hasher_.update(bytes_of(std::span<const T>(&v, 1)));
  }
  template <class T>
  void section(SectionId id, std::span<const T> records) {
    head(id, records.size_bytes());
    hasher_.update(bytes_of(records));
  }
  template <class T>
  void table(SectionId id, const std::vector<T>& records) {
    section(id, std::span<const T>(records));
  }
  void head(SectionId id, std::uint64_t bytes) {
    value(static_cast<std::uint32_t>(id));
    value(bytes);
  }
  void raw(std::span<const std::uint8_t> bytes) { hasher_.update(bytes); }
  [[nodiscard]] Hash128 digest() const { return hasher_.digest(); }

 private:
  Hasher hasher_;
};

}  // namespace

Hash128 content_hash_of(const FileTables& file, std::span<const std::span<const std::uint8_t>> page_bytes) {
  ContentHasher hasher;
  hasher.value(file.header.version);
  hasher.section(SectionId::kScene, std::span<const char>(file.scene));
  hasher.section(SectionId::kStrings, std::span<const char>(file.strings));
  hasher.table(SectionId::kMeshes, file.meshes);
  hasher.table(SectionId::kMaterials, file.materials);
  hasher.table(SectionId::kInstances, file.instances);
  hasher.table(SectionId::kGroups, file.groups);
  hasher.table(SectionId::kClusters, file.clusters);
  hasher.table(SectionId::kNodes, file.nodes);
  // How a page is stored is not content; what it holds is.
  hasher.head(SectionId::kPages, file.pages.size() * sizeof(format::PageRecord));
  for (format::PageRecord page : file.pages) {
    page.offset = 0;
    page.stored_bytes = 0;
    page.codec = format::Codec::kNone;
    page.checksum = 0;
    hasher.value(page);
  }
  hasher.table(SectionId::kPageDeps, file.page_dependencies);
  for (const auto& bytes : page_bytes) hasher.raw(bytes);
  hasher.head(SectionId::kBlobs, file.blobs.size() * sizeof(format::BlobRecord));
  for (format::BlobRecord blob : file.blobs) {
    blob.offset = 0;
    hasher.value(blob);
  }
  for (const format::BlobRecord& blob : file.blobs) hasher.raw(file.bytes.subspan(blob.offset, blob.bytes));
  if (file.has_promises) hasher.table(SectionId::kPromises, file.promises);
  if (file.has_promise_errors) hasher.table(SectionId::kPromiseErrors, file.promise_errors);
  return hasher.digest();
}

void check_content_hash(const FileTables& file, std::span<const std::span<const std::uint8_t>> page_bytes,
                        RuleLog& log) {
  const Hash128 hash = content_hash_of(file, page_bytes);
  log.expect(
      std::memcmp(hash.data(), file.header.content_hash, hash.size()) == 0, Rule::kL012,
      [] { return std::string("header"); }, [] { return std::string("content_hash is not that of the content"); });
}

}  // namespace meshlode::judge
