// SPDX-License-Identifier: GPL-3.0-or-later
// Other page sizes and orders of a scene that is built already: what a build with these options would make of its
// groups, without the build.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/stream/scene.h"
#include "builder/options.h"

namespace meshlode::app {

struct PageLayout {
  std::uint32_t page_kib = builder::kUsualPageKib;  ///< as `build --page-size`
  PageOrder order = PageOrder::kLevel;
  std::uint32_t root_bytes = 0;  ///< as `build --root-bytes`; 0: as page_kib

  /// As parse_layouts() reads it.
  [[nodiscard]] std::string text() const;
};

/// "32,64/covisible,32/covisible/131072": each the size of a page in KiB, then, where they are given, the order and the
/// bytes of first pages. Errors: kUsage, of the option `where`.
[[nodiscard]] Result<std::vector<PageLayout>> parse_layouts(std::string_view text, const std::string& where);

/// The scene with its groups in other pages. Decoded sizes are those of a build with these options of an asset in level
/// order; stored sizes are in the proportion that each mesh's pages have now.
[[nodiscard]] StreamScene with_layout(const StreamScene& scene, const PageLayout& layout);

}  // namespace meshlode::app
