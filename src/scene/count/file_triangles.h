// SPDX-License-Identifier: GPL-3.0-or-later
// How many triangles the source's file holds, told without the importer: by its size, or by its lines and rows. Build
// and judge compare with it what was read; it shares no code with what reads.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

namespace meshlode::scene {

struct FileTriangles {
  std::uint64_t at_least = 0;
  std::uint64_t at_most = std::numeric_limits<std::uint64_t>::max();
  const char* words = "";  ///< how it is known
};

/// Binary STL: as many facets of 50 bytes as lie behind its head of 84, less those with two corners in one place or
/// one that is not finite; one more where the header's count is larger and the last facet is cut short. Text STL: the
/// same of lines that begin with `vertex`, or more. OBJ and PLY: a triangle for each face of three different corners
/// and more, or more. Nothing for other formats.
///
/// \param name of the file, for its extension
[[nodiscard]] std::optional<FileTriangles> count_file_triangles(std::span<const std::uint8_t> bytes,
                                                                std::string_view name);

}  // namespace meshlode::scene
