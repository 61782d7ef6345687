// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a sweep: one HTML file that asks nothing of a network, and its plots as SVG files.
//
// Written as plain markup, without a library: what is drawn here is a dozen scatter plots, a treemap and tables, whose
// every number is known before the page is; a plotting library would be larger than page and data together, would draw
// in the reader's browser what can be looked at without it, and be one more thing to keep. Equal data gives equal
// bytes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/output_files.h"
#include "lab/page/report_data.h"

namespace meshlode::lab::page {

struct PageOptions {
  std::size_t most_picture_bytes = std::size_t{24}
                                   << 20;  ///< of PNGs in the page; the rest stays beside it and is counted
};

/// HTML that is well-formed XML too.
[[nodiscard]] std::string write_page(const ReportData& data, const PageOptions& options = {});

struct PlotFile {
  std::string name;  ///< "pair-0-6.svg"
  std::string svg;
};

/// Every plot of the page, each a document of its own.
[[nodiscard]] std::vector<PlotFile> write_plots(const ReportData& data);

/// `folder`/index.html and `folder`/plots/*.svg; makes the folders. Errors: as OutputFiles::write().
[[nodiscard]] Status write_report(const ReportData& data, const std::filesystem::path& folder, OutputFiles& files,
                                  const PageOptions& options = {});

}  // namespace meshlode::lab::page
