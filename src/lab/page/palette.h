// SPDX-License-Identifier: GPL-3.0-or-later
// The colours of the page and of its plots, each for light and for dark, and the style sheets made of them. A style
// sheet names a colour as var(--name). In the page these are custom properties, which its switch sets; a plot that
// stands alone has the colours themselves in it, as readers of SVG other than browsers want it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace meshlode::lab::page {

/// Colours that a series may have: --s0, --s1, …
constexpr std::size_t kSeriesColours = 8;

/// The custom properties, by the reader's preference and by data-theme="light" or "dark" of the root.
[[nodiscard]] std::string palette_properties();

/// `css` with the light colours in the place of their names, then again with the dark ones, for who prefers those.
[[nodiscard]] std::string css_for_itself(std::string_view css);

/// The style sheets and the script of this folder.
[[nodiscard]] std::string_view page_css();
[[nodiscard]] std::string_view plot_css();
[[nodiscard]] std::string_view page_script();

}  // namespace meshlode::lab::page
