// SPDX-License-Identifier: GPL-3.0-or-later
// `info --html`: one HTML file that shows an asset: its DAG as a graph, its meshes in 3D, what its bytes say. It holds
// the asset and the runtime that reads it (WebAssembly) and asks for nothing else. The same asset gives the same bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/report/byte_map.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// Stored page bytes that a page holds at most; of a larger asset the most important pages.
constexpr std::uint64_t kDefaultPageBytes = std::uint64_t{32} << 20U;

struct ViewerInput {
  std::string_view title;  ///< any bytes: the file's name
  /// The file as the user has it, where the asset of the page is that with another codec: sections, pages and bytes are
  /// told as they are there. Null: it is the asset of the page.
  const run::Asset* file = nullptr;
  std::span<const std::uint8_t> runtime;  ///< meshlode.wasm
  std::optional<ByteMap> byte_map;        ///< what the page says of bytes by level; left out where not given
  std::uint64_t max_page_bytes = kDefaultPageBytes;
};

/// The HTML. Errors: kUnsupported for pages stored with other codecs than none and strips; kInvalid where the pages
/// have no order.
[[nodiscard]] Result<std::string> viewer_page(const run::Asset& asset, const ViewerInput& input);

/// Pages that are embedded, by id: all where their stored bytes are at most `max_bytes`, else those without which a
/// piece of the surface would be missing (they hold terminal groups, or are needed by those), then as many of the
/// streaming order as fit. Each comes with those it depends on, so that there is a cut of what is there.
[[nodiscard]] Result<std::vector<bool>> choose_pages(const run::Asset& asset, std::uint64_t max_bytes);

}  // namespace meshlode::app
