// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <string>
#include <utility>

#include "app/compare/stored_bytes.h"
#include "app/page/viewer_page.h"
#include "app/report/info.h"
#include "base/byte_size.h"
#include "base/try.h"
#include "budget_options.h"
#include "file_kind.h"
#include "info_page.h"
#include "options.h"
#include "output_name.h"
#include "outputs.h"
#include "run/read/asset.h"
#include "streams.h"
#include "terminal.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

std::string describe(const run::Asset& asset, const app::AssetInfo& info, const std::string& format, bool list_stuck) {
  if (format == "json") return app::info_json(asset, info, list_stuck);
  if (format == "csv") return app::info_csv(asset, info, list_stuck);
  if (format == "markdown") return app::info_markdown(asset, info, list_stuck);
  const auto style = is_unicode_terminal() ? app::BarStyle::kBlocks : app::BarStyle::kAscii;
  return app::info_text(asset, info, list_stuck, style);
}

/// `--html`: the page beside what is printed.
struct PageOptions {
  std::optional<std::string> path, limit;
  std::uint64_t max_page_bytes = app::kDefaultPageBytes;
};

void add_page_options(OptionParser& parser, PageOptions& page) {
  parser.add_value("--html FILE", page.path,
                   "write a page that shows clusters, DAG and cuts in a browser; - for stdout, instead of the figures "
                   "(default: none)");
  parser.add_value("--html-limit SIZE", page.limit,
                   "largest geometry in that page; of a larger asset it holds the coarse levels (default: 32MiB)");
}

/// What can be told before the asset is read.
Status check_page_options(PageOptions& page) {
  if (page.limit) {
    const auto bytes = parse_byte_size(*page.limit);
    if (!page.path) return Error{ErrorCode::kUsage, "--html-limit", "is for --html"};
    if (!bytes) return wrong_size("--html-limit", *page.limit, "a size, such as 8MiB or 8MB");
    page.max_page_bytes = *bytes;
  }
  if (page.path && page.path->empty()) return Error{ErrorCode::kUsage, "--html", "name the file of the page"};
  return page.path ? can_write_info_page() : Ok{};
}

/// Of info's format.
Status claim_figures(const std::string& path, const std::string& format) {
  if (format == "json") return claim_report(path, {".json"});
  if (format == "csv") return claim_report(path, {".csv"});
  if (format == "markdown") return claim_report(path, {".md", ".markdown"});
  return claim_report(path, {});
}

Status claim_page(const PageOptions& page) {
  if (!page.path) return Ok{};
  TRY(claim_output(*page.path));
  return check_text_name("--html", *page.path, {".html", ".htm"});
}

Status write_page(const run::Asset& asset, const std::string& path, const std::optional<app::ByteMap>& byte_map,
                  const PageOptions& options) {
  if (!options.path) return Ok{};
  TRY_LET(page, info_page(asset, path, byte_map, options.max_page_bytes));
  return write_output(*options.path, *page);
}

int run_info(const Verb& verb, std::span<char* const> args) {
  std::string path, report = kStream;
  std::optional<std::string> fail_if;
  PageOptions page;
  OutputOptions output;
  bool list_stuck = false;
  OptionParser parser(verb);
  parser.add_positional("FILE", path, "a .lode asset, or - for stdin");
  parser.group("Output");
  add_report_option(parser, report);
  add_output_options(parser, output, {"csv", "markdown"});
  parser.add_flag("--stuck", list_stuck, "list every stuck group with its reason ('extract --stuck' shows them)");
  add_page_options(parser, page);
  add_budget_option(parser, fail_if, "--format json", "totals.clusters>5000, any(meshes).stuck_groups>0");
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  const auto budget = read_budget_option(fail_if, app::info_schema());
  if (!budget) return print_error(budget.error());
  if (const Status sane = check_page_options(page); !sane) return print_error(sane.error());
  const Result<std::string> file = input_path(path);
  if (!file) return print_error(file.error());
  path = input_name(path);
  const Result<run::Asset> asset = open_asset(*file);
  if (!asset) return print_error(asset.error());
  if (const auto id = asset->file_id()) output_files().keep(*id);
  if (const Status free = claim_page(page); !free) return print_error(free.error());
  if (const Status free = claim_figures(report, output.format); !free) return print_error(free.error());
  app::AssetInfo info = app::describe_asset(*asset);
  // Whatever is printed, every page and image is read: an exit code of 0 says that the asset is whole.
  Result<app::ByteMap> byte_map = app::map_bytes(*asset);
  const bool has_map = static_cast<bool>(byte_map);
  const Status sound = has_map ? app::check_stored_bytes(*asset) : Status(byte_map.error());
  if (has_map) info.byte_map = std::move(*byte_map);
  int exit_code = 0;
  if (!sound) {
    Error error = sound.error();
    error.where = path + ": " + error.where;
    exit_code = print_error(error);  // what the tables say is still true
  }
  if (has_map) {
    const Status written = write_page(*asset, path, info.byte_map, page);
    if (!written) return print_error(written.error());
  }
  // With a budget or a page it is these that are asked for, and a page on stdout leaves no place for more.
  const bool is_silent = (output.quiet && output.format == "text" && (fail_if || page.path)) ||
                         (page.path && *page.path == kStream && report == kStream);
  if (!is_silent) {
    const Status written = write_output(report, describe(*asset, info, output.format, list_stuck));
    if (!written) return print_error(written.error());
  }
  // Of a figure that is not known nobody says that it is within its limit.
  if (budget->empty() || (!has_map && app::mentions(*budget, "byte_map"))) return exit_code;
  const auto broken = app::judge_budget(*budget, app::info_json(*asset, info, true));
  const int judged = broken ? print_broken(path, *broken) : print_error(broken.error());
  return exit_code != 0 ? exit_code : judged;
}

}  // namespace

const Verb kInfoVerb{"info", "show what an asset contains: totals, levels, materials, bytes, sections",
                     "Prints totals, the settings of the build, what was left out and why, a table of levels per mesh, "
                     "materials, and what the bytes are spent on. All pages and images are read and checked: exit "
                     "status 0 says that the file is not damaged.\n\n"
                     "With --fail-if the figures become limits that a pipeline can check. With --html it writes a "
                     "self-contained page for a browser.",
                     "meshlode info scene.lode\n"
                     "  meshlode info scene.lode --format json\n"
                     "  meshlode info scene.lode --html scene.html\n"
                     "  meshlode info scene.lode --format csv >levels.csv\n"
                     "  meshlode info scene.lode --fail-if 'totals.bytes_per_source_triangle>10'",
                     run_info};

}  // namespace meshlode::cli
