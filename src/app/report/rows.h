// SPDX-License-Identifier: GPL-3.0-or-later
// What text and Markdown of `info` both say, in words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/report/info.h"

namespace meshlode::app {

constexpr std::size_t kMaxRows = 40;  ///< of meshes, materials and the like: a city has thousands; JSON lists all

struct Row {
  std::string label;  ///< empty: it goes on with what the row above says
  std::string value;
};

/// The file, the scene, totals, settings, the plan and what was left out.
[[nodiscard]] std::vector<Row> summary_rows(const run::Asset& asset, const AssetInfo& info);

/// Two or three sentences on a mesh: sizes, roots, why groups are stuck.
[[nodiscard]] std::vector<std::string> mesh_lines(const run::Asset& asset, std::uint32_t id, const MeshInfo& info);

/// Columns of a mesh's levels for what was measured alone.
struct DeviationColumns {
  bool normals = false, uvs = false;
};
[[nodiscard]] DeviationColumns deviation_columns(const format::MeshRecord& mesh, const MeshInfo& info);

/// "OPAQUE", "MASK below 0.5", "BLEND".
[[nodiscard]] std::string alpha_text(const format::MaterialRecord& material);

/// "… and 3 more meshes (--format json lists all)"; empty where all fit.
[[nodiscard]] std::string more_text(std::size_t total, const char* what);

/// A column of the byte map.
struct ByteColumn {
  const char* name;
  std::uint64_t bits;
};
[[nodiscard]] std::array<ByteColumn, 9> byte_columns(const PageBits& bits);
/// As the page of --html rounds: halves upwards, for bits make half bytes. printf rounds them to even numbers.
[[nodiscard]] std::string rounded_text(double value, int digits);

}  // namespace meshlode::app
