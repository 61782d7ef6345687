// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "app/stream/report.h"
#include "base/append_format.h"

namespace meshlode::app {

namespace {

double to_mb(double bytes) {
  return bytes / 1e6;
}
double to_mb(std::uint64_t bytes) {
  return static_cast<double>(bytes) / 1e6;
}

std::string number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Of errors and times, which run over several powers of ten: three digits.
std::string short_number(double value) {
  return number(value < 9.995 ? "%.2f" : value < 99.95 ? "%.1f" : "%.0f", value);
}

std::string plural(std::uint64_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string recovery_text(const Recovery& recovery) {
  return recovery.not_reached > 0 ? "never" : number("%.0f", recovery.max_ms);
}

void add_run(std::string& out, const RunSpec& spec, const RunResult& run) {
  const std::string pool = spec.pool_bytes ? short_number(to_mb(*spec.pool_bytes)) : "all";
  append_format(out, "%7s %5s %4s", pool.c_str(), number("%.4g", spec.link.megabytes_per_second).c_str(),
                number("%.4g", spec.link.latency_ms).c_str());
  if (!run.fits) {
    out += "  no room for what is always there\n";
    return;
  }
  append_format(out, " %6s %6s %6s", short_number(run.mean_megabytes).c_str(), short_number(run.mean_requests).c_str(),
                short_number(to_mb(run.worst_bytes)).c_str());
  append_format(out, " %6s %6s", recovery_text(run.asked).c_str(), recovery_text(run.fourfold).c_str());
  append_format(out, " %6s %5s %5.1f%% %5.1f%%\n", short_number(run.error.max_px).c_str(),
                short_number(run.error.p99_px).c_str(), 100.0 * run.error.share_over_asked,
                100.0 * run.error.share_over_fourfold);
}

void add_layout(std::string& out, const std::string& name, std::uint64_t pages, const Demand& demand,
                const RunResult& run, double mean_of_file) {
  append_format(out, "%-22s %5llu %7s", name.c_str(), static_cast<unsigned long long>(pages),
                short_number(to_mb(demand.mean_bytes)).c_str());
  append_format(out, " %5s", mean_of_file > 0.0 ? number("%.2f", demand.mean_bytes / mean_of_file).c_str() : "-");
  append_format(out, " %5.1f%% %7s %6s", 100.0 * demand.drawn_share, short_number(to_mb(demand.root_bytes)).c_str(),
                short_number(demand.root_error.max_px).c_str());
  if (run.fits) {
    append_format(out, " %6s %6s\n", short_number(run.mean_requests).c_str(), recovery_text(run.asked).c_str());
  } else {
    out += "  no room\n";
  }
}

/// A line each for the file's pages and the layouts that were tried, with the pool and link of the first run.
void add_layouts(std::string& out, const StreamReport& report) {
  const Simulation& own = report.simulation;
  const std::string one = number("%.3g", report.view.pixel_error);
  out += "\nlayout, pool and link as in the first line above\n";
  append_format(out, "%-22s %5s %7s %5s %6s %7s %6s %6s %6s\n", "", "pages", "set MB", "ratio", "drawn", "root MB",
                "px", "req/s", ("ms, " + one + " px").c_str());
  add_layout(out, "this asset", report.scene.pages.size(), own.demand, own.runs.front(), own.demand.mean_bytes);
  for (const TriedLayout& tried : report.layouts) {
    add_layout(out, tried.layout.text(), tried.pages, tried.demand, tried.run, own.demand.mean_bytes);
  }
}

void add_findings(std::string& out, const std::string& where, const std::vector<std::string>& findings,
                  std::uint64_t count) {
  for (const std::string& text : findings) append_format(out, "finding: %s%s\n", where.c_str(), text.c_str());
  if (count > findings.size()) {
    append_format(out, "finding: %s%s more\n", where.c_str(), std::to_string(count - findings.size()).c_str());
  }
}

}  // namespace

std::uint64_t count_findings(const Simulation& simulation) {
  std::uint64_t count = simulation.finding_count;
  for (const RunResult& run : simulation.runs) count += run.finding_count;
  return count;
}

std::string stream_text(const StreamReport& report) {
  const StreamScene& scene = report.scene;
  const Demand& demand = report.simulation.demand;
  const double asked = report.view.pixel_error;
  const auto all = static_cast<double>(scene.page_bytes());
  std::string out;
  append_format(out, "scene          %s in %s, %.2f MB (%.2f MB stored)\n",
                plural(scene.instances.size(), "instance").c_str(), plural(scene.pages.size(), "page").c_str(),
                to_mb(all), to_mb(scene.stored_bytes()));
  append_format(out, "path           ");
  std::size_t jumps = 0;
  for (const PathFrame& frame : report.frames) jumps += frame.is_jump ? 1 : 0;
  out += report.path;
  out += ": " + plural(report.frames.size(), "frame") + ", " + plural(jumps - 1, "cut") + "\n";
  append_format(out, "picture        %ux%u at %.4g px, %u frames per second\n", report.view.width, report.view.height,
                asked, report.view.fps);
  append_format(out, "working set    %.2f MB per frame, at most %.2f MB (%.1f%% of all)\n", to_mb(demand.mean_bytes),
                to_mb(demand.max_bytes), 100.0 * static_cast<double>(demand.max_bytes) / all);
  append_format(out, "               %.1f pages per frame, at most %llu; %llu of the path, %.2f MB\n",
                demand.mean_pages, static_cast<unsigned long long>(demand.max_pages),
                static_cast<unsigned long long>(demand.union_pages), to_mb(demand.union_bytes));
  append_format(out, "drawn share    %.1f%% of what a frame needs; %.1f%% if groups were loaded alone\n",
                100.0 * demand.drawn_share, 100.0 * demand.whole_group_share);
  append_format(out, "always there   %.2f MB in %s, %s; alone %s px at most\n", to_mb(demand.root_bytes),
                plural(demand.root_pages, "page").c_str(), plural(demand.root_reads, "read").c_str(),
                short_number(demand.root_error.max_px).c_str());
  if (!report.specs.empty()) {
    const std::string one = number("%.3g", asked), four = number("%.3g", 4.0 * asked);
    out += "\n          link        load             ms until       shown, px and area\n";
    append_format(out, "%7s %5s %4s %6s %6s %6s %6s %6s %6s %5s %6s %6s\n", "pool MB", "MB/s", "ms", "MB/s", "req/s",
                  "worst", (one + " px").c_str(), (four + " px").c_str(), "max", "p99", (">" + one).c_str(),
                  (">" + four).c_str());
  }
  for (std::size_t i = 0; i < report.specs.size(); ++i) add_run(out, report.specs[i], report.simulation.runs[i]);
  if (!report.layouts.empty()) add_layouts(out, report);
  if (!report.is_checked) return out;
  add_findings(out, "", report.simulation.findings, report.simulation.finding_count);
  std::uint64_t frames = report.frames.size();
  for (std::size_t i = 0; i < report.simulation.runs.size(); ++i) {
    const RunResult& run = report.simulation.runs[i];
    frames += run.checked_frames;
    add_findings(out, "run " + std::to_string(i) + ", ", run.findings, run.finding_count);
  }
  append_format(out, "\nchecked        %llu cuts, %llu findings\n", static_cast<unsigned long long>(frames),
                static_cast<unsigned long long>(count_findings(report.simulation)));
  return out;
}

}  // namespace meshlode::app
