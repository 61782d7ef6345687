// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of GitHub's Markdown, and text in them that is nothing but text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace meshlode::app {

/// Text that no reader of Markdown takes for markup, HTML or the end of a table's cell. \pre no line break
[[nodiscard]] inline std::string markdown_text(std::string_view text) {
  constexpr std::string_view kMarkup = "\\`*_[]<>|&~#$!@";
  std::string out;
  for (const char c : text) {
    if (kMarkup.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// One table, cell by cell. Cells are Markdown already.
class MarkdownTable {
 public:
  /// Columns before `first_number` are aligned to the left, the others to the right.
  MarkdownTable(std::string& out, const std::vector<std::string>& head, std::size_t first_number) : out_(out) {
    row(head);
    for (std::size_t i = 0; i < head.size(); ++i) out_ += i < first_number ? "| --- " : "| ---: ";
    out_ += "|\n";
  }
  void row(const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) out_ += "| " + cell + (cell.empty() ? "" : " ");
    out_ += "|\n";
  }

 private:
  std::string& out_;
};

}  // namespace meshlode::app
