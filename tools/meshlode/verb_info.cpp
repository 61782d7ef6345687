// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <string>
#include <utility>

#include "budget_options.h"
#include "options.h"
#include "out/report/info.h"
#include "run/read/asset.h"
#include "terminal.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

std::string describe(const run::Asset& asset, const out::AssetInfo& info, const std::string& format, bool list_stuck) {
  if (format == "json") return out::info_json(asset, info, list_stuck);
  if (format == "csv") return out::info_csv(asset, info, list_stuck);
  if (format == "markdown") return out::info_markdown(asset, info, list_stuck);
  const auto style = is_unicode_terminal() ? out::BarStyle::kBlocks : out::BarStyle::kAscii;
  return out::info_text(asset, info, list_stuck, style);
}

int run_info(const Verb& verb, std::span<char* const> args) {
  std::string path;
  std::optional<std::string> fail_if;
  OutputOptions output;
  bool list_stuck = false;
  OptionParser parser(verb);
  parser.add_positional("file", path, "a .lode asset");
  add_output_options(parser, output, {"csv", "markdown"});
  parser.add_flag("--stuck", list_stuck, "list every stuck group with its reason (extract --stuck shows them)");
  add_budget_option(parser, fail_if, "--format json", "totals.clusters>5000, any(meshes).stuck_groups>0");
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  const auto budget = read_budget_option(fail_if, out::info_schema());
  if (!budget) return print_error(budget.error());

  const Result<run::Asset> asset = run::Asset::open(path);
  if (!asset) return print_error(asset.error());
  out::AssetInfo info = out::describe_asset(*asset);
  // CSV has no byte map; it takes a reading of every page.
  const bool is_map_judged = out::mentions(*budget, "byte_map");
  if (output.format != "csv" || is_map_judged) {
    Result<out::ByteMap> byte_map = out::map_bytes(*asset);
    if (byte_map) {
      info.byte_map = std::move(*byte_map);
    } else {
      Error error = byte_map.error();
      error.where = path + ": " + error.where;
      const int broken_page = print_error(error);
      if (is_map_judged) return broken_page;
      // What the tables say is still true.
    }
  }
  const bool is_silent = output.quiet && output.format == "text";
  if (!is_silent && !print_out(describe(*asset, info, output.format, list_stuck))) {
    return static_cast<int>(ErrorCode::kIo);
  }
  if (budget->empty()) return 0;
  const auto broken = out::judge_budget(*budget, out::info_json(*asset, info, true));
  return broken ? print_broken(path, *broken) : print_error(broken.error());
}

}  // namespace

const Verb kInfoVerb{"info", "what is in an asset: totals, levels, materials, bytes, sections",
                     "meshlode info scene.lode\n  meshlode info scene.lode --format json\n"
                     "  meshlode info scene.lode --format csv >levels.csv\n"
                     "  meshlode info scene.lode --fail-if 'totals.bytes_per_source_triangle>10, any(meshes).roots>1'",
                     run_info};

}  // namespace meshlode::cli
