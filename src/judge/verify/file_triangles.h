// SPDX-License-Identifier: GPL-3.0-or-later
// How many triangles the source's file holds, told without the importer: by its size, or by words at the head of lines.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

namespace meshlode::judge {

struct FileTriangles {
  std::uint64_t at_least = 0;
  std::uint64_t at_most = std::numeric_limits<std::uint64_t>::max();
  const char* words = "";  ///< how it is known
};

/// Binary STL: as many facets of 50 bytes as lie behind its head of 84, less those with two corners in one place. Text
/// STL: the same of lines that begin with `vertex`, or more. OBJ: a triangle for each face of three corners and more,
/// or more. PLY: one where its header states a face. Nothing for other formats.
///
/// \param name of the file, for its extension
[[nodiscard]] std::optional<FileTriangles> count_file_triangles(std::span<const std::uint8_t> bytes,
                                                                std::string_view name);

}  // namespace meshlode::judge
