// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/write/hash_content.h"

#include <span>

namespace meshlode::builder {

namespace {

template <class T>
std::span<const std::uint8_t> bytes_of(std::span<const T> records) {
  return {reinterpret_cast<const std::uint8_t*>(records.data()), records.size_bytes()};
}

class SectionHasher {
 public:
  void start(format::SectionId id, std::uint64_t bytes) {
    add(static_cast<std::uint32_t>(id));
    add(bytes);
  }
  template <class T>
  void table(format::SectionId id, const std::vector<T>& records) {
    start(id, records.size() * sizeof(T));
    hasher_.update(bytes_of(std::span<const T>(records)));
  }
  void text(format::SectionId id, std::string_view text) {
    start(id, text.size());
    hasher_.update(bytes_of(std::span<const char>(text)));
  }
  template <class T>
  void add(T value) {
    hasher_.update(bytes_of(std::span<const T>(&value, 1)));
  }
  void raw(std::span<const std::uint8_t> bytes) { hasher_.update(bytes); }
  [[nodiscard]] Hash128 digest() const { return hasher_.digest(); }

 private:
  Hasher hasher_;
};

}  // namespace

Hash128 hash_content(const AssetTables& tables, std::string_view document, std::span<const scene::SceneBlob> blobs,
                     bool has_promises) {
  SectionHasher hasher;
  hasher.add(version_of(tables));
  hasher.text(format::SectionId::kScene, document);
  hasher.text(format::SectionId::kStrings, tables.strings.bytes());
  hasher.table(format::SectionId::kMeshes, tables.meshes);
  hasher.table(format::SectionId::kMaterials, tables.materials);
  hasher.table(format::SectionId::kInstances, tables.instances);
  hasher.table(format::SectionId::kGroups, tables.groups);
  hasher.table(format::SectionId::kClusters, tables.clusters);
  hasher.table(format::SectionId::kNodes, tables.nodes);
  hasher.start(format::SectionId::kPages, tables.pages.size() * sizeof(format::PageRecord));
  for (format::PageRecord page : tables.pages) {
    page.offset = 0;
    page.stored_bytes = 0;
    page.codec = format::Codec::kNone;
    page.checksum = 0;
    hasher.add(page);
  }
  hasher.table(format::SectionId::kPageDeps, tables.page_dependencies);
  for (const auto& page : tables.page_bytes) hasher.raw(page);
  hasher.start(format::SectionId::kBlobs, tables.blobs.size() * sizeof(format::BlobRecord));
  for (format::BlobRecord blob : tables.blobs) {
    blob.offset = 0;
    hasher.add(blob);
  }
  for (const scene::SceneBlob& blob : blobs) hasher.raw(blob.bytes);
  if (has_promises) {
    hasher.table(format::SectionId::kPromises, tables.promises);
    hasher.table(format::SectionId::kPromiseErrors, tables.promise_errors);
  }
  return hasher.digest();
}

}  // namespace meshlode::builder
