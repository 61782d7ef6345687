// SPDX-License-Identifier: GPL-3.0-or-later
// A table that the page's script can sort: each cell has its text, and a number where it is one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/page/markup.h"

namespace meshlode::lab::page {

struct Column {
  std::string label;
  bool is_number = false;
};

struct Cell {
  std::string text;
  std::optional<double> number;  ///< what it is sorted by; a column of numbers has those without one last
  std::string note;              ///< small, behind the text
};

struct Row {
  std::vector<Cell> cells;  ///< as many as columns; the first names the row
  std::string point;        ///< id of the point of the sweep that it is about; may be empty
};

struct Table {
  std::string caption;
  std::vector<Column> columns;
  std::vector<Row> rows;
};

void write_table(Markup& html, const Table& table);

}  // namespace meshlode::lab::page
