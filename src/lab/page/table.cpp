// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/table.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace meshlode::lab::page {

namespace {

/// The shortest text that reads back as the same number.
std::string exact(double value) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.begin(), text.end(), value);
  return {text.data(), end.ptr};
}

void write_cell(Markup& html, const Row& row, std::size_t index, const Column& column) {
  const Cell& cell = row.cells[index];
  const std::string style = column.is_number ? "number" : "";
  const std::string sorted_by = cell.number ? exact(*cell.number) : "";
  if (index == 0) {
    html.open("th", {{"scope", "row"}, {"data-sort", sorted_by}});
  } else {
    html.open("td", {{"class", style}, {"data-sort", sorted_by}});
  }
  html.name(cell.text);
  if (!cell.note.empty()) html.text(" ").element("small", cell.note);
  html.close();
}

}  // namespace

void write_table(Markup& html, const Table& table) {
  html.open("div", {{"class", "scroll"}, {"role", "region"}, {"tabindex", "0"}, {"aria-label", table.caption}});
  html.open("table", {{"class", "sortable"}}).element("caption", table.caption).line();
  html.open("thead").open("tr");
  for (const Column& column : table.columns) {
    html.element("th", column.label, {{"scope", "col"}, {"class", column.is_number ? "number" : ""}});
  }
  html.close().close().line().open("tbody").line();
  for (const Row& row : table.rows) {
    if (row.point.empty()) {
      html.open("tr");
    } else {
      html.open("tr", {{"data-point", row.point}});
    }
    for (std::size_t i = 0; i < std::min(row.cells.size(), table.columns.size()); ++i) {
      write_cell(html, row, i, table.columns[i]);
    }
    html.close().line();
  }
  html.close().close().close().line();
}

}  // namespace meshlode::lab::page
