// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/page.h"

#include <algorithm>
#include <span>
#include <system_error>
#include <utility>

#include "app/doctor/diagnosis.h"
#include "base/printable.h"
#include "base/try.h"
#include "lab/page/charts.h"
#include "lab/page/markup.h"
#include "lab/page/numbers.h"
#include "lab/page/palette.h"
#include "lab/page/parts.h"
#include "lab/page/pictures.h"
#include "lab/page/summary.h"
#include "lab/page/tables.h"

namespace meshlode::lab::page {

namespace {

struct Section {
  const char* id;
  const char* title;
  Markup body;
};

std::string labels_of(const ReportData& data, const std::vector<std::string>& ids, const Point* but) {
  std::vector<std::string> labels;
  for (const std::string& id : ids) {
    const Point* const other = data.find_point(id);
    if (other != nullptr && other != but) labels.push_back(other->label);
  }
  return joined(labels);
}

void write_recommendation(Markup& html, const ReportData& data, const Recommendation& one) {
  html.open("li").open("p").text("For ").element("code", one.want).text(": ");
  const Point* const point = one.point ? data.find_point(*one.point) : nullptr;
  if (point != nullptr) {
    const Metric* const goal = data.find_metric(one.goal);
    html.open("strong").name(point->label).close();
    if (one.value && goal != nullptr) html.text(", " + goal->title + " " + amount_text(*one.value, goal->unit));
  } else {
    html.element("strong", one.not_compared.empty() ? "no measured point keeps this" : "nothing could be compared");
  }
  html.text(". ").text(one.why).close();
  if (one.command) write_command(html, "Build it", *one.command);
  const std::string as_good = labels_of(data, one.as_good, point);
  const std::string not_compared = labels_of(data, one.not_compared, point);
  if (!as_good.empty()) write_paragraph(html, "Within the spread of it, so as good: " + as_good + ".");
  if (!not_compared.empty()) write_paragraph(html, "Not compared, one round: " + not_compared + ".");
  html.close().line();
}

Section write_answers(const ReportData& data) {
  Section section{"answers", "Answers", {}};
  Markup& html = section.body;
  if (data.recommendations.empty()) {
    write_paragraph(html, "No wish was stated.");
  } else {
    html.open("ul", {{"class", "answers"}}).line();
    for (const Recommendation& one : data.recommendations) write_recommendation(html, data, one);
    html.close().line();
  }
  std::size_t beaten = 0;
  for (const Point& point : data.points) beaten += point.dominated_by.empty() ? 0 : 1;
  write_paragraph(html,
                  std::to_string(beaten) + " of " + std::to_string(data.points.size()) +
                      " points are dominated: another is no worse in build time, bytes, deviation and triangles, and "
                      "clearly better in one of them.");
  return section;
}

void write_fault_place(Markup& html, const app::DiagnosisPlace& place) {
  html.open("li").name(place.where).text(": " + place.detail);
  for (std::size_t i = 0; i < place.costs.size(); ++i) {
    html.text((i == 0 ? "; costs " : ", ") + app::cost_text(place.costs[i]));
  }
  html.close().line();
}

void write_fault(Markup& html, const app::Diagnosis& fault) {
  constexpr std::size_t kMostPlaces = 4;
  html.open("li").open("p").element("strong", fault.title).text(" (" + app::share_text(fault.share) + "; ");
  html.element("code", fault.id).text(")");
  if (fault.places.size() > 1) html.text(", " + grouped_digits(fault.count) + " in all");
  html.close().line().open("ul").line();
  for (std::size_t i = 0; i < std::min(kMostPlaces, fault.places.size()); ++i) write_fault_place(html, fault.places[i]);
  if (fault.places.size() > kMostPlaces) {
    html.element("li", "and " + grouped_digits(fault.places.size() - kMostPlaces) + " more").line();
  }
  html.close().line();
  write_paragraph(html, "What to do: " + fault.remedy + ".");
  if (!fault.hard_case.empty()) {
    html.open("p").text("What a build does with it, from easy to extreme: the hard case ");
    html.element("code", fault.hard_case).text(" of docs/reference/hard-cases.md.").close().line();
  }
  html.close().line();
}

Section write_doctor(const ReportData& data) {
  Section section{"doctor", "What the scene itself calls for", {}};
  Markup& html = section.body;
  if (!data.scene_faults) {
    write_paragraph(html, "The scene was not examined.");
    return section;
  }
  if (data.scene_faults->ranked.empty()) {
    write_paragraph(html, "Nothing was found in the source that costs accuracy, bytes or time under every setting.");
  } else {
    write_paragraph(html,
                    "Found in the source, worst first, with estimated shares of the scene: what no setting fixes.");
    html.open("ol", {{"class", "answers"}}).line();
    for (const app::Diagnosis& fault : data.scene_faults->ranked) write_fault(html, fault);
    html.close().line();
  }
  write_command(html, "Reported by", data.scene_faults->command);
  return section;
}

Section write_charts(const ReportData& data) {
  Section section{"accuracy", "What accuracy costs", {}};
  section.body.open("div", {{"class", "charts"}}).line();
  const std::vector<Chart> charts = chart_frontiers(data);
  for (std::size_t i = 1; i < charts.size(); ++i) write_chart(section.body, charts[i], data.command);  // 0: the summary
  const Chart triangles = chart_triangles(data);
  if (!triangles.plot.series.empty()) write_chart(section.body, triangles, data.command);
  section.body.close().line();
  return section;
}

Section write_knobs(const ReportData& data) {
  Section section{"knobs", "What each setting costs", {}};
  write_paragraph(section.body,
                  "One setting at a time, all others as in the baseline. ≈ marks where the spreads of a timed figure "
                  "overlap, so that no difference was measured. Of processor time that was measured once a spread is "
                  "assumed; any other time that was measured once is not compared.");
  for (const Table& table : tabulate_knobs(data)) write_table(section.body, table);
  return section;
}

Section write_errors(const ReportData& data) {
  Section section{"errors", "Stored errors against measured ones", {}};
  section.body.open("div", {{"class", "charts"}}).line();
  for (const Chart& chart : {chart_stored_errors(data), chart_error_distribution(data)}) {
    if (!chart.plot.series.empty()) write_chart(section.body, chart, data.command);
  }
  section.body.close().line();
  return section;
}

Section write_bytes(const ReportData& data) {
  Section section{"bytes", "Where the bytes are", {}};
  section.body.open("div", {{"class", "charts"}}).line();
  for (const ByteChart& chart : chart_bytes(data)) {
    Markup& html = section.body;
    html.open("figure", {{"class", "chart"}}).element("h3", chart.map.title).line();
    html.raw(draw_treemap(chart.map, Standing::kInPage));
    html.open("figcaption");
    write_command(html, "Built by", chart.command);
    html.close();
    write_numbers(html, chart.table);
    html.close().line();
  }
  section.body.close().line();
  return section;
}

Section write_views(const ReportData& data, const PageOptions& options) {
  Section section{"pictures", "Cuts beside the full resolution", {}};
  Markup stages;
  const PictureCount count = write_pictures(stages, data, options.most_picture_bytes);
  if (stages.str().empty()) {
    write_paragraph(section.body, "No pictures were drawn.");
    return section;
  }
  Markup& html = section.body;
  html.open("p").text("Heat maps show FLIP per pixel: ");
  html.open("span", {{"class", "magma"}, {"role", "img"}, {"aria-label", "black is 0, no difference; yellow is 1"}});
  html.close().text(" from 0 (black) to 1 (light yellow).").close().line();
  if (count.left_out > 0) {
    write_paragraph(
        html, std::to_string(count.left_out) + " more pictures lie beside this page: with them it would be too large.");
  }
  html.raw(stages.str());
  return section;
}

Section write_points(const ReportData& data) {
  Section section{"points", "All points", {}};
  Markup& html = section.body;
  write_table(html, tabulate_points(data));
  html.open("details").element("summary", "The command of each point");
  write_table(html, tabulate_commands(data));
  html.close().line();
  if (!data.left_out.empty()) write_table(html, tabulate_left_out(data));
  return section;
}

void write_fact(Markup& html, std::string_view term, std::string_view text) {
  html.element("dt", term).open("dd").name(text).close().line();
}

Section write_facts(const ReportData& data) {
  Section section{"facts", "How it was measured", {}};
  Markup& html = section.body;
  write_command(html, "This report is made by", data.command);
  html.open("dl").line();
  write_fact(html, "Scene",
             data.scene_file + ", " + grouped_digits(data.meshes) + " meshes, " + grouped_digits(data.instances) +
                 " instances, " + grouped_digits(data.triangles) + " triangles, " + grouped_digits(data.vertices) +
                 " vertices");
  write_fact(html, "Source", data.scene_hash);
  write_fact(html, "Program", "meshlode " + data.program_version + ", " + data.program_id);
  write_fact(html, "Machine",
             data.machine + ", " + std::to_string(data.threads) + " threads, " +
                 amount_text(static_cast<double>(data.memory_bytes), "bytes"));
  write_fact(html, "System", data.system);
  write_fact(html, "Vulkan", data.vulkan.empty() ? "none: " + data.vulkan_reason : data.vulkan);
  write_fact(html, "Seed", std::to_string(data.seed) + ", " + grouped_digits(data.samples) + " samples each way");
  write_fact(html, "Timed points", std::to_string(data.rounds) + " rounds, the median of each figure");
  write_fact(html, "Time",
             amount_text(data.spent_seconds, "seconds") + " of " +
                 (data.budget_seconds ? amount_text(*data.budget_seconds, "seconds") : "no limit"));
  html.close().line();
  write_table(html, tabulate_metrics(data));
  return section;
}

void write_head(Markup& html, const ReportData& data) {
  html.open("head").line().empty("meta", {{"charset", "utf-8"}}).line();
  html.empty("meta", {{"name", "viewport"}, {"content", "width=device-width, initial-scale=1"}}).line();
  // Whatever a name may smuggle in: the page loads nothing but what is in it.
  html.empty("meta", {{"http-equiv", "Content-Security-Policy"},
                      {"content",
                       "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src "
                       "'unsafe-inline'; base-uri 'none'; form-action 'none'"}});
  html.line().element("title", "meshlode sweep of " + data.scene_file).line();
  html.open("style").raw("\n").raw(palette_properties()).raw(plot_css()).raw(page_css()).close().line();
  html.close().line();
}

void write_top(Markup& html, const ReportData& data) {
  html.element("a", "Skip to the summary", {{"class", "skip"}, {"href", "#summary"}}).line();
  html.open("header").line();
  html.open("h1").text("What accuracy costs: ").name(data.scene_file).close().line();
  html.open("p", {{"class", "lead"}});
  html.text(grouped_digits(data.triangles) + " triangles, " + std::to_string(data.points.size()) +
            (data.points.size() == 1 ? " point measured, " : " points measured, ") +
            std::to_string(data.left_out.size()) + " left out. ");
  if (!data.is_complete) html.element("strong", "The sweep was interrupted: what follows is a part of it.");
  html.close().line();
  html.open("fieldset", {{"class", "theme"}, {"hidden", "hidden"}}).element("legend", "Colours");
  for (const char* theme : {"system", "light", "dark"}) {
    html.open("label");
    html.empty("input", {{"type", "radio"}, {"name", "theme"}, {"value", theme}}).text(" ").text(theme).close();
  }
  html.close().line();
  html.close().line();
}

void write_nav(Markup& html, const std::vector<Section>& sections) {
  html.open("nav", {{"aria-label", "Sections"}}).open("ul");
  for (const Section& section : sections) {
    html.open("li").element("a", section.title, {{"href", "#" + std::string(section.id)}}).close();
  }
  html.close().close().line();
}

std::vector<Chart> all_charts(const ReportData& data) {
  std::vector<Chart> charts = chart_frontiers(data);
  for (Chart& chart :
       std::vector<Chart>{chart_triangles(data), chart_stored_errors(data), chart_error_distribution(data)}) {
    if (!chart.plot.series.empty()) charts.push_back(std::move(chart));
  }
  return charts;
}

std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

std::string write_page(const ReportData& data, const PageOptions& options) {
  std::vector<Section> sections;
  sections.push_back({"summary", "At a glance", {}});
  write_summary(sections.back().body, data);
  sections.push_back(write_answers(data));
  sections.push_back(write_doctor(data));
  sections.push_back(write_charts(data));
  sections.push_back(write_knobs(data));
  sections.push_back(write_errors(data));
  sections.push_back(write_bytes(data));
  sections.push_back(write_views(data, options));
  sections.push_back(write_points(data));
  sections.push_back(write_facts(data));
  Markup html;
  html.raw("<!DOCTYPE html>\n").open("html", {{"lang", "en"}}).line();
  write_head(html, data);
  html.open("body").line();
  write_top(html, data);
  html.open("main").line();
  for (const Section& section : sections) {
    const std::string heading = std::string(section.id) + "-heading";
    html.open("section", {{"id", section.id}, {"aria-labelledby", heading}}).line();
    const bool is_first = &section == sections.data();
    if (!is_first) html.open("details", {{"class", "fold"}}).open("summary");
    html.element("h2", section.title, {{"id", heading}});
    if (!is_first) html.close();
    html.line().raw(section.body.str());
    if (!is_first) html.close();
    html.close().line();
    if (is_first) write_nav(html, sections);
  }
  html.close().line();
  html.open("p", {{"id", "said"}, {"class", "unseen"}, {"role", "status"}}).close().line();
  html.open("script").raw("\n").raw(page_script()).close().line();
  html.close().line().close().line();
  return html.str();
}

std::vector<PlotFile> write_plots(const ReportData& data) {
  std::vector<PlotFile> files;
  for (const Chart& chart : all_charts(data)) {
    files.push_back({chart.plot.id + ".svg", draw_plot(chart.plot, Standing::kAlone)});
  }
  for (const ByteChart& chart : chart_bytes(data)) {
    files.push_back({chart.map.id + ".svg", draw_treemap(chart.map, Standing::kAlone)});
  }
  return files;
}

Status write_report(const ReportData& data, const std::filesystem::path& folder, OutputFiles& files,
                    const PageOptions& options) {
  const std::filesystem::path plots = folder / "plots";
  std::error_code failed;
  std::filesystem::create_directories(plots, failed);
  if (failed) return Error{ErrorCode::kIo, plots.string(), failed.message()};
  for (const PlotFile& file : write_plots(data)) {
    TRY(files.write(plots / file.name, as_bytes(file.svg)));
  }
  return files.write(folder / "index.html", as_bytes(write_page(data, options)));
}

}  // namespace meshlode::lab::page
