// SPDX-License-Identifier: GPL-3.0-or-later
// What `meshlode info` says about an asset: statistics over its tables, as data, as JSON, CSV, Markdown and text.
// The JSON's keys (docs/schemas/info.schema.json) and the columns of CSV (docs/reference/info.md) are a promise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <meshlode/format.h>

#include "app/report/bar.h"
#include "app/report/byte_map.h"
#include "app/report/read_meta.h"
#include "run/read/asset.h"

namespace meshlode::app {

struct LevelInfo {
  std::uint32_t level = 0;
  std::uint64_t clusters = 0, triangles = 0, vertices = 0;  ///< stored; a vertex counts once per cluster it is in
  std::uint64_t full_clusters = 0;                          ///< at the cap
  double fill = 0.0;                                        ///< triangles / (clusters · cap)
  std::uint64_t groups = 0, stuck_groups = 0;  ///< groups that consume this level; as MeshInfo::stuck_groups
  float error_min = 0.0F, error_max = 0.0F;    ///< own errors of the level's clusters, object units
  float normal_deviation_max = 0.0F;           ///< of their own groups, degrees; kInfiniteError: not measured
  float uv_deviation_max = 0.0F;               ///< UV units
};

struct StuckGroupInfo {
  std::uint32_t mesh = 0, group = 0, level = 0;
  format::StuckReason reason = format::StuckReason::kNotStuck;
  std::uint64_t clusters = 0, triangles = 0;
};

struct MeshInfo {
  std::optional<std::size_t> part_of;           ///< the mesh whose pieces it has
  std::uint64_t roots = 0, root_triangles = 0;  ///< a root is a cluster that nothing coarser replaces
  std::uint64_t clusters = 0, triangles = 0, vertices = 0;
  std::vector<StuckGroupInfo> stuck;  ///< those of a locked border among them
  std::uint64_t stuck_groups = 0;     ///< without those: a border that was to be kept is no fault
  std::vector<LevelInfo> levels;
};

struct ImageInfo {
  std::uint32_t blob = 0;
  std::uint32_t width = 0, height = 0;          ///< 0: not known
  std::optional<std::uint64_t> gpu_bytes;       ///< find_gpu_bytes()
  std::optional<MetaInfo::SourceImage> source;  ///< where it was converted
  std::uint64_t source_gpu_bytes = 0;           ///< of `source`
};

struct AssetInfo {
  MetaInfo meta;
  std::uint64_t geometry_bytes = 0;  ///< pages and the tables they need: meshes, groups, clusters, nodes, pages, deps
  std::uint64_t image_bytes = 0;
  std::vector<ImageInfo> images;             ///< in the order of the blobs
  std::uint64_t image_gpu_bytes = 0;         ///< of those that a GPU holds decoded, with mip levels
  std::uint64_t source_image_bytes = 0;      ///< before --textures; of images that were not converted their own
  std::uint64_t source_image_gpu_bytes = 0;  ///< the same
  std::uint64_t source_triangles = 0, source_vertices = 0;
  std::uint64_t stored_triangles = 0, stored_vertices = 0;
  std::uint64_t levels = 0, roots = 0, max_roots_per_mesh = 0, stuck_groups = 0;
  std::uint64_t border_groups = 0;  ///< stuck by a locked border alone: listed as stuck, not counted as such
  std::uint64_t dropped_degenerate = 0, dropped_duplicate = 0, dropped_repaired = 0;
  std::uint32_t cluster_cap = 0;  ///< triangles: from the settings, else the smallest of 128 and 256 that holds
  std::vector<MeshInfo> meshes;
  std::optional<ByteMap> byte_map;  ///< left to the caller: it takes loading every page
};

[[nodiscard]] AssetInfo describe_asset(const run::Asset& asset);

/// With `list_stuck`, every stuck group is listed with its reason.
[[nodiscard]] std::string info_json(const run::Asset& asset, const AssetInfo& info, bool list_stuck);
[[nodiscard]] std::string info_text(const run::Asset& asset, const AssetInfo& info, bool list_stuck,
                                    BarStyle style = BarStyle::kAscii);
/// What the text says, as tables of GitHub's Markdown. Nothing in a name is markup.
[[nodiscard]] std::string info_markdown(const run::Asset& asset, const AssetInfo& info, bool list_stuck);
/// One table with a head line: the levels of all meshes, or with `list_stuck` the stuck groups
/// (docs/reference/info.md).
[[nodiscard]] std::string info_csv(const run::Asset& asset, const AssetInfo& info, bool list_stuck);

[[nodiscard]] std::string section_name(std::uint32_t id);  ///< four letters, '?' for bytes that are not printable
[[nodiscard]] std::uint64_t section_decoded_bytes(const run::Asset& asset, const format::SectionEntry& section);

}  // namespace meshlode::app
