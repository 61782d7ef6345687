// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/compare_page.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "app/overview/overview.h"
#include "app/page/page_texts.h"
#include "app/page/text_forms.h"
#include "base/append_format.h"
#include "base/printable.h"

namespace meshlode::app {

namespace {

bool is_bad(const ComparedFile& file) {
  return file.verdict == "FAILED" || file.verdict == "error" || file.verdict == "gone";
}

bool has_section(const ComparedFile& file) {
  return file.verdict != "equal";
}

double flip_of(const ComparedFile& file) {
  const auto worst = worst_flip(file.pictures);
  return worst ? worst->mean : 0.0;
}

std::string number_cell(const std::optional<std::uint64_t>& bytes) {
  return "<td>" + (bytes ? grouped_digits(*bytes) : std::string("-")) + "</td>";
}

std::string verdict_cell(const ComparedFile& file) {
  const char* const kind = is_bad(file) ? " class=\"bad\"" : file.verdict == "equal" ? " class=\"good\"" : "";
  return std::string("<td") + kind + ">" + escape_html(file.verdict) + "</td>";
}

void add_row(std::string& out, const ComparedFile& file, std::size_t index) {
  out += "<tr><td>";
  if (has_section(file)) append_format(out, "<a href=\"#f%zu\">", index);
  out += escape_html(file.name) + (has_section(file) ? "</a></td>" : "</td>");
  out += verdict_cell(file) + number_cell(file.before) + number_cell(file.after);
  if (const auto flip = worst_flip(file.pictures)) {
    append_format(out, "<td>%.4f</td><td>%.4f</td>", flip->mean, flip->max);
  } else {
    out += "<td>-</td><td>-</td>";
  }
  out += "</tr>\n";
}

void add_figure(std::string& out, const std::string& file, const char* caption) {
  // Never a scheme, whatever the file is called: it begins with a dot.
  out += "<figure><img loading=\"lazy\" alt=\"" + std::string(caption) + "\" src=\"" + uri_of("./" + file) +
         "\"><figcaption>" + caption + "</figcaption></figure>\n";
}

void add_section(std::string& out, const ComparedFile& file, std::size_t index) {
  append_format(out, "<section id=\"f%zu\">\n<h2>", index);
  out += escape_html(file.name) + "</h2>\n";
  if (!file.message.empty()) out += "<pre class=\"bad\">" + escape_html(file.message) + "</pre>\n";
  for (const PictureChange& picture : file.pictures) {
    if (!picture.files) continue;
    out += "<div class=\"trio\">\n";
    add_figure(out, picture.files->before, "old");
    add_figure(out, picture.files->after, "new");
    std::string caption;
    append_format(caption, "FLIP of camera %u: mean %.4f, max %.4f", picture.camera, picture.flip.mean,
                  picture.flip.max);
    add_figure(out, picture.files->flip, caption.c_str());
    out += "</div>\n";
  }
  if (!file.text.empty()) {
    out += "<details><summary>Figures</summary><pre>" + escape_html(file.text) + "</pre></details>\n";
  }
  out += "</section>\n";
}

std::string summary_of(const std::vector<ComparedFile>& files) {
  std::map<std::string, std::size_t> counts;
  for (const ComparedFile& file : files) ++counts[file.verdict];
  std::string text = grouped_digits(files.size()) + (files.size() == 1 ? " file" : " files");
  for (const auto& [verdict, count] : counts) text += ", " + grouped_digits(count) + " " + verdict;
  return text;
}

}  // namespace

std::string compare_page(std::vector<ComparedFile> files, const std::string& title) {
  std::sort(files.begin(), files.end(), [](const ComparedFile& a, const ComparedFile& b) {
    return std::make_tuple(-flip_of(a), !is_bad(a), a.name) < std::make_tuple(-flip_of(b), !is_bad(b), b.name);
  });
  std::string rows, sections;
  for (std::size_t i = 0; i < files.size(); ++i) {
    add_row(rows, files[i], i);
    if (has_section(files[i])) add_section(sections, files[i], i);
  }
  const std::array<PageHole, 5> holes{{{"@TITLE@", escape_html(title)},
                                       {"@STYLE@", std::string(overview_style()) + std::string(compare_style())},
                                       {"@SUMMARY@", escape_html(summary_of(files))},
                                       {"@ROWS@", rows},
                                       {"@SECTIONS@", sections}}};
  return fill_holes(compare_frame(), holes);
}

}  // namespace meshlode::app
