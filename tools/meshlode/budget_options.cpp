// SPDX-License-Identifier: GPL-3.0-or-later
#include "budget_options.h"
#include "base/try.h"

#include <utility>

#include "app/report/info.h"
#include "run/read/asset.h"

namespace meshlode::cli {

void add_budget_option(OptionParser& parser, std::optional<std::string>& conditions, const std::string& keys,
                       const std::string& example) {
  const std::string help = "exit with 6 if one of these comma-separated conditions on the keys of " + keys +
                           " is true, such as '" + example + "' (default: none)";
  parser.add_value("--fail-if CONDITIONS", conditions, help.c_str());
}

Result<std::vector<app::Condition>> read_budget_option(const std::optional<std::string>& conditions,
                                                       std::string_view schema) {
  if (!conditions) return std::vector<app::Condition>();
  return app::read_budget(*conditions, schema);
}

int print_broken(const std::string& where, const std::vector<app::BrokenCondition>& broken) {
  int exit_code = 0;
  for (const app::BrokenCondition& one : broken) {
    exit_code = print_error({ErrorCode::kCheckFailed, where, one.message()});
  }
  return exit_code;
}

Status check_asset_budget(const std::filesystem::path& path, const std::vector<app::Condition>& conditions,
                          std::uint64_t max_decoded) {
  TRY_LET(asset, run::Asset::open(path, max_decoded));
  app::AssetInfo info = app::describe_asset(*asset);
  if (app::mentions(conditions, "byte_map")) {
    TRY_LET(byte_map, app::map_bytes(*asset));
    info.byte_map = std::move(*byte_map);
  }
  TRY_LET(broken, app::judge_budget(conditions, app::info_json(*asset, info, true)));
  if (!broken->empty()) return app::budget_error(*broken, path.string());
  return Ok{};
}

}  // namespace meshlode::cli
