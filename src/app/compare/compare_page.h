// SPDX-License-Identifier: GPL-3.0-or-later
// `compare -O DIR`: index.html beside the pictures, which it shows. A page without scripts, in the style of `report`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/compare/compare.h"

namespace meshlode::app {

struct ComparedFile {
  std::string name;
  std::string verdict;                         ///< "equal", "changed", "new", "gone", "updated", "FAILED" or "error"
  std::string message;                         ///< why, a line each
  std::string text;                            ///< what is printed of it
  std::optional<std::uint64_t> before, after;  ///< bytes of the assets
  std::vector<PictureChange> pictures;         ///< those without files are not shown
};

/// The largest difference of pictures first, then failures, then by name. Names and messages are escaped.
[[nodiscard]] std::string compare_page(std::vector<ComparedFile> files, const std::string& title);

}  // namespace meshlode::app
