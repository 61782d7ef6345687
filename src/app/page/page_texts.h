// SPDX-License-Identifier: GPL-3.0-or-later
// The fixed texts of pages, which lie beside this file as they are edited, or in docs/examples/viewer: HTML, CSS and
// scripts. These go into other people's pages, and are MIT.
#pragma once

#include <span>
#include <string_view>

namespace meshlode::app {

/// The page with its holes, @NAME@.
[[nodiscard]] std::string_view page_frame();
/// What the page shows: that of docs/examples/viewer, whose scripts it shares.
[[nodiscard]] std::string_view page_main();
[[nodiscard]] std::string_view page_style();
/// Of page and runtime: what a copy of them must say.
[[nodiscard]] std::string_view page_licences();
/// In the order in which they become one script.
[[nodiscard]] std::span<const std::string_view> page_scripts();

/// The page of a batch (app/overview/), which has neither runtime nor asset.
[[nodiscard]] std::string_view overview_frame();
[[nodiscard]] std::string_view overview_style();
[[nodiscard]] std::string_view overview_script();

/// The page of `compare` (app/compare/), which has no script. Its style goes behind that of the overview.
[[nodiscard]] std::string_view compare_frame();
[[nodiscard]] std::string_view compare_style();

}  // namespace meshlode::app
