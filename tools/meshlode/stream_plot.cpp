// SPDX-License-Identifier: GPL-3.0-or-later
#include "stream_plot.h"

#include <algorithm>

#include "base/append_format.h"
#include "lab/page/plot.h"

namespace meshlode::cli {

namespace {

constexpr std::size_t kMostSeries = 8, kMostPoints = 400;

std::string name_of_run(const app::RunSpec& spec) {
  std::string text = "pool of all";
  if (spec.pool_bytes) {
    text.clear();
    append_format(text, "pool %.3g MB", static_cast<double>(*spec.pool_bytes) / 1e6);
  }
  append_format(text, ", %.4g MB/s, %.4g ms", spec.link.megabytes_per_second, spec.link.latency_ms);
  return text;
}

/// Of stretches of frames that are as wide as a pixel of the plot the largest error.
lab::page::Series series_of(const app::StreamReport& report, std::size_t run) {
  lab::page::Series series;
  series.name = name_of_run(report.specs[run]);
  series.look = run;
  series.drawn = lab::page::Drawn::kSteps;
  const std::vector<float>& errors = report.simulation.runs[run].max_px;
  const std::size_t stretch = std::max<std::size_t>(1, (errors.size() + kMostPoints - 1) / kMostPoints);
  for (std::size_t f = 0; f < errors.size(); f += stretch) {
    const auto end = errors.begin() + static_cast<std::ptrdiff_t>(std::min(f + stretch, errors.size()));
    lab::page::PlotPoint point;
    point.x = static_cast<double>(report.frames[f].time_us) / 1e6;
    point.y = double{*std::max_element(errors.begin() + static_cast<std::ptrdiff_t>(f), end)};
    series.points.push_back(point);
  }
  return series;
}

}  // namespace

std::string stream_plot(const app::StreamReport& report) {
  lab::page::Plot plot;
  plot.id = "stream";
  plot.title = "Largest error shown";
  plot.description = "In pixels, over time, along " + report.path;
  plot.x = {"time", "s", lab::page::Scale::kLinear, true};
  plot.y = {"error shown", "px", lab::page::Scale::kLog};
  for (std::size_t i = 0; i < report.specs.size() && plot.series.size() < kMostSeries; ++i) {
    if (report.simulation.runs[i].fits) plot.series.push_back(series_of(report, i));
  }
  return lab::page::draw_plot(plot, lab::page::Standing::kAlone);
}

}  // namespace meshlode::cli
