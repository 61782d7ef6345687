// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <string>
#include <utility>

#include "app/compare/stored_bytes.h"
#include "app/page/viewer_page.h"
#include "app/report/info.h"
#include "base/append_format.h"
#include "base/byte_size.h"
#include "base/printable.h"
#include "base/try.h"
#include "budget_options.h"
#include "bulk.h"
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

struct InfoCommand {
  std::vector<app::Condition> budget;
  std::optional<std::string> fail_if;
  std::string report = kStream;
  PageOptions page;
  OutputOptions output;
  bool list_stuck = false, is_single = true;
};

/// What a file is there to be written, and not what was read.
Status claim_outputs(const InfoCommand& command) {
  TRY(claim_page(command.page));
  return claim_figures(command.report, command.output.format);
}

/// The row of several assets.
std::vector<std::string> row_of(const run::Asset& asset, const app::AssetInfo& info) {
  std::string per_triangle = "-";
  if (info.source_triangles > 0) {
    per_triangle.clear();
    append_format(per_triangle, "%.2f",
                  static_cast<double>(info.geometry_bytes) / static_cast<double>(info.source_triangles));
  }
  return {grouped_digits(info.source_triangles), grouped_digits(asset.bytes().size()), std::move(per_triangle),
          grouped_digits(info.stuck_groups)};
}

FileOutcome describe_file(const BulkInput& input, const InfoCommand& command) {
  FileOutcome out;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return out;
  };
  const Result<std::string> file = input_path(input.path);
  if (!file) return fail(file.error());
  const std::string path = input_name(input.path);
  const Result<run::Asset> asset = open_asset(*file);
  if (!asset) return fail(asset.error());
  if (const auto id = asset->file_id()) output_files().keep(*id);
  if (command.is_single) {
    if (const Status free = claim_outputs(command); !free) return fail(free.error());
  }
  app::AssetInfo info = app::describe_asset(*asset);
  // Whatever is printed, every page and image is read: an exit code of 0 says that the asset is whole.
  Result<app::ByteMap> byte_map = app::map_bytes(*asset);
  const bool has_map = static_cast<bool>(byte_map);
  const Status sound = has_map ? app::check_stored_bytes(*asset) : Status(byte_map.error());
  if (has_map) info.byte_map = std::move(*byte_map);
  if (!sound) {
    Error error = sound.error();
    error.where = path + ": " + error.where;
    out.fail(std::move(error));  // what the tables say is still true
  }
  if (has_map) {
    const Status written = write_page(*asset, path, info.byte_map, command.page);
    if (!written) {
      out.errors.push_back(written.error());
      out.exit_code = static_cast<int>(written.error().code);
      return out;
    }
  }
  // With a budget or a page it is these that are asked for, and a page on stdout leaves no place for more.
  const PageOptions& page = command.page;
  const OutputOptions& output = command.output;
  const bool is_silent = (output.quiet && output.format == "text" && (command.fail_if || page.path)) ||
                         (page.path && *page.path == kStream && command.report == kStream);
  if (!is_silent) out.text = describe(*asset, info, output.format, command.list_stuck);
  out.cells = row_of(*asset, info);
  // Of a figure that is not known nobody says that it is within its limit.
  if (command.budget.empty() || (!has_map && app::mentions(command.budget, "byte_map"))) return out;
  const auto broken = app::judge_budget(command.budget, app::info_json(*asset, info, true));
  if (!broken) {
    out.late_errors.push_back(broken.error());
  } else {
    for (const app::BrokenCondition& one : *broken) {
      out.late_errors.push_back({ErrorCode::kCheckFailed, path, one.message()});
    }
  }
  if (out.exit_code == 0 && !out.late_errors.empty()) out.exit_code = static_cast<int>(out.late_errors.front().code);
  return out;
}

int run_info(const Verb& verb, std::span<char* const> args) {
  InfoCommand command;
  BulkWords bulk;
  OutputOptions& output = command.output;
  OptionParser parser(verb);
  add_bulk_inputs(parser, bulk, "FILE",
                  ".lode assets, folders of them, or patterns such as 'out/**/*.lode'; - for stdin",
                  "describe the assets of this manifest of a build (default: none)");
  parser.group("Output");
  add_report_option(parser, command.report);
  add_output_options(parser, output, {"csv", "markdown"});
  parser.add_flag("--stuck", command.list_stuck,
                  "list every stuck group with its reason ('extract --stuck' shows them)");
  add_page_options(parser, command.page);
  add_budget_option(parser, command.fail_if, "--format json", "totals.clusters>5000, any(meshes).stuck_groups>0");
  add_bulk_outputs(parser, bulk);
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  auto budget = read_budget_option(command.fail_if, app::info_schema());
  if (!budget) return print_error(budget.error());
  command.budget = std::move(*budget);
  if (const Status sane = check_page_options(command.page); !sane) return print_error(sane.error());
  const auto inputs = find_bulk_inputs(verb, bulk, app::InputKind::kAssets, ManifestSide::kAssets);
  if (!inputs) return print_error(inputs.error());
  if (inputs->is_single) {
    const JobLimit limit(bulk.jobs);
    return describe_file(inputs->files.front(), command).print(command.report);
  }
  if (command.page.path) return print_error({ErrorCode::kUsage, "--html", "give one asset"});
  if (output.format != "text" && !output.json()) {
    return print_error({ErrorCode::kUsage, "--format", output.format + " is of one asset; json takes several"});
  }
  if (const Status free = claim_outputs(command); !free) return print_error(free.error());
  command.is_single = false;
  return run_bulk({"info",
                   {{"triangles", 11}, {"bytes", 13}, {"B/tri", 7}, {"stuck", 5}},
                   [&](const BulkInput& input) { return describe_file(input, command); }},
                  inputs->files, bulk, output, command.report);
}

}  // namespace

const Verb kInfoVerb{"info", "show what an asset contains: totals, levels, materials, bytes, sections",
                     "Prints totals, the settings of the build, what was left out and why, a table of levels per mesh, "
                     "materials, and what the bytes are spent on. All pages and images are read and checked: exit "
                     "status 0 says that the file is not damaged.\n\n"
                     "With --fail-if the figures become limits that a pipeline can check. With --html it writes a "
                     "self-contained page for a browser. Of several assets each has a row.",
                     "meshlode info scene.lode\n"
                     "  meshlode info scene.lode --format json\n"
                     "  meshlode info scene.lode --html scene.html\n"
                     "  meshlode info scene.lode --format csv >levels.csv\n"
                     "  meshlode info scene.lode --fail-if 'totals.bytes_per_source_triangle>10'",
                     run_info};

}  // namespace meshlode::cli
