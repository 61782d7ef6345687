// SPDX-License-Identifier: GPL-3.0-or-later
// `report --format markdown`: short enough to be read in a merge request.
#include <algorithm>
#include <string>

#include "app/overview/overview.h"
#include "app/report/markdown.h"
#include "base/append_format.h"
#include "base/printable.h"

namespace meshlode::app {

namespace {

constexpr std::size_t kMostChanges = 10, kMostFailures = 20;  ///< rows: more is for the page
constexpr std::size_t kMostText = 300;                        ///< bytes of a name or message

std::string cell(const std::string& text) {
  return markdown_text(printable(text, kMostText));
}

std::string change_text(std::int64_t change, std::uint64_t before) {
  const std::uint64_t size = change < 0 ? static_cast<std::uint64_t>(-change) : static_cast<std::uint64_t>(change);
  std::string text = (change < 0 ? "-" : "+") + grouped_digits(size);
  if (before > 0) append_format(text, " (%+.1f%%)", 100.0 * static_cast<double>(change) / static_cast<double>(before));
  return text;
}

void add_changes(std::string& out, const Overview& overview) {
  const auto changed = overview.changed();
  if (!overview.has_old) return;
  std::size_t added = 0;
  for (const OverviewAsset& asset : overview.assets) added += asset.result.has_asset() && !asset.old_bytes ? 1 : 0;
  out += "\n### Changes\n\n" + grouped_digits(overview.bytes()) + " bytes, " +
         change_text(static_cast<std::int64_t>(overview.bytes()) - static_cast<std::int64_t>(overview.old_bytes()),
                     overview.old_bytes()) +
         ": " + counted(changed.size(), "assets") + " changed, " + grouped_digits(added) + " new, " +
         grouped_digits(overview.gone.size()) + " gone\n";
  if (changed.empty()) return;
  out += "\n";
  MarkdownTable table(out, {"asset", "bytes before", "now", "change"}, 1);
  for (std::size_t i = 0; i < std::min(kMostChanges, changed.size()); ++i) {
    const OverviewAsset& asset = *changed[i];
    table.row({cell(asset.result.job.output.string()), grouped_digits(*asset.old_bytes),
               grouped_digits(asset.result.facts.bytes), change_text(*asset.growth(), *asset.old_bytes)});
  }
  if (changed.size() > kMostChanges) {
    out += "\nand " + grouped_digits(changed.size() - kMostChanges) + " more changed\n";
  }
}

/// An error without the file that it begins with: that has a cell of its own.
std::string without_file(const std::string& error, const std::string& file) {
  return error.starts_with(file + ": ") ? error.substr(file.size() + 2) : error;
}

void add_failures(std::string& out, const Overview& overview) {
  std::size_t shown = 0, all = 0;
  std::string rows;
  MarkdownTable table(rows, {"file", "error"}, 2);
  for (const OverviewAsset& asset : overview.assets) {
    const bool is_failed = asset.result.status == JobStatus::kFailed || asset.result.status == JobStatus::kSkipped;
    if (!is_failed && asset.unread.empty()) continue;
    if (++all > kMostFailures) continue;
    ++shown;
    const std::string file = (is_failed ? asset.result.job.input : asset.result.job.output).string();
    const std::string error = without_file(is_failed ? asset.result.error : asset.unread, file);
    table.row({cell(file), cell(error.empty() ? "skipped" : error)});
  }
  if (all == 0) return;
  out += "\n### Failures\n\n" + rows;
  if (all > shown) out += "\nand " + grouped_digits(all - shown) + " more\n";
}

}  // namespace

std::string overview_markdown(const Overview& overview) {
  std::string out = "## meshlode: " + counted(overview.assets.size(), "assets") +
                    (overview.is_complete ? "" : ", not complete") + "\n\n";
  MarkdownTable table(out, {"what", "count"}, 1);
  for (const auto& [status, name] : kJobStatusNames) {
    if (const std::size_t count = overview.count(status)) table.row({name, grouped_digits(count)});
  }
  const std::size_t hits = overview.count(CacheUse::kHit), misses = overview.count(CacheUse::kMiss);
  if (hits + misses > 0) {
    table.row({"from the cache", grouped_digits(hits) + " of " + grouped_digits(hits + misses)});
  }
  table.row({"bytes", grouped_digits(overview.bytes())});
  if (overview.triangles() > 0) {
    table.row({"triangles", grouped_digits(overview.triangles())});
    table.row({"drawn at one pixel of error, each framed in 1280x720", grouped_digits(overview.pixel_triangles())});
  }
  std::string found;
  for (const char* severity : {"high", "medium", "low", "warning"}) {
    const std::size_t count = overview.count_findings(severity);
    if (count > 0) found += (found.empty() ? "" : ", ") + grouped_digits(count) + " " + severity;
  }
  if (!found.empty()) table.row({"findings", found});
  add_failures(out, overview);
  add_changes(out, overview);
  return out;
}

}  // namespace meshlode::app
