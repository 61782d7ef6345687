// SPDX-License-Identifier: GPL-3.0-or-later
// An asset's bytes as records that a test may change, and sealed again so that only the meaning is broken: checksums
// and the content hash are true afterwards.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/page.h>

namespace meshlode::test {

class AssetEdit {
 public:
  /// What a codec packed is stored plain first.
  explicit AssetEdit(std::vector<std::uint8_t> bytes);

  [[nodiscard]] std::vector<std::uint8_t>& bytes() { return bytes_; }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  [[nodiscard]] format::SectionEntry section(format::SectionId id) const;
  [[nodiscard]] std::uint64_t section_entry_offset(format::SectionId id) const;

  template <class Record>
  [[nodiscard]] Record get(std::uint64_t offset) const {
    Record record;
    std::memcpy(&record, bytes_.data() + offset, sizeof record);
    return record;
  }
  template <class Record>
  void put(std::uint64_t offset, const Record& record) {
    std::memcpy(bytes_.data() + offset, &record, sizeof record);
  }
  /// Reads the record, changes it, writes it back.
  template <class Record, class Change>
  void change_at(std::uint64_t offset, const Change& change) {
    auto record = get<Record>(offset);
    change(record);
    put(offset, record);
  }

  [[nodiscard]] std::uint64_t count(format::SectionId id, std::uint64_t record_bytes) const {
    return section(id).bytes / record_bytes;
  }
  template <class Record>
  [[nodiscard]] std::uint64_t offset_of(format::SectionId id, std::uint64_t index) const {
    return section(id).offset + index * sizeof(Record);
  }

  template <class Change>
  void header(const Change& c) {
    change_at<format::FileHeader>(0, c);
  }
  template <class Change>
  void entry(format::SectionId id, const Change& c) {
    change_at<format::SectionEntry>(section_entry_offset(id), c);
  }
  template <class Change>
  void mesh(std::uint64_t i, const Change& c) {
    change_at<format::MeshRecord>(offset_of<format::MeshRecord>(format::SectionId::kMeshes, i), c);
  }
  template <class Change>
  void material(std::uint64_t i, const Change& c) {
    change_at<format::MaterialRecord>(offset_of<format::MaterialRecord>(format::SectionId::kMaterials, i), c);
  }
  template <class Change>
  void instance(std::uint64_t i, const Change& c) {
    change_at<format::InstanceRecord>(offset_of<format::InstanceRecord>(format::SectionId::kInstances, i), c);
  }
  template <class Change>
  void group(std::uint64_t i, const Change& c) {
    change_at<format::GroupRecord>(offset_of<format::GroupRecord>(format::SectionId::kGroups, i), c);
  }
  template <class Change>
  void cluster(std::uint64_t i, const Change& c) {
    change_at<format::ClusterRecord>(offset_of<format::ClusterRecord>(format::SectionId::kClusters, i), c);
  }
  template <class Change>
  void node(std::uint64_t i, const Change& c) {
    change_at<format::NodeRecord>(offset_of<format::NodeRecord>(format::SectionId::kNodes, i), c);
  }
  template <class Change>
  void page(std::uint64_t i, const Change& c) {
    change_at<format::PageRecord>(offset_of<format::PageRecord>(format::SectionId::kPages, i), c);
  }
  template <class Change>
  void blob(std::uint64_t i, const Change& c) {
    change_at<format::BlobRecord>(offset_of<format::BlobRecord>(format::SectionId::kBlobs, i), c);
  }

  [[nodiscard]] std::vector<format::MeshRecord> meshes() const {
    return all<format::MeshRecord>(format::SectionId::kMeshes);
  }
  [[nodiscard]] std::vector<format::GroupRecord> groups() const {
    return all<format::GroupRecord>(format::SectionId::kGroups);
  }
  [[nodiscard]] std::vector<format::ClusterRecord> clusters() const {
    return all<format::ClusterRecord>(format::SectionId::kClusters);
  }
  [[nodiscard]] std::vector<format::NodeRecord> nodes() const {
    return all<format::NodeRecord>(format::SectionId::kNodes);
  }
  [[nodiscard]] std::vector<format::PageRecord> pages() const {
    return all<format::PageRecord>(format::SectionId::kPages);
  }
  [[nodiscard]] std::vector<format::BlobRecord> blobs() const {
    return all<format::BlobRecord>(format::SectionId::kBlobs);
  }
  [[nodiscard]] std::vector<format::InstanceRecord> instances() const {
    return all<format::InstanceRecord>(format::SectionId::kInstances);
  }
  [[nodiscard]] std::vector<format::MaterialRecord> materials() const {
    return all<format::MaterialRecord>(format::SectionId::kMaterials);
  }

  /// Where everything of a cluster lies in its page. \pre the page is sound
  [[nodiscard]] format::ClusterLayout layout(std::uint64_t cluster) const;
  [[nodiscard]] std::uint64_t page_offset_of_cluster(std::uint64_t cluster) const;
  /// A field of the head, or of the words at `word` of the cluster's page.
  [[nodiscard]] std::int32_t head(std::uint64_t cluster, format::BitField field) const;
  void put_head(std::uint64_t cluster, format::BitField field, std::int32_t value);
  [[nodiscard]] std::int32_t field(std::uint64_t cluster, std::uint32_t word, format::BitField field) const;
  void put_field(std::uint64_t cluster, std::uint32_t word, format::BitField field, std::int32_t value);
  /// `count` bits of the cluster's page.
  [[nodiscard]] std::uint32_t page_bits(std::uint64_t cluster, std::uint32_t bit, std::uint32_t count) const;
  void put_page_bits(std::uint64_t cluster, std::uint32_t bit, std::uint32_t count, std::uint32_t value);

  /// What a vertex has in the stream: 0 … 2 raw positions, then a and b of the normal, u and v of each UV set, and the
  /// colour, as far as the mesh has them.
  struct BitPlace {
    std::uint32_t bit = 0;  ///< of the page
    std::uint32_t count = 0;
  };
  [[nodiscard]] std::uint32_t stored_count(std::uint64_t cluster) const;
  [[nodiscard]] BitPlace place_of(std::uint64_t cluster, std::uint32_t vertex, std::uint32_t k) const;
  [[nodiscard]] std::uint32_t stored(std::uint64_t cluster, std::uint32_t vertex, std::uint32_t k) const;
  void put_stored(std::uint64_t cluster, std::uint32_t vertex, std::uint32_t k, std::uint32_t value);
  /// Adds to the minimum of value `k` of all vertices (of the first UV range).
  void move_minimum(std::uint64_t cluster, std::uint32_t k, std::int32_t by);
  [[nodiscard]] std::int32_t minimum(std::uint64_t cluster, std::uint32_t k) const;

  /// Makes every checksum and the content hash true again, as far as the tables can still be read.
  void seal();

 private:
  template <class Record>
  [[nodiscard]] std::vector<Record> all(format::SectionId id) const {
    std::vector<Record> records(section(id).bytes / sizeof(Record));
    if (!records.empty())
      std::memcpy(records.data(), bytes_.data() + section(id).offset, records.size() * sizeof(Record));
    return records;
  }
  [[nodiscard]] const format::MeshRecord mesh_of(std::uint64_t cluster) const;
  [[nodiscard]] std::vector<std::uint32_t> page_words(std::uint64_t cluster) const;
  /// The word (of the page) and field that hold the minimum of value `k`.
  [[nodiscard]] std::pair<std::uint32_t, format::BitField> minimum_field(std::uint64_t cluster, std::uint32_t k) const;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace meshlode::test
