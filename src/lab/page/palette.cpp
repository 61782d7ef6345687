// SPDX-License-Identifier: GPL-3.0-or-later
// The series' colours are those of Okabe and Ito (2008), told apart by people who see fewer colours than others, made
// darker on white and lighter on black until each has a contrast of 3 to 1 with the paper.
#include "lab/page/palette.h"

#include <array>

namespace meshlode::lab::page {

namespace {

struct Colour {
  std::string_view name, light, dark;
};

constexpr std::array kColours = {
    Colour{"paper", "#ffffff", "#14171a"}, Colour{"panel", "#f5f6f8", "#1d2126"},
    Colour{"ink", "#1b1f24", "#e6e8ea"},   Colour{"soft", "#565e68", "#a3abb5"},
    Colour{"line", "#d5d9de", "#363d45"},  Colour{"accent", "#0b5cad", "#7db8f5"},
    Colour{"good", "#05664a", "#4cc9a0"},  Colour{"bad", "#a33b00", "#f2935c"},
    Colour{"s0", "#0072b2", "#56a8e0"},    Colour{"s1", "#c24e00", "#e8803c"},
    Colour{"s2", "#00805c", "#2dbd93"},    Colour{"s3", "#b0528a", "#db93bd"},
    Colour{"s4", "#8a6d00", "#e0b64a"},    Colour{"s5", "#2a86bd", "#8fcdf3"},
    Colour{"s6", "#5d52a3", "#a79df0"},    Colour{"s7", "#4d5560", "#b4bcc6"},
};

std::string properties(std::string_view selector, bool is_dark) {
  std::string out(selector);
  out += "{color-scheme:";
  out += is_dark ? "dark" : "light";
  for (const Colour& colour : kColours) {
    out += ";--";
    out += colour.name;
    out += ':';
    out += is_dark ? colour.dark : colour.light;
  }
  return out + "}\n";
}

std::string with_colours(std::string_view css, bool is_dark) {
  constexpr std::string_view kMark = "var(--";
  std::string out;
  while (!css.empty()) {
    const std::size_t at = css.find(kMark);
    out += css.substr(0, at);
    if (at == std::string_view::npos) break;
    css.remove_prefix(at + kMark.size());
    const std::size_t end = css.find(')');
    const std::string_view name = css.substr(0, end);
    for (const Colour& colour : kColours) {
      if (colour.name == name) out += is_dark ? colour.dark : colour.light;
    }
    css.remove_prefix(end == std::string_view::npos ? css.size() : end + 1);
  }
  return out;
}

}  // namespace

std::string palette_properties() {
  return properties(":root", false) + "@media screen{\n@media (prefers-color-scheme:dark){" +
         properties(":root:not([data-theme=light])", true) + "}\n" + properties(":root[data-theme=dark]", true) + "}\n";
}

std::string css_for_itself(std::string_view css) {
  return with_colours(css, false) + "@media screen and (prefers-color-scheme:dark){\n" + with_colours(css, true) +
         "}\n";
}

}  // namespace meshlode::lab::page
