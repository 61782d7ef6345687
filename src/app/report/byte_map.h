// SPDX-License-Identifier: GPL-3.0-or-later
// What each attribute costs at each level: the bytes of the decoded pages, and of the tables beside them; and which
// part of the file each section and level takes, so that nothing of it is left over.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/result.h>

#include "run/read/asset.h"

namespace meshlode::app {

/// Bits of decoded pages, by what they say.
struct PageBits {
  std::uint64_t heads = 0;  ///< page headers and their last words count to the level of their first cluster
  std::uint64_t materials = 0;
  std::uint64_t positions = 0;
  std::uint64_t normals = 0;
  std::uint64_t uvs = 0;     ///< with their ranges
  std::uint64_t colors = 0;  ///< with their ranges
  std::uint64_t topology = 0;
  std::uint64_t padding = 0;  ///< up to whole words
  [[nodiscard]] std::uint64_t total() const {
    return heads + materials + positions + normals + uvs + colors + topology + padding;
  }
  PageBits& operator+=(const PageBits& other);
};

struct ByteMap {
  std::vector<PageBits> levels;  ///< over all meshes
  PageBits total;                ///< 8 · decoded page bytes
  std::uint64_t stored_page_bytes = 0;
  std::uint64_t table_bytes = 0;  ///< meshes, groups, clusters, nodes, pages, dependencies
  /// Of stored_page_bytes, by level. A page that has clusters of several levels is shared out as its decoded bits are.
  std::vector<double> stored_by_level;
  /// Header and section table; zeros between sections, between pages and between blobs. With the sections' bytes the
  /// first two make up the file; with stored_page_bytes the third makes up PAGE, with the blobs' bytes the last BLOB.
  std::uint64_t head_bytes = 0, alignment_bytes = 0, page_alignment_bytes = 0, blob_alignment_bytes = 0;
};

/// Loads every page. Errors: those of load_page.
[[nodiscard]] Result<ByteMap> map_bytes(const run::Asset& asset);

}  // namespace meshlode::app
