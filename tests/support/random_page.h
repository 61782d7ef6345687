// SPDX-License-Identifier: GPL-3.0-or-later
// Pages that keep the layout of docs/reference/format.md and mean nothing: every field is drawn, so that a codec may
// rely on the format's rules and on nothing that real geometry would add.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/format.h>

namespace meshlode::test {

struct RandomPageOptions {
  std::uint64_t seed = 1;
  std::uint32_t cluster_count = 5;
  bool has_normals = true;
  std::uint32_t uv_set_count = 1;
  bool has_color = false;
  bool has_material_ranges = false;
  std::uint32_t max_triangles = 128;
  std::uint32_t max_field_bits = 12;  ///< up to 25, cut to what a field may have
};

struct RandomPage {
  format::MeshRecord mesh{};
  format::PageRecord record{};  ///< first_cluster, cluster_count, bytes
  std::vector<std::uint32_t> words;
};

/// \pre the options keep the page within kMaxPageBytes
[[nodiscard]] RandomPage make_random_page(const RandomPageOptions& options);

}  // namespace meshlode::test
