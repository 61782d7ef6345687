// SPDX-License-Identifier: GPL-3.0-or-later
// A file's tables as copied records, read by the judge's own few lines: `read` refuses at the first fault, validate
// names every one. Internal to the judge.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/format.h>

#include "base/hash.h"
#include "judge/validate/rules.h"

namespace meshlode::judge {

/// What META says of the build, read once. Empty or nothing where it says nothing, or something of another type.
struct MetaFacts {
  /// Settings that a mesh may have for itself.
  struct OfMesh {
    std::string attributes, error_tier, uv_error_unit;
    std::vector<std::string> dropped;                              ///< attributes, by name
    std::optional<double> position_error, normal_error, uv_error;  ///< uv_error in uv_error_unit
    bool locks_borders = false;
  };
  /// A mesh that has pieces of another: by material, how many triangles such a piece has at most.
  struct Part {
    std::uint64_t mesh = 0, of = 0;
    std::map<std::uint64_t, std::uint32_t> most_triangles;
  };
  std::string source_hash;
  std::optional<std::uint64_t> cluster_triangles, cluster_vertices;  ///< settings
  std::optional<double> error_margin;                                ///< settings
  std::string textures;                                              ///< settings: how images were made; empty: kept
  bool keeps_topology = false;                                       ///< settings
  OfMesh whole;                                                      ///< settings
  std::vector<OfMesh> apart;                                         ///< settings/mesh_settings …
  std::map<std::uint64_t, std::size_t> apart_of_mesh;                ///< … of these meshes
  std::vector<Part> parts;                                           ///< as many as can be read

  [[nodiscard]] const OfMesh& of_mesh(std::uint64_t mesh) const {
    const auto found = apart_of_mesh.find(mesh);
    return found == apart_of_mesh.end() ? whole : apart[found->second];
  }
};

struct FileTables {
  std::span<const std::uint8_t> bytes;
  std::vector<std::vector<std::uint8_t>> decoded;  ///< sections that are stored by columns
  format::FileHeader header{};
  std::vector<format::SectionEntry> sections;
  std::vector<format::MeshRecord> meshes;
  std::vector<format::MaterialRecord> materials;
  std::vector<format::InstanceRecord> instances;
  std::vector<format::GroupRecord> groups;
  std::vector<format::ClusterRecord> clusters;
  std::vector<format::NodeRecord> nodes;
  std::vector<format::PageRecord> pages;
  std::vector<std::uint32_t> page_dependencies;
  std::vector<format::BlobRecord> blobs;
  bool has_promises = false, has_promise_errors = false;  ///< whether the sections are there
  std::vector<format::PromiseMeshRecord> promises;
  std::vector<format::PromiseGroupRecord> promise_errors;
  bool has_page_hints = false;  ///< whether the section is there
  std::vector<format::PageHintRecord> page_hints;
  std::string_view meta, scene, strings;
  MetaFacts facts;                   ///< of meta
  format::SectionEntry page_data{};  ///< zero where the section is missing
  format::SectionEntry blob_data{};
};

/// Container rules L001 … L014 (L012 is in content_hash.cpp). Nothing where the tables cannot be read at all.
[[nodiscard]] std::optional<FileTables> read_tables(std::span<const std::uint8_t> bytes, RuleLog& log);

/// L013, and file.facts.
void check_texts(FileTables& file, RuleLog& log);
[[nodiscard]] bool is_utf8(std::string_view text);
[[nodiscard]] MetaFacts read_meta_facts(std::string_view meta);

/// L101 … L115. True where every id and range is sound, so that the later rules may index.
[[nodiscard]] bool check_tables(const FileTables& file, RuleLog& log);

/// The content hash as docs/reference/format.md defines it. `page_bytes` has the decoded bytes of every page. \pre L114
/// holds
[[nodiscard]] Hash128 content_hash_of(const FileTables& file,
                                      std::span<const std::span<const std::uint8_t>> page_bytes);
/// L012. `page_bytes` has the decoded bytes of every page.
void check_content_hash(const FileTables& file, std::span<const std::span<const std::uint8_t>> page_bytes,
                        RuleLog& log);

/// L301 … L311. \pre check_tables()
void check_dag(const FileTables& file, RuleLog& log);

/// L117 and L313. \pre check_tables()
void check_promises(const FileTables& file, RuleLog& log);

/// L401 … L404. \pre check_tables()
void check_trees(const FileTables& file, RuleLog& log);

}  // namespace meshlode::judge
