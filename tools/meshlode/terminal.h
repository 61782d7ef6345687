// SPDX-License-Identifier: GPL-3.0-or-later
// What the terminal, if there is one, can show.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace meshlode::cli {

/// Whether stdout is a terminal that shows more than ASCII.
[[nodiscard]] bool is_unicode_terminal();

enum class Color : std::uint8_t { kRed, kGreen, kYellow, kBold, kDim };
enum class Stream : std::uint8_t { kOut, kErr };

[[nodiscard]] bool is_terminal(Stream stream);

/// `--color`: auto (where there is a terminal, unless NO_COLOR is set or TERM is dumb), always or never. From then on.
void use_color(std::string_view choice);
/// The text in this colour where the stream shows colours, else as it is.
[[nodiscard]] std::string colored(Stream stream, Color color, const std::string& text);

struct ColoredWord {
  std::string_view word;
  Color color;
};
/// Text for stdout with the first of these words in each line, between spaces, in its colour where colours are shown.
[[nodiscard]] std::string with_colored_words(const std::string& text, std::span<const ColoredWord> words);

}  // namespace meshlode::cli
