// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of the whole file, made from meshes with ids of their own: everything but what depends on file offsets.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "builder/write/write.h"

namespace meshlode::builder {

/// Strings in order of first use, each stored once.
class StringTable {
 public:
  [[nodiscard]] format::StringRef add(const std::string& text);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::map<std::string, format::StringRef, std::less<>> refs_;
};

struct AssetTables {
  StringTable strings;
  std::vector<format::MeshRecord> meshes;
  std::vector<format::MaterialRecord> materials;
  std::vector<format::InstanceRecord> instances;
  std::vector<format::GroupRecord> groups;
  std::vector<format::ClusterRecord> clusters;
  std::vector<format::NodeRecord> nodes;
  std::vector<format::PageRecord> pages;  ///< offset, stored_bytes, codec and checksum not set yet
  std::vector<std::uint32_t> page_dependencies;
  std::vector<format::PromiseMeshRecord> promises;         ///< one a mesh where WriteInput has promises, else none
  std::vector<format::PromiseGroupRecord> promise_errors;  ///< one a group, or none
  std::vector<format::PageHintRecord> page_hints;          ///< one a page where WriteInput has them, else none
  std::vector<format::BlobRecord> blobs;                   ///< offset not set yet
  std::vector<std::vector<std::uint8_t>> page_bytes;       ///< decoded, PageHeader::first_cluster global
};

/// The oldest version that says what is in the tables: format::kPlainVersion, but where there are aggregates.
[[nodiscard]] std::uint32_t version_of(const AssetTables& tables);

/// Moves the pages out of `input`. Errors: kBuildFailed where a count leaves 32 bits or an id is out of range.
[[nodiscard]] Result<AssetTables> make_tables(WriteInput& input);

}  // namespace meshlode::builder
