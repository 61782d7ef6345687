// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/parts.h"

namespace meshlode::lab::page {

void write_paragraph(Markup& html, std::string_view text) {
  html.element("p", text).line();
}

void write_command(Markup& html, std::string_view what, const std::string& command) {
  if (command.empty()) return;
  html.open("p", {{"class", "command"}}).text(what).text(": ").element("code", command).close().line();
}

void write_numbers(Markup& html, const Table& table) {
  html.open("details").element("summary", "The numbers: " + table.caption);
  write_table(html, table);
  html.close().line();
}

void write_chart(Markup& html, const Chart& chart, const std::string& command) {
  html.open("figure", {{"class", "chart"}});
  html.element("h3", chart.plot.title).line();
  html.raw(draw_plot(chart.plot, Standing::kInPage));
  html.open("figcaption");
  write_paragraph(html, chart.reading);
  write_command(html, "Made by", command);
  html.close();
  write_numbers(html, chart.table);
  html.close().line();
}

std::string joined(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += (out.empty() ? "" : ", ") + text;
  return out;
}

}  // namespace meshlode::lab::page
