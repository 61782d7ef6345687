// SPDX-License-Identifier: MIT
// The rules that make an asset's tables safe to index: every count, range, id, enumerator and float. What they promise
// is what code behind Asset relies on: partitions without gaps, ids in range, no cycle anywhere, no NaN.
#pragma once

#include <cstdint>
#include <span>

#include <meshlode/format.h>
#include <meshlode/result.h>

namespace meshlode::run {

/// The tables as they lie in the file, not trusted yet.
struct RawTables {
  std::uint32_t version = format::kPlainVersion;  ///< of the file: what its flags may say
  std::span<const format::MeshRecord> meshes;
  std::span<const format::MaterialRecord> materials;
  std::span<const format::InstanceRecord> instances;
  std::span<const format::GroupRecord> groups;
  std::span<const format::ClusterRecord> clusters;
  std::span<const format::NodeRecord> nodes;
  std::span<const format::PageRecord> pages;
  std::span<const std::uint32_t> page_dependencies;
  std::span<const format::BlobRecord> blobs;
  bool has_promises = false;  ///< of the two tables below one is there at least
  std::span<const format::PromiseMeshRecord> promises;
  std::span<const format::PromiseGroupRecord> promise_errors;
  bool has_page_hints = false;
  std::span<const format::PageHintRecord> page_hints;
  std::uint64_t string_bytes = 0;
  const format::SectionEntry* page_data = nullptr;
  const format::SectionEntry* blob_data = nullptr;
};

/// A BVH deeper than this is refused: a traversal may use a stack of fixed size.
constexpr std::uint32_t kMaxBvhDepth = 64;

/// Bytes of all names together. Names may share their bytes, so that their sum is a product that a small file chooses.
[[nodiscard]] std::uint64_t count_name_bytes(const RawTables& tables);

[[nodiscard]] Status check_meshes(const RawTables& tables);  ///< meshes partition groups, clusters and nodes
[[nodiscard]] Status check_materials(const RawTables& tables);
[[nodiscard]] Status check_instances(const RawTables& tables);
[[nodiscard]] Status check_blobs(const RawTables& tables);
[[nodiscard]] Status check_groups(const RawTables& tables);    ///< \pre check_meshes; groups partition clusters
[[nodiscard]] Status check_clusters(const RawTables& tables);  ///< \pre check_groups; the DAG has no cycle
[[nodiscard]] Status check_nodes(const RawTables& tables);     ///< \pre check_meshes; each BVH is a tree
[[nodiscard]] Status check_pages(const RawTables& tables);     ///< \pre check_groups; pages partition groups
[[nodiscard]] Status check_promises(const RawTables& tables);  ///< \pre check_groups
[[nodiscard]] Status check_page_hints(const RawTables& tables);

}  // namespace meshlode::run
