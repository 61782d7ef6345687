// SPDX-License-Identifier: GPL-3.0-or-later
// report: a batch on one page, or as what code hosts show of it.
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/batch/jobs/weigh.h"
#include "app/batch/shard/read_manifest.h"
#include "app/overview/overview.h"
#include "base/guarded.h"
#include "base/parallel.h"
#include "base/try.h"
#include "bulk.h"
#include "doctor_advice.h"
#include "kept_manifest.h"
#include "options.h"
#include "output_name.h"
#include "outputs.h"
#include "streams.h"
#include "thumbnail.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

namespace fs = std::filesystem;

/// One file that is written, and in which form.
struct ReportFile {
  std::string format, path;
};

Result<app::Manifest> read_with_results(const std::string& path) {
  TRY_LET(manifest, read_kept_manifest(path));
  keep_results(manifest->results);
  return manifest;
}

Status claim(const ReportFile& file) {
  if (file.format == "html") return claim_report(file.path, {".html", ".htm"});
  if (file.format == "markdown") return claim_report(file.path, {".md", ".markdown"});
  if (file.format == "sarif") return claim_report(file.path, {".sarif", ".json"});
  return claim_report(file.path, {});
}

std::string text_of(const app::Overview& overview, const ReportFile& file, const std::string& title) {
  if (file.format == "markdown") return app::overview_markdown(overview);
  if (file.format == "sarif") return app::overview_sarif(overview);
  if (file.format == "annotations") return app::overview_annotations(overview);
  return app::batch_page(overview, title, file.path == kStream ? "" : fs::path(file.path).parent_path().string());
}

/// So that the largest assets together stay below the limit.
std::size_t assets_at_once(const app::Manifest& manifest, std::uint64_t max_memory, bool with_thumbnails) {
  std::vector<std::uint64_t> bytes;
  for (const app::JobResult& result : manifest.results) {
    if (result.has_asset()) bytes.push_back(app::weigh_scene(result.job.output));
  }
  return count_at_once(std::move(bytes), max_memory, with_thumbnails ? kThumbnailImageBytes : 0);
}

void add_thumbnail(const run::Asset& asset, app::OverviewAsset& row) {
  const Status done = guarded({}, [&]() -> Status {  // a picture that cannot be had costs no row its findings
    TRY_LET(drawn, draw_thumbnail(asset));
    row.thumbnail = std::move(drawn->webp);
    row.thumbnail_note = std::move(drawn->note);
    return Ok{};
  });
  if (!done) row.thumbnail_note = done.error().message();
}

int run_report(const Verb& verb, std::span<char* const> args) {
  std::string path, output = kStream, against;
  std::optional<std::string> format;
  bool no_thumbnails = false;
  BulkWords resources;
  OptionParser parser(verb);
  parser.add_positional("MANIFEST", path, "manifest that 'meshlode build --manifest' or 'meshlode merge' wrote");
  parser.group("Output");
  parser.add_value("-o,--output FILE|FOLDER", output,
                   "file to write instead of stdout, which is -; into a folder, one that exists or ends in /, go "
                   "index.html, report.md and report.sarif");
  parser.add_value("--format", format,
                   "html: a page for a browser; markdown: for a merge request; sarif: for code hosts; annotations: "
                   "workflow commands (default: html)",
                   {"html", "markdown", "sarif", "annotations"});
  parser.add_flag("--no-thumbnails", no_thumbnails,
                  "leave the pictures of the assets out of the page, to save time and bytes");
  parser.group("Input");
  parser.add_value("--against OLD", against, "manifest of an earlier batch, to show what grew (default: none)");
  parser.group("Resources");
  add_bulk_resources(parser, resources);
  if (const auto exit_code = parser.parse(args)) return *exit_code;

  const auto max_memory = parse_max_memory(resources.max_memory);
  if (!max_memory) return print_error(max_memory.error());
  auto manifest = read_with_results(path);
  if (!manifest) return print_error(manifest.error());
  std::optional<app::Manifest> old;
  if (!against.empty()) {
    auto read = read_with_results(against);
    if (!read) return print_error(read.error());
    old = std::move(*read);
  }
  std::error_code error;
  std::vector<ReportFile> files{{format.value_or("html"), output}};
  if (output.ends_with('/') || fs::is_directory(output, error)) {
    if (format) return print_error({ErrorCode::kUsage, "--format", "is of one file; a folder gets all of them"});
    const fs::path folder = output;
    files = {{"html", (folder / "index.html").string()},
             {"markdown", (folder / "report.md").string()},
             {"sarif", (folder / "report.sarif").string()}};
  }
  for (const ReportFile& file : files) {
    if (const Status free = claim(file); !free) return print_error(free.error());
  }
  const std::string title = fs::path(path).filename().string();
  const bool draws = !no_thumbnails && files.front().format == "html";
  std::optional<app::Overview> overview;
  JobLimit limit(resources.jobs);
  limit.run([&] {
    const std::size_t at_once = assets_at_once(*manifest, *max_memory, !no_thumbnails);
    overview = app::make_overview(
        std::move(*manifest), old ? &*old : nullptr,
        [&](const run::Asset& asset, app::OverviewAsset& row, std::vector<app::Diagnosis>& diagnoses) {
          add_advice(asset, diagnoses);
          row.pixel_triangles = count_pixel_triangles(asset);
          if (draws) add_thumbnail(asset, row);
        },
        at_once);
  });
  for (const ReportFile& file : files) {
    const Status written = write_output(file.path, text_of(*overview, file, title));
    if (!written) return print_error(written.error());
  }
  return 0;
}

}  // namespace

const Verb kReportVerb{
    "report", "show a batch on one page: status, bytes, what grew, faults, times",
    "Reads the manifest of a batch and its assets, and writes one self-contained page: counts, a table to sort and "
    "search, with a thumbnail of each asset, what the bytes are spent on, the largest changes against an earlier "
    "batch, "
    "faults by severity, use of the cache, times. Triangles at one pixel are those that 'meshlode render' draws by its "
    "defaults: at one pixel of error, each asset framed in 1280x720.\n\n"
    "The same as a summary for a merge request, as SARIF 2.1.0 and as workflow commands. Paths are those of the "
    "manifest: run it in the folder in which the batch ran. The exit status is 0 whatever the batch's was.",
    "meshlode report out/manifest.json -o report.html\n"
    "  meshlode report out/manifest.json --against yesterday.json -o report/\n"
    "  meshlode report out/manifest.json --format annotations",
    run_report};

}  // namespace meshlode::cli
